/// @file
/// Spread of three windows, against the level that it has at rest.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/samples/tick_window.hpp"

namespace zerorate::core {

/// Outcome of a window.
enum class RestVerdict : std::uint8_t { unknown, rest, motion };

/// Separates motion from rest by the spread of three windows (WindowSpread), axis by axis, divided
/// by the level that this sensor has at rest: the sum of the ratios decides (docs/adr/0017).
///
/// The level is a low quantile of the spread, followed by steps (Robbins and Monro 1951), so that
/// half of a stop may be motion, and an engine that starts raises it within bounded time.
///
/// Cost of a window: some 60 floating-point operations and 6 divisions.
template <std::size_t Axes>
class RestSpread {
 public:
  using Values = std::array<float, Axes>;

  constexpr bool operator==(const RestSpread&) const = default;
  /// True if a restored spread is valid.
  [[nodiscard]] static bool is_possible(const RestSpread& spread) {
    return are_plausible_variances(spread.level_) &&
           TickWindow<Axes>::is_possible(spread.window_) &&
           WindowSpread<Axes>::is_possible(spread.windows_) && spread.step_ >= 0.0F &&
           spread.step_ <= kFirstStep;
  }

  /// Adds the mean of a tick to the window.
  constexpr void add(const Values& mean, std::uint32_t samples) { window_.add(mean, samples); }
  [[nodiscard]] constexpr const TickWindow<Axes>& window() const { return window_; }
  /// Whether no window is known but the one being filled.
  [[nodiscard]] constexpr bool is_first_window() const { return windows_.known == 0; }
  /// The window is over, and the next one begins. Unknown before the third window.
  /// @param is_mostly_motion whether most of what is judged is motion
  /// @param least smallest level that a window's mean can have
  /// @param tolerated level at which a spread still counts as rest; it is not learnt
  constexpr RestVerdict close(bool is_mostly_motion, float least, const Values& tolerated) {
    Values spread{};
    const bool is_known = windows_.take(window_.mean_rad_s(), spread);
    window_ = {};
    if (!is_known) return RestVerdict::unknown;
    if (step_ == 0.0F) start_levels(spread);
    const bool is_rest = is_rest_spread(spread, least, tolerated);
    follow_levels(is_mostly_motion, spread, least);
    return is_rest ? RestVerdict::rest : RestVerdict::motion;
  }
  /// Time passed that belongs to no window. The levels stay.
  constexpr void restart() {
    windows_ = {};
    window_ = {};
  }

 private:
  /// Sum of the ratios over three axes that is motion: six standard deviations on one of them. Half
  /// and twice as much change the heading error by less than 3 % (docs/adr/0017).
  static constexpr float kMotion = 100.0F * static_cast<float>(Axes) / 3.0F;
  static constexpr float kFirstStep = 0.5F;  ///< first step of the levels; shrinks by a tenth

  /// The spread of one axis alone may be small by chance, and then all that follows is motion: no
  /// level starts below the mean.
  constexpr void start_levels(const Values& spread) {
    float mean = 0.0F;
    for (const float one : spread) mean += one * (1.0F / static_cast<float>(Axes));
    for (std::size_t i = 0; i < Axes; ++i) level_[i] = std::max(spread[i], mean);
    step_ = kFirstStep;
  }
  [[nodiscard]] constexpr bool is_rest_spread(const Values& spread, float least,
                                              const Values& tolerated) const {
    float sum = 0.0F;
    for (std::size_t i = 0; i < Axes; ++i) {
      sum += spread[i] / std::max({level_[i], tolerated[i], least});
    }
    return sum <= kMotion;
  }
  constexpr void follow_levels(bool is_mostly_motion, const Values& spread, float least) {
    const float quantile = is_mostly_motion ? 0.1F : 0.3F;
    const float least_step = is_mostly_motion ? 0.03F : 0.1F;
    const float up = 1.0F + quantile * step_;
    const float down = 1.0F - (1.0F - quantile) * step_;
    for (std::size_t i = 0; i < Axes; ++i) {
      float& level = level_[i];
      level = std::max(level * (spread[i] > level ? up : down), least);
    }
    constexpr float kShrink = 0.9F;
    step_ = std::max(kShrink * step_, least_step);
  }

  Values level_{};              ///< spread of three windows at rest
  TickWindow<Axes> window_;     ///< window being filled
  WindowSpread<Axes> windows_;  ///< windows before it
  float step_ = 0.0F;           ///< step of the levels, shrinking; 0: there are no levels yet
};

}  // namespace zerorate::core
