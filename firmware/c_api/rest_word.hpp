/// @file
/// The newest word of the vehicle on whether it stands, and how long that counts.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/time.hpp"

namespace zerorate::c_api {

/// Silence is rest with an odometer that gives pulses alone. Where words are awaited, and in any
/// case from the first word on, silence is no standstill: a word of rest counts for a limited time,
/// and a pulse is a word of motion.
class RestWord {
 public:
  enum class Verdict : std::uint8_t { rest, motion, silence };

  static constexpr core::Duration kNoLimit = core::Duration::nanoseconds(INT64_MAX);

  /// @param limit time for which a word counts
  /// @param is_awaited whether there are words, before the first of them
  constexpr RestWord(core::Duration limit, bool is_awaited)
      : limit_(limit), is_awaited_(is_awaited) {}

  /// The first sample: from now on a word is waited for.
  constexpr void start(core::Instant now) {
    if (has_started_) return;
    at_ = now;
    has_started_ = true;
  }

  /// Words may come late: the newest counts. A word far older than the newest is of a clock that
  /// went back, and takes its place.
  constexpr void hear(core::Instant at, bool stands) {
    is_awaited_ = true;
    take(at, stands);
  }
  constexpr void pulse(core::Instant at) { take(at, false); }

  [[nodiscard]] constexpr Verdict at(core::Instant now) const {
    if (!is_awaited_ || limit_ == kNoLimit) return Verdict::rest;
    const core::Duration age = now > at_ ? now - at_ : at_ - now;
    if (age > limit_) return Verdict::silence;
    return stands_ ? Verdict::rest : Verdict::motion;
  }

  /// Time of the newest word, if that was one of motion.
  [[nodiscard]] constexpr std::optional<core::Instant> driven_at() const {
    return drives_ ? std::optional{at_} : std::nullopt;
  }

 private:
  constexpr void take(core::Instant at, bool stands) {
    if (has_started_ && at < at_ && at_ - at <= kLatest) return;
    at_ = at;
    has_started_ = true;
    stands_ = stands;
    drives_ = !stands;
  }

  static constexpr core::Duration kLatest = core::Duration::seconds(1);

  core::Duration limit_;
  core::Instant at_;  ///< time of the newest word; before it, of the first sample
  bool is_awaited_;   ///< silence is no standstill
  bool has_started_ = false;
  bool stands_ = false;  ///< rest by the newest word
  bool drives_ = false;  ///< motion by the newest word; without a word neither
};

}  // namespace zerorate::c_api
