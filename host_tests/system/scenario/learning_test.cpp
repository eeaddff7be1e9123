// A node that learns its noise model beside one that has the true one, and beside sensors that no
// hypothesis describes. A minute of standstill and a minute of driving in turn, an hour, two
// samples a second. All figures are printed.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "host_tests/system/scenario/peer_sensor.hpp"
#include "host_tests/system/scenario/slow_node.hpp"

namespace zerorate::scenario {
namespace {

constexpr core::ModelShape kKnown{.decaying = 6};
constexpr core::ModelShape kLearning = core::with_hypotheses(kKnown, model::kMostHypotheses);
constexpr double kDph = kRadPerDeg / 3600.0;
constexpr std::size_t kMinute = 120;  ///< samples
constexpr std::size_t kCycles = 30;
constexpr std::size_t kLearnt = 15;  ///< cycles of the first half hour
constexpr double kWrong = 4.0;       ///< factor that a data sheet is off by

/// Errors of an axis over a drive, and the node's variances of them.
struct Drive {
  double bias_rad_s = 0.0;  ///< at the end
  double heading_rad = 0.0;
  double heading_sigma_rad = 0.0;
};
struct Run {
  std::vector<std::array<Drive, 3>> drives;
  bool is_inconsistent = false;        ///< at any time
  bool is_inconsistent_early = false;  ///< within half an hour
};
/// The cycles from one to another.
struct Cycles {
  std::size_t begin = 0;
  std::size_t end = kCycles;
};
constexpr Cycles kAfterHalfAnHour{.begin = kLearnt};

template <core::ModelShape Shape>
Run play(const app::NodeParams<Shape>& params, const SlowGyro& gyro) {
  app::GyroNode<Shape> node{params};
  Run run;
  for (std::size_t cycle = 0; cycle < kCycles; ++cycle) {
    const std::size_t departure = (2 * cycle + 1) * kMinute;
    const std::size_t arrival = departure + kMinute;
    std::array<Drive, 3> drive{};
    for (std::size_t k = departure - kMinute; k < arrival; ++k) {
      const app::RateMessage message = step_slowly(node, gyro, k, k, k >= departure);
      run.is_inconsistent |= message.health.model_inconsistent;
      if (k < departure) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (k == departure) {
          drive[axis].heading_sigma_rad =
              double{node.predict_heading(app::Predictor::kalman, axis, slow_instant(k),
                                          slow_instant(arrival))
                         .sigma_rad()};
        }
        drive[axis].bias_rad_s = left_rad_s(node, gyro, k, axis);
        drive[axis].heading_rad += kSlowPeriod_s * drive[axis].bias_rad_s;
      }
    }
    run.drives.push_back(drive);
    if (cycle + 1 == kLearnt) run.is_inconsistent_early = run.is_inconsistent;
  }
  return run;
}

/// Figure with its standard error.
struct Estimate {
  double value = 0.0;
  double error = 0.0;
};

/// Ratio of the rms errors of two nodes on the same gyros. Drives of one axis of a run depend on
/// each other, those of two do not: the standard error is that of the axes' sums.
Estimate rms_ratio(const std::vector<Run>& ours, const std::vector<Run>& theirs,
                   double Drive::*figure) {
  const auto squares = [&](const Run& run, std::size_t axis) {
    double sum = 0.0;
    for (std::size_t i = kAfterHalfAnHour.begin; i < kAfterHalfAnHour.end; ++i) {
      sum += std::pow(run.drives[i][axis].*figure, 2);
    }
    return sum;
  };
  double our_sum = 0.0;
  double their_sum = 0.0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      our_sum += squares(ours[i], axis);
      their_sum += squares(theirs[i], axis);
    }
  }
  double variance = 0.0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      variance +=
          std::pow(squares(ours[i], axis) / our_sum - squares(theirs[i], axis) / their_sum, 2);
    }
  }
  const double ratio = std::sqrt(our_sum / their_sum);
  return {.value = ratio, .error = 0.5 * ratio * std::sqrt(variance)};
}

/// Share of the drives whose heading error lies in its 95 % interval.
Estimate coverage(const std::vector<Run>& runs, Cycles cycles) {
  std::vector<double> shares;
  double mean = 0.0;
  for (const Run& run : runs) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double covered = 0.0;
      for (std::size_t i = cycles.begin; i < cycles.end; ++i) {
        const Drive& drive = run.drives[i][axis];
        covered += std::abs(drive.heading_rad) <= 1.96 * drive.heading_sigma_rad ? 1.0 : 0.0;
      }
      shares.push_back(covered / static_cast<double>(cycles.end - cycles.begin));
      mean += shares.back();
    }
  }
  const auto count = static_cast<double>(shares.size());
  mean /= count;
  double variance = 0.0;
  for (const double share : shares) variance += std::pow(share - mean, 2);
  return {.value = mean, .error = std::sqrt(variance) / count};
}

std::size_t count(const std::vector<Run>& runs, bool Run::*flag) {
  return static_cast<std::size_t>(
      std::count_if(runs.begin(), runs.end(), [&](const Run& run) { return run.*flag; }));
}

std::vector<SlowGyro> gyros_of(double arw_dps_rt_s, const std::vector<simulate::Effect>& effects,
                               std::uint64_t runs) {
  std::vector<SlowGyro> gyros;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    gyros.emplace_back(2 * kMinute * kCycles, arw_dps_rt_s * kRadPerDeg, seed,
                       [&](const random::RandomStream&) { return effects; });
  }
  return gyros;
}

