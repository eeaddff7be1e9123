/// @file
/// zerorated's JSON lines, read back.
#pragma once

#include <optional>
#include <string_view>

#include "firmware/wire/learnt_frame.hpp"
#include "firmware/wire/rate_frame.hpp"

namespace zerorate::live {

/// Content of a line.
struct JsonMessage {
  wire::NumberedMessage message;
  std::optional<wire::LearntModel> learnt;  ///< in one line a second, once there is something
};

/// The message of a line (docs/reference/zerorated.md); none where it is no such line. A rate that
/// is null comes back as 0, as in a frame, a deviation that is null as infinity.
[[nodiscard]] std::optional<JsonMessage> parse_json_message(std::string_view line);

}  // namespace zerorate::live
