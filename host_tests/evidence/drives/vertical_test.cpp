// The turn about the vertical of vehicles that climb and lean, by a gyro of any mounting with an
// accelerometer beside it: is it as good as that of a level sensor on a level road?

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "host_tests/evidence/drives/turning_vehicle.hpp"

namespace zerorate::drives {
namespace {

using Vector = Eigen::Vector3d;

constexpr core::ModelShape kShape{
    .decaying = 6, .has_accelerometer = true, .hypotheses = model::kMostHypotheses};
constexpr core::ModelShape kShapeWithout{.decaying = 6, .hypotheses = model::kMostHypotheses};
template <core::ModelShape Shape>
using NodeOf = app::GyroNode<Shape, app::NodeCapacity{.held_ticks = 8,
                                                      .runs_moving_average = false,
                                                      .runs_calibration_mean = false}>;
constexpr std::size_t kDrives = 3;
constexpr std::size_t kSamples = samples_of(kDrives);
constexpr double kSpeed_mps = 6.0;

struct World {
  double hills = 0.0;    ///< grade of hills, 50 s long
  double ramp = 0.0;     ///< grade of a ramp that turns upwards for a minute
  double parking = 0.0;  ///< standard deviation of the grade of a parking place
  Eigen::Matrix3d mounting = Eigen::Matrix3d::Identity();  ///< from the vehicle to the sensor
};

/// Attitude of a vehicle and its speed, sample by sample: x forward, y to the left, z up.
struct Path {
  std::vector<double> yaw_rad;
  std::vector<double> pitch_rad;  ///< nose up
  std::vector<double> speed_mps;
};

Path path_of(const World& world, std::uint64_t seed) {
  Path path;
  std::vector<double> rate_dps = corners_dps(kSamples, random::RandomStream{seed, 1});
  const random::RandomStream places{seed, 2};
  double yaw_rad = 0.0;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const std::size_t phase = k % (kStop + kDrive);
    const double t_s = phase < kStop ? 0.0 : static_cast<double>(phase - kStop) * kPeriod_s;
    const auto drive = static_cast<std::int64_t>(k / (kStop + kDrive));
    const double left_s = static_cast<double>(kDrive) * kPeriod_s - t_s;
    const bool drives = is_driving(k);
    double grade = 0.0;
    if (drives && world.ramp > 0.0) {
      const double share =
          std::clamp((t_s - 10.0) / 3.0, 0.0, 1.0) * std::clamp((left_s - 20.0) / 3.0, 0.0, 1.0);
      rate_dps[k] = 20.0 * share;
      grade = world.ramp * share;
    }
    if (drives) grade += world.hills * std::sin(2.0 * std::numbers::pi * t_s / 50.0);
    // From the slope of a parking place to that of the next one within the drive.
    const double place = drives ? t_s / (t_s + left_s) : 0.0;
    grade +=
        world.parking * ((1.0 - place) * places.normal(drive) + place * places.normal(drive + 1));
    yaw_rad += rate_dps[k] * kRadPerDeg * kPeriod_s;
    path.yaw_rad.push_back(yaw_rad);
    path.pitch_rad.push_back(std::atan(grade));
    path.speed_mps.push_back(drives ? kSpeed_mps * std::min({1.0, t_s / 4.0, left_s / 4.0}) : 0.0);
  }
  return path;
}
Eigen::Matrix3d attitude(const Path& path, std::size_t k) {
  return (Eigen::AngleAxisd(path.yaw_rad[k], Vector::UnitZ()) *
          Eigen::AngleAxisd(-path.pitch_rad[k], Vector::UnitY()))
      .toRotationMatrix();
}

struct Ending {
  double error_deg;
  double sigma_deg;
};

/// Turns about the vertical at the ends of the drives of one sensor.
template <core::ModelShape Shape>
std::vector<Ending> run(const World& world, std::uint64_t seed, std::optional<core::UpAxis> up) {
  using Node = NodeOf<Shape>;
  model::SensorModel sensor = model::find_model("lsm6dso");
  sensor.scale_factor = model::ScaleFactor{.sigma = 0.0};
  const typename Node::Params params{
      .model = model::make_node_model<Shape>(sensor, core::Duration::milliseconds(50),
                                             core::Duration::milliseconds(500)),
      .up = up};
  Node node{params};
  const Path path = path_of(world, seed);
  std::vector<std::vector<double>> noise;
  for (std::uint64_t i = 0; i < 3; ++i) {
    noise.push_back(rest_noise_rad_s(kSamples, kPeriod_s, random::RandomStream{seed, 10 + i}));
  }
  const random::RandomStream shaking{seed, 20};
  std::vector<Ending> endings;
  double departed_rad = 0.0;
  for (std::size_t k = 1; k < kSamples; ++k) {
    const Eigen::Matrix3d now = attitude(path, k);
    const Eigen::AngleAxisd turned(attitude(path, k - 1).transpose() * now);
    const Vector rate = world.mounting * (turned.axis() * turned.angle() / kPeriod_s);
    const double yaw_rad_s = (path.yaw_rad[k] - path.yaw_rad[k - 1]) / kPeriod_s;
    const double speed = path.speed_mps[k];
    const Vector pushed((speed - path.speed_mps[k - 1]) / kPeriod_s, speed * yaw_rad_s, 0.0);
    const Vector force = world.mounting * (now.transpose() * Vector::UnitZ() + pushed / 9.80665);
    core::GyroSample sample{.time = time_of(k)};
    sample.has_acceleration = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      const double shake_g =
          (0.002 + 0.003 * speed) * shaking.normal(static_cast<std::int64_t>(3 * k + i));
      sample.rate[i] = core::rad_per_s(static_cast<float>(rate[axis] + noise[i][k]));
      sample.acceleration[i] = core::standard_gravity(static_cast<float>(force[axis] + shake_g));
    }
    if (is_driving(k)) node.pulse(sample.time);
    const app::RateMessage message = node.step(sample);
    if (k + 1 == kSamples || is_driving(k + 1) == is_driving(k)) continue;
    if (!is_driving(k)) {
      departed_rad = path.yaw_rad[k];
    } else {
      endings.push_back({double{message.vertical_turn.angle.in(core::deg)} -
                             (path.yaw_rad[k] - departed_rad) / kRadPerDeg,
                         double{message.vertical_turn.sigma.in(core::deg)}});
    }
  }
  return endings;
}

