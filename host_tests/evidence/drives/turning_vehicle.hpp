/// @file
/// A vehicle that stops for half a minute and drives round corners for 100 s, in turn.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "firmware/app/gyro_node.hpp"
#include "firmware/model/catalogue.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tests/evidence/drives/made_noise.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::drives {

inline constexpr core::ModelShape kTurningShape{.decaying = 6,
                                                .hypotheses = model::kMostHypotheses};
using TurningNode = app::GyroNode<kTurningShape, app::NodeCapacity{.axes = 1,
                                                                   .held_ticks = 8,
                                                                   .runs_moving_average = false,
                                                                   .runs_calibration_mean = false}>;
inline constexpr double kRadPerDeg = double{core::kRadPerDeg};
inline constexpr double kPeriod_s = 0.05;
inline constexpr std::size_t kStop = 600;    ///< samples: 30 s
inline constexpr std::size_t kDrive = 2000;  ///< samples: 100 s

/// Samples of some drives with a stop before each of them and after the last one.
constexpr std::size_t samples_of(std::size_t drives) {
  return (kStop + kDrive) * drives + kStop;
}
/// Whether the vehicle moves in sample k.
constexpr bool is_driving(std::size_t k) {
  return k % (kStop + kDrive) >= kStop;
}
inline core::Instant time_of(std::size_t k) {
  return core::Instant::from_ns(static_cast<std::int64_t>(k) * 50'000'000);
}

/// Corners of 90 deg at up to 40 deg/s, to the left twice as often: 200 deg turned a drive and
/// more.
inline std::vector<double> corners_dps(std::size_t samples, const random::RandomStream& stream) {
  std::vector<double> rate_dps(samples, 0.0);
  constexpr std::size_t kCorner = 90;  // samples: 4.5 s
  for (std::size_t k = 0; k < samples; k += 200) {
    if (!is_driving(k) || !is_driving(k + kCorner) ||
        stream.uniform(static_cast<std::int64_t>(2 * k)) < 0.5)
      continue;
    const double sign = stream.uniform(static_cast<std::int64_t>(2 * k + 1)) < 0.67 ? 1.0 : -1.0;
    for (std::size_t i = 0; i < kCorner; ++i) {
      const double phase = (static_cast<double>(i) + 0.5) / static_cast<double>(kCorner);
      rate_dps[k + i] += sign * 40.0 * std::pow(std::sin(std::numbers::pi * phase), 2.0);
    }
  }
  return rate_dps;
}

/// Parameters of a node whose model has a tolerance of the scale factor.
/// @param hypotheses of its noise; 1: the model is taken at its word
inline TurningNode::Params turning_params(double tolerance, int hypotheses = model::kMostHypotheses,
                                          double tilt_rad = 0.0) {
  model::SensorModel sensor = model::find_model("lsm6dso");
  sensor.scale_factor = model::ScaleFactor{.sigma = tolerance};
  sensor.learning = model::Learning{.hypotheses = hypotheses};
  // Its roads are level.
  if (tilt_rad > 0.0) {
    sensor.mounting = model::Mounting{.tilt_sigma_rad = tilt_rad, .slope_sigma = 0.0};
  }
  const core::Duration period = core::Duration::milliseconds(50);
  const core::Duration tick = core::Duration::milliseconds(500);
  return {.model = model::make_node_model<kTurningShape>(sensor, period, tick)};
}

}  // namespace zerorate::drives
