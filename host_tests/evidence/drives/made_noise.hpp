/// @file
/// Noise of a made sensor at rest.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/units.hpp"
#include "firmware/model/catalogue.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::drives {

/// Rate of an LSM6DSO at rest in rad/s, with the figures of its model and a bias of 0.3 deg/s.
inline std::vector<double> rest_noise_rad_s(std::size_t samples, double period_s,
                                            const random::RandomStream& stream) {
  const model::SensorModel sensor = model::find_model("lsm6dso");
  const std::vector<simulate::Effect> effects{
      simulate::ConstantBias{.bias_rad_s = 0.3 * double{core::kRadPerDeg}},
      simulate::WhiteNoise{.angle_random_walk_rad_rt_s =
                               sensor.white.angle_random_walk_rad_per_sqrt_s},
      simulate::FlickerNoise{.bias_instability_rad_s = sensor.flicker->bias_instability_rad_s,
                             .order = 0.5}};
  return simulate::simulate(simulate::Signal{samples, period_s}, effects, stream).rate_rad_s;
}

}  // namespace zerorate::drives
