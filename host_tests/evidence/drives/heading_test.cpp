// The turn since departure of sensors whose scale factor is drawn from the stated tolerance: does
// its interval hold, and is it as narrow as the bias allows where nothing is turned?

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "host_tests/evidence/drives/turning_vehicle.hpp"

namespace zerorate::drives {
namespace {

using Node = TurningNode;

constexpr std::size_t kDrives = 4;
constexpr std::size_t kSamples = samples_of(kDrives);

struct Ending {
  double error_deg;
  double sigma_deg;
  double predicted_sigma_deg;  ///< bias alone, by predict_heading() of the same node
};

/// Turns at the ends of the drives of one sensor.
std::vector<Ending> run(double tolerance, double scale_error, bool turns, std::uint64_t seed) {
  const Node::Params params = turning_params(tolerance);
  Node node{params};
  const random::RandomStream stream{seed, 0};
  const std::vector<double> noise = rest_noise_rad_s(kSamples, kPeriod_s, stream);
  std::vector<double> rate_dps(kSamples, 0.0);
  if (turns) rate_dps = corners_dps(kSamples, random::RandomStream{seed, 1});
  std::vector<Ending> endings;
  double true_turn_deg = 0.0;
  core::Instant departure;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const core::Instant at = time_of(k);
    if (is_driving(k)) node.pulse(at);
    core::GyroSample sample{.time = at};
    sample.rate[0] = core::rad_per_s(
        static_cast<float>(noise[k] + (1.0 + scale_error) * rate_dps[k] * kRadPerDeg));
    const app::RateMessage message = node.step(sample);
    true_turn_deg += rate_dps[k] * kPeriod_s;
    if (k + 1 == kSamples || is_driving(k + 1) == is_driving(k)) continue;
    if (is_driving(k)) {
      const auto heading = node.predict_heading(app::Predictor::kalman, 0, departure, at);
      endings.push_back({double{message.turn[0].angle.in(core::deg)} - true_turn_deg,
                         double{message.turn[0].sigma.in(core::deg)},
                         double{heading.sigma_rad()} / kRadPerDeg});
    } else {
      true_turn_deg = 0.0;
      departure = at;
    }
  }
  return endings;
}

struct Row {
  double coverage;
  double rms_deg;
  double mean_sigma_deg;
};
constexpr std::size_t kSensors = 150;

/// 150 sensors with four drives each.
Row row(double tolerance) {
  std::size_t inside = 0;
  double squares = 0.0;
  double sigma = 0.0;
  for (std::size_t sensor = 0; sensor < kSensors; ++sensor) {
    const random::RandomStream draw{7, sensor};
    for (const Ending& end : run(tolerance, tolerance * draw.normal(0), true, 1000 + sensor)) {
      inside += std::abs(end.error_deg) < 1.96 * end.sigma_deg ? 1U : 0U;
      squares += end.error_deg * end.error_deg;
      sigma += end.sigma_deg;
    }
  }
  const double count = static_cast<double>(kSensors * kDrives);
  return {static_cast<double>(inside) / count, std::sqrt(squares / count), sigma / count};
}

class Tolerance : public ::testing::TestWithParam<double> {};

// The drives of a sensor share its scale factor: between 150 and 600 independent drives, a standard
// error of 0.009 to 0.018; the bars are those of 0.93 and 0.99 by two of the larger.
TEST_P(Tolerance, IsWhatTheIntervalContains) {
  const Row found = row(GetParam());
  RecordProperty("coverage", std::to_string(found.coverage));
  EXPECT_GE(found.coverage, 0.93 - 0.036) << found.rms_deg << " " << found.mean_sigma_deg;
  EXPECT_LE(found.coverage, 0.999) << found.rms_deg << " " << found.mean_sigma_deg;
  std::printf("tolerance %.3f: coverage %.3f, rms %.3f deg, mean sigma %.3f deg\n", GetParam(),
              found.coverage, found.rms_deg, found.mean_sigma_deg);
}
INSTANTIATE_TEST_SUITE_P(Of, Tolerance, ::testing::Values(0.0, 0.005, 0.01, 0.03));

TEST(StraightDrives, HaveTheIntervalThatThePredictionHad) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const Ending& end : run(0.01, 0.0, false, seed)) {
      // The white noise of the samples adds, and up to 3 s before the departure. Between two
      // answers of the filter the standard deviation grows by its upper bound.
      const double white_deg = 0.00269 * std::sqrt(103.0);
      const double narrowest_deg = std::hypot(end.predicted_sigma_deg, white_deg);
      EXPECT_GE(end.sigma_deg, 0.97 * narrowest_deg);
      EXPECT_LE(end.sigma_deg, 1.08 * narrowest_deg);
    }
  }
}

}  // namespace
}  // namespace zerorate::drives