template <core::ModelShape Shape>
std::vector<Run> play_all(const app::NodeParams<Shape>& params,
                          const std::vector<SlowGyro>& gyros) {
  std::vector<Run> runs;
  for (const SlowGyro& gyro : gyros) runs.push_back(play<Shape>(params, gyro));
  return runs;
}

/// Bars that the sample may miss by three of its standard errors.
constexpr double kGreatestRatio = 1.02;
constexpr double kLeastCoverage = 0.94;
constexpr double kGreatestCoverage = 0.96;

void expect_as_good_as_knowing(const PeerSensor& sensor) {
  struct Factors {
    double white;
    double slow;
  };
  const auto gyros = gyros_of(sensor.arw_dps_rt_s, effects_of(sensor), 100);
  const auto knowing = play_all<kKnown>(params_of<6>(sensor), gyros);
  for (const Factors off :
       {Factors{1.0, kWrong}, {1.0, 1.0 / kWrong}, {kWrong, 1.0}, {1.0 / kWrong, 1.0}}) {
    const auto learning =
        play_all<kLearning>(slow_params<kLearning>(data_sheet(sensor, off.white, off.slow)), gyros);
    const Estimate bias = rms_ratio(learning, knowing, &Drive::bias_rad_s);
    const Estimate heading = rms_ratio(learning, knowing, &Drive::heading_rad);
    const Estimate covered = coverage(learning, kAfterHalfAnHour);
    std::printf(
        "%s, white noise times %.2f, slow noise times %.2f: bias %.4f (%.4f), heading %.4f "
        "(%.4f) of the knowing filter's, coverage %.3f (%.3f)\n",
        sensor.name, off.white, off.slow, bias.value, bias.error, heading.value, heading.error,
        covered.value, covered.error);
    EXPECT_LE(bias.value, kGreatestRatio + 3.0 * bias.error);
    EXPECT_LE(heading.value, kGreatestRatio + 3.0 * heading.error);
    EXPECT_GE(covered.value, kLeastCoverage - 3.0 * covered.error);
    EXPECT_LE(covered.value, kGreatestCoverage + 3.0 * covered.error);
    EXPECT_EQ(count(learning, &Run::is_inconsistent), 0U);
  }
}

/// Verifies SR-INT-04.
TEST(LearningOnPeerSensorA, IsAsGoodAsKnowingItsNoise) {
  expect_as_good_as_knowing(kA);
}

/// Verifies SR-INT-04.
TEST(LearningOnPeerSensorB, IsAsGoodAsKnowingItsNoise) {
  expect_as_good_as_knowing(kB);
}

/// Runs of a sensor whose slow noise is no flicker, under the data sheets of sensor A. A walk is a
/// hypothesis of the grid, and all are near enough to be covered. A report that the model does not
/// hold is right as well.
void expect_honest(const char* name, const std::vector<simulate::Effect>& slow_noise) {
  const auto gyros = gyros_of(kA.arw_dps_rt_s, slow_noise, 60);
  for (const double factor : {1.0 / kWrong, 1.0, kWrong}) {
    const auto runs =
        play_all<kLearning>(slow_params<kLearning>(data_sheet(kA, 1.0, factor)), gyros);
    const Estimate covered = coverage(runs, {});
    const std::size_t reported = count(runs, &Run::is_inconsistent_early);
    std::printf(
        "%s, slow noise of the sheet times %.2f: coverage %.3f (%.3f), reported %zu of %zu\n", name,
        factor, covered.value, covered.error, reported, runs.size());
    EXPECT_GE(covered.value, 0.92 - 3.0 * covered.error);
  }
}

TEST(LearningOutsideTheFamily, IsHonestOfARandomWalk) {
  expect_honest("random walk", {simulate::RateRandomWalk{.rate_random_walk_rad_s_rt_s = kDph}});
}

TEST(LearningOutsideTheFamily, IsHonestOfAStrongRandomWalk) {
  expect_honest("strong random walk",
                {simulate::RateRandomWalk{.rate_random_walk_rad_s_rt_s = 10.0 * kDph}});
}

TEST(LearningOutsideTheFamily, IsHonestOfAStrongGaussMarkovProcess) {
  expect_honest("strong Gauss-Markov",
                {simulate::CorrelatedNoise{.sigma_rad_s = 100.0 * kDph, .time_constant_s = 300.0}});
}

TEST(LearningOutsideTheFamily, IsHonestOfWhiteNoiseAlone) {
  expect_honest("white noise", {simulate::ConstantBias{.bias_rad_s = 0.3 * kRadPerDeg}});
}

TEST(LearningOutsideTheFamily, IsHonestOfAGaussMarkovProcess) {
  expect_honest("Gauss-Markov",
                {simulate::CorrelatedNoise{.sigma_rad_s = 10.0 * kDph, .time_constant_s = 300.0}});
}

// The bias jumps there and back: nothing that a flicker does.
TEST(LearningOutsideTheFamily, IsReportedForABiasThatJumps) {
  std::vector<simulate::Effect> jumps;
  for (std::size_t cycle = 0; cycle < kCycles; ++cycle) {
    jumps.emplace_back(
        simulate::BiasJump{.height_rad_s = (cycle % 2 == 0 ? 0.2 : -0.2) * kRadPerDeg,
                           .time_s = 120.0 * static_cast<double>(cycle) + 30.0});
  }
  for (const double factor : {1.0 / kWrong, 1.0, kWrong}) {
    const auto runs = play_all<kLearning>(slow_params<kLearning>(data_sheet(kA, 1.0, factor)),
                                          gyros_of(kA.arw_dps_rt_s, jumps, 10));
    EXPECT_EQ(count(runs, &Run::is_inconsistent_early), runs.size());
  }
}

}  // namespace
}  // namespace zerorate::scenario
