/// @file
/// Text to number and back, without a locale and without surprises.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace zerorate::recording {

/// A decimal number scaled to an integer.
struct FixedPoint {
  std::int64_t value;  ///< the number times 10^decimals, halves rounded away from zero
  bool exact;          ///< nothing was rounded
};

/// Reads a decimal number such as "-12.5", "1e-3" or ".25" in integer arithmetic only: 0.01 with
/// 9 decimals is exactly 10'000'000, which no way through double promises.
/// @return nullopt for anything that is not a finite decimal number within 64 bits after scaling.
[[nodiscard]] std::optional<FixedPoint> parse_fixed_point(std::string_view text, int decimals);

/// Reads a decimal number, correctly rounded; an empty text and "nan" are NaN, "inf" and what
/// exceeds double precision are infinite. @return nullopt for anything else.
[[nodiscard]] std::optional<double> parse_real(std::string_view text);

/// Reads a date and time of day by ISO 8601, "2026-03-01T12:30:00.25Z" or with "+01:00":
/// nanoseconds since 1970. Without a zone the time counts as UTC, without a date as one of the
/// first day; only differences matter to a recording. As loggers write it, the date may have
/// slashes and a comma or a colon may stand before the fraction. A leap second, :60, is the second
/// that follows.
/// @return nullopt for anything else and for a date that no calendar has.
[[nodiscard]] std::optional<std::int64_t> parse_calendar_time(std::string_view text);

/// Nanoseconds as decimal seconds without trailing zeros: 10'000'000 gives "0.01".
void append_seconds(std::string& text, std::int64_t time_ns);

}  // namespace zerorate::recording
