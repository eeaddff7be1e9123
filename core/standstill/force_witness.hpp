/// @file
/// Specific force as a witness of motion.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/numeric.hpp"
#include "core/inputs/accelerometer.hpp"
#include "core/standstill/rest_spread.hpp"

namespace zerorate::core {

/// Judges the specific force of the windows that CalmJudge judges the rates of. A vehicle that
/// starts, brakes or rolls over a joint changes it by far more than the noise. At constant speed on
/// a smooth floor it does not.
///
/// Below 3 mg of spread nothing counts as motion: wind and passengers tilt a body by as much.
class ForceWitness {
 public:
  using Force = TickForce;

  constexpr bool operator==(const ForceWitness&) const = default;
  /// True if a restored witness is valid.
  [[nodiscard]] static bool is_possible(const ForceWitness& witness) {
    return RestSpread<3>::is_possible(witness.spread_) &&
           is_plausible_variance(witness.variance_g2_);
  }

  /// Adds a tick to the window. One without readings adds nothing.
  constexpr void add(const TickForce& tick) {
    if (tick.readings == 0) return;
    spread_.add(tick.mean_g, tick.readings);
    variance_g2_ += tick.variance_g2 * static_cast<float>(tick.readings);
  }
  /// The window is over. Unknown without readings.
  /// @param is_alone whether there is no odometer: then most of what is judged is motion, and the
  ///   vibration of a road may not count as that of an engine at rest
  constexpr RestVerdict close(bool is_alone) {
    if (spread_.window().samples == 0) {
      spread_.restart();
      return RestVerdict::unknown;
    }
    const auto readings = static_cast<float>(spread_.window().samples);
    const float of_mean_g2 = variance_g2_ / (3.0F * readings * readings);
    const float tolerated_g2 = is_alone ? 0.0F : kLocalShare * of_mean_g2;
    variance_g2_ = 0.0F;
    return spread_.close(is_alone, kLeast_g2, {tolerated_g2, tolerated_g2, tolerated_g2});
  }
  constexpr void restart() {
    spread_.restart();
    variance_g2_ = 0.0F;
  }

 private:
  static constexpr float kLeast_g2 = 0.3e-3F * 0.3e-3F;
  /// Share of the variance of a window's mean, as the readings within a tick explain it, that
  /// counts as rest: that of CalmJudge.
  static constexpr float kLocalShare = 0.05F;

  RestSpread<3> spread_;
  float variance_g2_ = 0.0F;
};

/// Place of a witness in a node without an accelerometer.
struct NoWitness {
  using Force = NoForce;
  constexpr bool operator==(const NoWitness&) const = default;
  [[nodiscard]] static constexpr bool is_possible(NoWitness /*witness*/) { return true; }
  constexpr void add(NoForce /*tick*/) {}
  [[nodiscard]] constexpr RestVerdict close(bool /*is_alone*/) const {
    return RestVerdict::unknown;
  }
  constexpr void restart() {}
};

/// Witness of a node with or without an accelerometer.
template <bool HasAccelerometer>
using WitnessOf = std::conditional_t<HasAccelerometer, ForceWitness, NoWitness>;

}  // namespace zerorate::core
