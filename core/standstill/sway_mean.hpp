/// @file
/// Mean rate of a vehicle that stands and sways: a boat, a car that is loaded.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"

namespace zerorate::core {

/// Averages the rate over 48 s of a stop, calm or not. The spread of eight parts of 6 s shows the
/// error of the mean.
///
/// A vehicle that sways comes back, so its mean rate is the bias. One that turns under a silent
/// odometer does not. The mean is valid only where the rate varies by more than its mean: then the
/// turning, if it is one, goes to and fro.
///
/// Cost of a tick: 12 floating-point operations an axis.
template <std::size_t Axes>
class SwayMean {
 public:
  using Rates = std::array<float, Axes>;

  struct State {
    Rates part_rad_s{};        ///< sum of the ticks of the part being filled
    Rates mean_rad_s{};        ///< mean of the parts before
    Rates squares_rad2_s2{};   ///< sum of the squared deviations of the parts
    float energy_rad2_s2 = 0;  ///< sum of the squared rates of all ticks and axes
    std::uint16_t ticks = 0;   ///< ticks of the part being filled
    std::uint8_t parts = 0;    ///< parts before

    constexpr bool operator==(const State&) const = default;
  };

  constexpr explicit SwayMean(Duration tick)
      : ticks_of_part_(static_cast<std::uint16_t>(
            std::clamp(kPart / tick, std::int64_t{1}, std::int64_t{0xFFFF}))) {}

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// True if a restored state is valid.
  [[nodiscard]] static bool is_possible(const State& state) {
    return are_plausible(state.part_rad_s) && are_plausible(state.mean_rad_s) &&
           are_plausible_variances(state.squares_rad2_s2) &&
           is_plausible_variance(state.energy_rad2_s2) && state.parts <= kParts;
  }

  /// Begins anew.
  constexpr void clear() { state_ = {}; }
  /// The next tick of the stop.
  constexpr void add(const Rates& rate_rad_s) {
    if (is_complete()) clear();
    for (std::size_t i = 0; i < Axes; ++i) {
      state_.part_rad_s[i] += rate_rad_s[i];
      state_.energy_rad2_s2 += rate_rad_s[i] * rate_rad_s[i];
    }
    if (++state_.ticks == ticks_of_part_) close_part();
  }

  /// True until the next tick if the mean is one of 48 s.
  [[nodiscard]] constexpr bool is_complete() const { return state_.parts == kParts; }
  [[nodiscard]] constexpr const Rates& mean_rad_s() const { return state_.mean_rad_s; }
  /// Whether the rate goes to and fro, rather than on.
  [[nodiscard]] constexpr bool sways() const {
    float mean2 = 0.0F;
    for (const float mean : state_.mean_rad_s) mean2 += mean * mean;
    const float ticks = static_cast<float>(ticks_of_part_) * static_cast<float>(kParts);
    return state_.energy_rad2_s2 > 2.0F * mean2 * ticks;
  }
  /// Variance of the error of the mean, of the axis that sways most: that of a part, as if the
  /// parts had the same error. Those of a slow sway nearly have.
  [[nodiscard]] constexpr float variance_rad2_s2() const {
    float largest = 0.0F;
    for (const float squares : state_.squares_rad2_s2) largest = std::max(largest, squares);
    return largest / static_cast<float>(kParts - 1);
  }

 private:
  static constexpr Duration kPart = Duration::seconds(6);
  static constexpr std::uint8_t kParts = 8;

  constexpr void close_part() {
    ++state_.parts;
    const float share = 1.0F / static_cast<float>(state_.parts);
    for (std::size_t i = 0; i < Axes; ++i) {
      const float part = state_.part_rad_s[i] / static_cast<float>(ticks_of_part_);
      const float change = part - state_.mean_rad_s[i];
      state_.mean_rad_s[i] += share * change;
      state_.squares_rad2_s2[i] += change * (part - state_.mean_rad_s[i]);
    }
    state_.part_rad_s = {};
    state_.ticks = 0;
  }

  std::uint16_t ticks_of_part_;
  State state_{};
};

}  // namespace zerorate::core
