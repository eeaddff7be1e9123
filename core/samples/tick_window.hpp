/// @file
/// Means over windows of about half a second, and their spread.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"

namespace zerorate::core {

/// Standard deviations by which a rate at rest misses its prediction before it is doubted.
inline constexpr float kFarSigmas = 5.0F;

/// Largest window that eight bits count, at least one tick.
[[nodiscard, gnu::noinline]] constexpr std::uint8_t ticks_in_u8(Duration length, Duration tick) {
  return static_cast<std::uint8_t>(std::clamp(length / tick, std::int64_t{1}, std::int64_t{0xFF}));
}
/// Ticks of half a second: long enough for the rotation of an idling engine to cancel.
[[nodiscard]] constexpr std::uint8_t window_ticks(Duration tick) {
  return ticks_in_u8(Duration::milliseconds(500), tick);
}

/// A window that is being filled with the means of ticks, each weighted by its samples.
template <std::size_t Axes>
struct TickWindow {
  using Rates = std::array<float, Axes>;

  Rates sum_rad_s{};          ///< sum of the samples
  std::uint32_t samples = 0;  ///< number of samples
  std::uint8_t ticks = 0;     ///< number of ticks; 255: or more

  constexpr bool operator==(const TickWindow&) const = default;
  [[nodiscard]] static bool is_possible(const TickWindow& window) {
    return are_plausible(window.sum_rad_s) && (window.ticks == 0) == (window.samples == 0);
  }

  constexpr void add(const Rates& mean_rad_s, std::uint32_t of_samples) {
    const auto weight = static_cast<float>(of_samples);
    for (std::size_t i = 0; i < Axes; ++i) sum_rad_s[i] += mean_rad_s[i] * weight;
    samples += of_samples;
    if (ticks < 0xFF) ++ticks;
  }
  /// Mean rate of the window; it holds at least one sample.
  [[nodiscard]] constexpr Rates mean_rad_s() const {
    const float share = 1.0F / static_cast<float>(samples);
    Rates mean{};
    for (std::size_t i = 0; i < Axes; ++i) mean[i] = sum_rad_s[i] * share;
    return mean;
  }
};

/// Sample variance of three consecutive windows, axis by axis: T = (a^2 + a b + b^2) / 3 with a and
/// b their two differences. White noise makes it the variance of a window's mean; a rotation that
/// begins or ends makes it far larger (docs/adr/0017).
template <std::size_t Axes>
struct WindowSpread {
  using Rates = std::array<float, Axes>;

  std::array<Rates, 2> newest_rad_s{};  ///< means of the two newest windows
  std::uint8_t known = 0;               ///< number of those means, at most 2

  constexpr bool operator==(const WindowSpread&) const = default;
  [[nodiscard]] static bool is_possible(const WindowSpread& spread) {
    return are_plausible(spread.newest_rad_s[0]) && are_plausible(spread.newest_rad_s[1]) &&
           spread.known <= 2;
  }

  /// Takes the mean of the next window.
  /// @param spread of the three newest windows, where there are three
  /// @return whether there are three
  constexpr bool take(const Rates& mean_rad_s, Rates& spread) {
    const bool are_three = known == 2;
    for (std::size_t i = 0; i < Axes; ++i) {
      const float a = mean_rad_s[i] - newest_rad_s[0][i];
      const float b = newest_rad_s[0][i] - newest_rad_s[1][i];
      spread[i] = (a * a + a * b + b * b) * (1.0F / 3.0F);
    }
    newest_rad_s = {mean_rad_s, newest_rad_s[0]};
    if (known < 2) ++known;
    return are_three;
  }
};

}  // namespace zerorate::core
