// Boats whose odometer stands still for two minutes at a time while they rock: a bias within the
// first stop, and an interval that holds it.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "firmware/app/gyro_node.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tests/system/scenario/play.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::scenario {
namespace {

constexpr auto kPeriod = core::Duration::milliseconds(20);
constexpr double kPeriod_s = 0.02;
constexpr double kBiasInstability_dph = 5.0;
constexpr double kAngleRandomWalk_dps_rthz = 0.005;
constexpr std::size_t kStop = 6'000;   ///< samples
constexpr std::size_t kDrive = 9'000;  ///< samples
constexpr std::size_t kDrives = 3;
constexpr std::uint64_t kBoats = 40;

constexpr core::ModelShape kShape =
    core::with_hypotheses(core::ModelShape{.decaying = 6}, model::kMostHypotheses);
using BoatNode = app::GyroNode<kShape>;

BoatNode::Params params_with(core::StandstillSource source) {
  model::SensorModel sensor;
  sensor.name = "boat";
  sensor.white.angle_random_walk_rad_per_sqrt_s = kAngleRandomWalk_dps_rthz * kDps;
  sensor.flicker =
      model::Flicker{.bias_instability_rad_s = kBiasInstability_dph / 3600.0 * kDps, .decades = 6};
  const auto tick = core::Duration::milliseconds(500);
  return {.model = model::make_node_model<kShape>(sensor, kPeriod, tick),
          .standstill = {.source = source}};
}

/// Messages of one boat.
struct Logbook {
  double from_s = 0.0;
  std::optional<double> calibrated_s;  ///< time of the first message with a bias
  double first_sigma_dps = 0.0;
  int messages = 0;     ///< calibrated ones, of three axes each
  int beyond_five = 0;  ///< biases that lie more than five standard deviations off
  int beyond_two = 0;
};

class Boat {
 public:
  Boat(const BoatNode::Params& params, std::uint64_t number) : node_(params), random_(number) {
    std::uniform_real_distribution<double> amplitude{0.2, 4.0};
    std::uniform_real_distribution<double> frequency{0.05, 0.4};
    std::uniform_real_distribution<double> bias{-0.5, 0.5};
    const std::size_t samples = kDrives * (kStop + kDrive);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (Wave& wave : waves_[axis])
        wave = {amplitude(random_), frequency(random_), 6.28 * amplitude(random_)};
      const std::vector<simulate::Effect> slow{
          simulate::ConstantBias{.bias_rad_s = bias(random_) * kDps},
          simulate::FlickerNoise{.bias_instability_rad_s = kBiasInstability_dph / 3600.0 * kDps}};
      bias_rad_s_[axis] =
          simulate::simulate({samples, kPeriod_s}, slow, random::RandomStream{number, axis})
              .rate_rad_s;
    }
  }

  [[nodiscard]] Logbook sail(double from_s) {
    Logbook log{.from_s = from_s};
    for (std::size_t drive = 0; drive < kDrives; ++drive) {
      for (std::size_t k = 0; k < kStop; ++k) step(false, log);
      for (std::size_t k = 0; k < kDrive; ++k) step(true, log);
    }
    return log;
  }

 private:
  struct Wave {
    double amplitude_dps = 0.0;
    double frequency_hz = 0.0;
    double phase = 0.0;
  };

