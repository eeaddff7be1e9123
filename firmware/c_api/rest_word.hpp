/// @file
/// The newest word of the vehicle on whether it stands, and how long that counts.
#pragma once

#include <cstdint>

#include "core/base/time.hpp"

namespace zerorate::c_api {

/// Silence is no standstill: a word of rest counts for a limited time. A pulse is a word of motion.
/// Without a limit silence is rest, as with an odometer that gives pulses alone.
class RestWord {
 public:
  enum class Verdict : std::uint8_t { rest, motion, silence };

  static constexpr core::Duration kNoLimit = core::Duration::nanoseconds(INT64_MAX);

  /// @param limit time for which a word counts
  constexpr explicit RestWord(core::Duration limit) : limit_(limit) {}

  /// The first sample: from now on a word is waited for.
  constexpr void start(core::Instant now) {
    if (has_started_) return;
    at_ = now;
    has_started_ = true;
  }

  /// Words may come late: the newest counts. A word far older than the newest is of a clock that
  /// went back, and takes its place.
  constexpr void hear(core::Instant at, bool stands) {
    if (has_started_ && at < at_ && at_ - at <= kLatest) return;
    at_ = at;
    has_started_ = true;
    stands_ = stands;
    drives_ = !stands;
  }

  [[nodiscard]] constexpr Verdict at(core::Instant now) const {
    if (limit_ == kNoLimit) return Verdict::rest;
    const core::Duration age = now > at_ ? now - at_ : at_ - now;
    if (age > limit_) return Verdict::silence;
    return stands_ ? Verdict::rest : Verdict::motion;
  }

  /// Time since the newest word, if that was one of motion; else a long time.
  [[nodiscard]] constexpr core::Duration since_driven(core::Instant now) const {
    return drives_ ? now - at_ : core::Duration::seconds(3600);
  }

 private:
  static constexpr core::Duration kLatest = core::Duration::seconds(1);

  core::Duration limit_;
  core::Instant at_;  ///< time of the newest word; before it, of the first sample
  bool has_started_ = false;
  bool stands_ = false;  ///< rest by the newest word
  bool drives_ = false;  ///< motion by the newest word; without a word neither
};

}  // namespace zerorate::c_api
