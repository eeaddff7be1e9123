/// @file
/// A rate message as a line for people at a terminal.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/assert.hpp"
#include "core/base/numeric.hpp"
#include "core/base/units.hpp"
#include "firmware/app/rate_message.hpp"

namespace zerorate::wire {

using TextLine = std::array<std::uint8_t, 112>;

namespace detail {

/// Appends text to a line of fixed size.
class TextWriter {
 public:
  explicit constexpr TextWriter(std::span<std::uint8_t> line) : line_(line) {}

  constexpr void put(std::string_view text) {
    for (const char character : text) put(character);
  }
  constexpr void put(char character) {
    ZERORATE_ASSERT(used_ < line_.size());
    line_[used_++] = static_cast<std::uint8_t>(character);
  }
  /// Right-aligned, with at least one digit.
  constexpr void put(std::uint64_t number, std::size_t width, char fill) {
    std::array<char, 20> digits{};  // room for 2^64 - 1
    std::size_t count = 0;
    do {
      digits[count++] = static_cast<char>('0' + number % 10);
      number /= 10;
    } while (number > 0);
    for (std::size_t i = count; i < width; ++i) put(fill);
    while (count > 0) put(digits[--count]);
  }
  [[nodiscard]] constexpr std::span<const std::uint8_t> written() const {
    return line_.first(used_);
  }

 private:
  std::span<std::uint8_t> line_;
  std::size_t used_ = 0;
};

/// Degrees a second with sign and five decimals, eleven characters; `------` for what is not finite
/// or has more than four digits before the point.
constexpr void put_rate(TextWriter& line, core::AngularRate rate) {
  constexpr float kStepsPerDegree = 1e5F;
  const float steps = rate.in(core::deg_per_s)*kStepsPerDegree;
  if (!core::is_finite(steps) || !(steps > -1e9F && steps < 1e9F)) {
    line.put(" ----.-----");
    return;
  }
  const auto rounded = static_cast<std::int32_t>(steps < 0.0F ? steps - 0.5F : steps + 0.5F);
  const auto magnitude = static_cast<std::uint32_t>(rounded < 0 ? -rounded : rounded);
  line.put(rounded < 0 ? '-' : '+');
  line.put(magnitude / 100'000, 4, ' ');
  line.put('.');
  line.put(magnitude % 100'000, 5, '0');
}

}  // namespace detail

/// `TIME s  MOTION  X Y Z deg/s corrected  flags` and a line end: time in ms, rates in deg/s, `?`
/// until the first calibration, `!` if anything else is not well (see app::Health).
[[nodiscard]] constexpr std::span<const std::uint8_t> write_rate(const app::RateMessage& message,
                                                                 TextLine& text) {
  detail::TextWriter line{text};
  const auto milliseconds =
      static_cast<std::uint64_t>(std::max(std::int64_t{0}, message.time.ns() / 1'000'000));
  line.put(milliseconds / 1000, 7, ' ');
  line.put('.');
  line.put(milliseconds % 1000, 3, '0');
  line.put(" s  ");
  const std::string_view motion = core::name(message.motion);
  line.put(motion);
  for (std::size_t i = motion.size(); i < core::name(core::Motion::settling).size(); ++i) {
    line.put(' ');
  }
  for (const app::AxisRate& axis : message.axes) {
    line.put(' ');
    detail::put_rate(line, axis.corrected);
  }
  line.put(" deg/s");
  app::Health fine;
  fine.calibrated = message.health.calibrated;
  if (!message.health.calibrated) line.put(" ?");
  if (message.health != fine) line.put(" !");
  line.put("\r\n");
  return line.written();
}

}  // namespace zerorate::wire
