/// @file
/// Tally of a node's messages at a receiver.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/wire/learnt_frame.hpp"
#include "firmware/wire/rate_frame.hpp"
#include "firmware/wire/status_frame.hpp"

namespace zerorate::live {

/// The newest of each kind, and how many there were.
struct Tally {
  std::optional<wire::NumberedMessage> newest;
  std::optional<wire::Status> status;
  std::optional<wire::LearntModel> learnt;
  std::uint64_t messages = 0;
  std::uint64_t lost = 0;      ///< numbers missing in the sequence
  std::uint64_t stops = 0;     ///< times the vehicle came to stand
  std::uint64_t restarts = 0;  ///< restarts of the sender, whose numbers begin at 0 then
  std::uint64_t damaged = 0;   ///< frames and lines that could not be read
  std::vector<wire::NumberedMessage>* every = nullptr;  ///< where each message is kept, if wanted

  void take(const wire::NumberedMessage& message) {
    if (newest && message.sequence <= newest->sequence) {
      ++restarts;
    } else if (newest) {
      lost += message.sequence - newest->sequence - 1;
    }
    const bool stood = newest && newest->message.motion == core::Motion::still;
    if (!stood && message.message.motion == core::Motion::still) ++stops;
    newest = message;
    if (every != nullptr) every->push_back(message);
    ++messages;
  }
};

}  // namespace zerorate::live
