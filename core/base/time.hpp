/// @file
/// Points in time and lengths of time: integer nanoseconds of one monotonic clock.
///
/// Gyro samples and odometer pulses carry stamps of the same clock, so that they can be ordered.
/// 64 bits of nanoseconds last 292 years.
#pragma once

#include <compare>
#include <cstdint>

#include "core/base/numeric.hpp"

namespace zerorate::core {

/// A length of time; may be negative.
class Duration {
 public:
  constexpr Duration() = default;
  [[nodiscard]] static constexpr Duration nanoseconds(std::int64_t ns) { return Duration{ns}; }
  [[nodiscard]] static constexpr Duration microseconds(std::int64_t us) {
    return Duration{us * 1'000};
  }
  [[nodiscard]] static constexpr Duration milliseconds(std::int64_t ms) {
    return Duration{ms * 1'000'000};
  }
  [[nodiscard]] static constexpr Duration seconds(std::int64_t s) {
    return Duration{s * 1'000'000'000};
  }

  [[nodiscard]] constexpr std::int64_t ns() const { return ns_; }
  /// Seconds in single precision, for filter arithmetic (24 bits: never for adding up time).
  [[nodiscard]] constexpr float in_seconds() const { return to_float(ns_) * 1e-9F; }

  constexpr auto operator<=>(const Duration&) const = default;
  friend constexpr Duration operator+(Duration a, Duration b) { return Duration{a.ns_ + b.ns_}; }
  friend constexpr Duration operator-(Duration a, Duration b) { return Duration{a.ns_ - b.ns_}; }
  friend constexpr Duration operator*(Duration a, std::int64_t n) { return Duration{a.ns_ * n}; }
  friend constexpr Duration operator/(Duration a, std::int64_t n) { return Duration{a.ns_ / n}; }
  /// How many whole b fit into a, rounded towards zero.
  friend constexpr std::int64_t operator/(Duration a, Duration b) { return a.ns_ / b.ns_; }

 private:
  constexpr explicit Duration(std::int64_t ns) : ns_(ns) {}
  std::int64_t ns_ = 0;
};

/// A point in time on the monotonic clock. Two points cannot be added.
class Instant {
 public:
  constexpr Instant() = default;
  [[nodiscard]] static constexpr Instant from_ns(std::int64_t ns) { return Instant{ns}; }
  [[nodiscard]] constexpr std::int64_t ns() const { return ns_; }

  constexpr auto operator<=>(const Instant&) const = default;
  friend constexpr Duration operator-(Instant a, Instant b) {
    return Duration::nanoseconds(a.ns_ - b.ns_);
  }
  friend constexpr Instant operator+(Instant a, Duration d) { return Instant{a.ns_ + d.ns()}; }
  friend constexpr Instant operator-(Instant a, Duration d) { return Instant{a.ns_ - d.ns()}; }

 private:
  constexpr explicit Instant(std::int64_t ns) : ns_(ns) {}
  std::int64_t ns_ = 0;
};

/// True from 73 years before the clock's zero to 146 years after it. The difference of two such
/// times, even with a sensor's period added, fits into 64 bits of nanoseconds. Times from outside
/// this range are refused.
inline constexpr Instant kEarliestTime = Instant::from_ns(-(std::int64_t{1} << 61));
inline constexpr Instant kLatestTime = Instant::from_ns(std::int64_t{1} << 62);

[[nodiscard]] constexpr bool is_in_range(Instant time) {
  return kEarliestTime.ns() <= time.ns() && time.ns() <= kLatestTime.ns();
}

}  // namespace zerorate::core