  void step(bool drives, Logbook& log) {
    const double time_s = static_cast<double>(sample_) * kPeriod_s;
    const core::Instant now =
        core::Instant::from_ns(static_cast<std::int64_t>(sample_) * kPeriod.ns());
    core::GyroSample sample{.time = now};
    std::normal_distribution<double> white{0.0,
                                           kAngleRandomWalk_dps_rthz / std::sqrt(kPeriod_s) * kDps};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double rate_rad_s = bias_rad_s_[axis][sample_] + white(random_);
      for (const Wave& wave : waves_[axis]) {
        rate_rad_s += wave.amplitude_dps * kDps *
                      std::sin(2.0 * std::numbers::pi * wave.frequency_hz * time_s + wave.phase);
      }
      if (drives && axis == 2) rate_rad_s += 5.0 * kDps * std::sin(0.1 * time_s);
      sample.rate[axis] = core::rad_per_s(static_cast<float>(rate_rad_s));
    }
    if (drives && sample_ % 5 == 0) node_.pulse(now);
    note(node_.step(sample), time_s, log);
    ++sample_;
  }
  void note(const app::RateMessage& message, double time_s, Logbook& log) const {
    if (!message.health.calibrated || time_s < log.from_s) return;
    if (!log.calibrated_s) {
      log.calibrated_s = time_s;
      log.first_sigma_dps = double{message.axes[0].sigma.in(core::deg_per_s)};
    }
    ++log.messages;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double error =
          double{message.axes[axis].bias.in(core::rad_per_s)} - bias_rad_s_[axis][sample_];
      const double sigmas = std::abs(error) / double{message.axes[axis].sigma.in(core::rad_per_s)};
      if (sigmas > 5.0) ++log.beyond_five;
      if (sigmas > 2.0) ++log.beyond_two;
    }
  }

  BoatNode node_;
  std::mt19937_64 random_;
  std::array<std::array<Wave, 2>, 3> waves_{};
  std::array<std::vector<double>, 3> bias_rad_s_;
  std::size_t sample_ = 0;
};

struct Fleet {
  double latest_s = 0.0;           ///< latest first bias of a boat
  double largest_sigma_dps = 0.0;  ///< sigma of the first biases
  int without_bias = 0;            ///< boats
  int beyond_five = 0;             ///< errors of axes in messages
  double beyond_two = 0.0;         ///< share of the errors
};

/// @param from_s time from which on messages count
Fleet sail_all(core::StandstillSource source, double from_s) {
  const BoatNode::Params params = params_with(source);
  Fleet fleet;
  double messages = 0.0;
  for (std::uint64_t number = 1; number <= kBoats; ++number) {
    const Logbook log = Boat{params, number}.sail(from_s);
    if (!log.calibrated_s) ++fleet.without_bias;
    fleet.latest_s = std::max(fleet.latest_s, log.calibrated_s.value_or(0.0));
    fleet.largest_sigma_dps = std::max(fleet.largest_sigma_dps, log.first_sigma_dps);
    fleet.beyond_five += log.beyond_five;
    fleet.beyond_two += log.beyond_two;
    messages += log.messages;
  }
  fleet.beyond_two /= 3.0 * messages;
  std::printf("first bias at %.1f s, with %.2f deg/s at most; beyond two deviations %.3f\n",
              fleet.latest_s, fleet.largest_sigma_dps, fleet.beyond_two);
  return fleet;
}

// Neighbouring messages share an error: some 40 boats with 3 axes and 3 stops are independent, 360
// errors. 0.046 of normal errors lie beyond two deviations; 0.08 is three standard errors above.
constexpr double kMostBeyondTwo = 0.08;

TEST(SwayAtEveryStop, GivesABiasWithinTwoMinutes) {
  const Fleet fleet = sail_all(core::StandstillSource::odometer, 0.0);
  EXPECT_EQ(fleet.without_bias, 0);
  EXPECT_LT(fleet.latest_s, 120.0);
  EXPECT_LT(fleet.largest_sigma_dps, 8.0);  // less than the waves
  EXPECT_EQ(fleet.beyond_five, 0);
  EXPECT_LT(fleet.beyond_two, kMostBeyondTwo);
}

// Every stop is rest, whatever the gyro shows, so sway is white noise to this node. It has seen the
// noise after five seconds.
TEST(SwayUnderAnOdometerAlone, IsAveragedFromTheFirstSeconds) {
  const Fleet fleet = sail_all(core::StandstillSource::odometer_alone, 5.0);
  EXPECT_EQ(fleet.without_bias, 0);
  EXPECT_LT(fleet.latest_s, 6.0);
  EXPECT_LT(fleet.beyond_two, kMostBeyondTwo);
}

}  // namespace
}  // namespace zerorate::scenario
