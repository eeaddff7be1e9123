/// @file
/// Description of an odometer, as far as somebody knows it.
#pragma once

#include <algorithm>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "core/standstill/standstill.hpp"

namespace zerorate::core {

/// Properties of an odometer; 0: not known. The calm is judged inside the stops whatever they are
/// (CalmJudge): what is known only shortens the waiting, or lengthens it where a pulse is late.
struct OdometerTraits {
  float dead_band_mps = 0.0F;     ///< speed below which no pulse comes; of a car's bus 0.3 to 1 m/s
  Duration latency;               ///< from the motion to the stamp of its pulse
  float metres_per_pulse = 0.0F;  ///< distance from one pulse to the next

  constexpr bool operator==(const OdometerTraits&) const = default;
};

/// Parameters of the standstill for this odometer. The first pulse of a drive comes `latency` after
/// the vehicle has reached the dead band, which takes a driver who sets off gently (1 m/s^2) a
/// second for each m/s: so much longer a tick is held back. A vehicle with a pulse each
/// `metres_per_pulse` cannot be slower than the dead band between two of them: twice that silence
/// is enough.
[[nodiscard]] constexpr Standstill::Params adapted_to(const OdometerTraits& odometer,
                                                      Standstill::Params params) {
  constexpr float kFastest_mps = 2000.0F;
  params.hold_back = params.hold_back + odometer.latency;
  if (!is_finite_positive(odometer.dead_band_mps)) return params;
  // 32 bits: the conversion to 64 brings double precision into the program of a Cortex-M0+.
  const float microseconds = std::min(odometer.dead_band_mps, kFastest_mps) * 1e6F;
  params.hold_back =
      params.hold_back + Duration::microseconds(static_cast<std::int32_t>(microseconds));
  if (is_finite_positive(odometer.metres_per_pulse)) {
    const float silence_ns = 2.0F * odometer.metres_per_pulse / odometer.dead_band_mps * 1e9F;
    constexpr float kLongest_ns = 1e18F;
    params.slowest = std::min(
        params.slowest,
        Duration::nanoseconds(static_cast<std::int64_t>(std::min(silence_ns, kLongest_ns))));
  }
  return params;
}

}  // namespace zerorate::core