struct Row {
  double rms_deg = 0.0;
  double coverage = 0.0;
};
constexpr std::uint64_t kSensors = 100;

template <core::ModelShape Shape>
Row row(const char* name, const World& world, std::optional<core::UpAxis> up = std::nullopt) {
  Row row;
  double count = 0.0;
  for (std::uint64_t sensor = 0; sensor < kSensors; ++sensor) {
    for (const Ending& end : run<Shape>(world, 3000 + sensor, up)) {
      row.rms_deg += end.error_deg * end.error_deg;
      row.coverage += std::abs(end.error_deg) < 1.96 * end.sigma_deg ? 1.0 : 0.0;
      ++count;
    }
  }
  row = {std::sqrt(row.rms_deg / count), row.coverage / count};
  std::printf("%-34s rms %.3f deg, coverage %.3f\n", name, row.rms_deg, row.coverage);
  return row;
}
Eigen::Matrix3d turned_by(double degrees, const Vector& axis) {
  return Eigen::AngleAxisd(degrees * kRadPerDeg, axis.normalized()).toRotationMatrix();
}

// 300 drives a row, with the same noise in each: the ratios err by far less than the rms itself,
// whose standard error is 4 %. A coverage of 0.96 has a standard error of 0.011.
TEST(TurnAboutTheMeasuredVertical, IsAsGoodAsThatOfALevelSensor) {
  const Row level = row<kShapeWithout>("level, given axis", {}, core::UpAxis{});
  struct Case {
    const char* name;
    World world;
  };
  for (const Case& one :
       {Case{"level", {}}, Case{"5 deg askew", {.mounting = turned_by(5.0, {1.0, 1.0, 0.0})}},
        Case{"any mounting", {.mounting = turned_by(130.0, {1.0, -0.4, 0.3})}},
        Case{"hills of 8 %", {.hills = 0.08, .parking = 0.03}},
        Case{"ramps of 10 %", {.ramp = 0.10, .parking = 0.03}},
        Case{"askew, hills, slopes",
             {.hills = 0.08, .parking = 0.05, .mounting = turned_by(5.0, {1.0, 1.0, 0.0})}}}) {
    const Row found = row<kShape>(one.name, one.world);
    EXPECT_LE(found.rms_deg, 1.15 * level.rms_deg) << one.name;
    EXPECT_GE(found.coverage, 0.93) << one.name;
  }
  (void)row<kShapeWithout>("5 deg askew, given axis", {.mounting = turned_by(5.0, {1.0, 1.0, 0.0})},
                           core::UpAxis{});
  (void)row<kShapeWithout>("ramps of 10 %, given axis", {.ramp = 0.10, .parking = 0.03},
                           core::UpAxis{});
}

}  // namespace
}  // namespace zerorate::drives
