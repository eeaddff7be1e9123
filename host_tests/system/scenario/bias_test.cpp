// Biases that are large, that change, and that only seem to.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <vector>

#include "host_tests/system/scenario/play.hpp"

namespace zerorate::scenario {
namespace {

model::SensorModel gated() {
  model::SensorModel model = lsm6dso();
  model.gate = model::Gate{.threshold_sigma = 5.0, .longest_knock_s = 5.0};
  return model;
}

/// Mean of `figure(outcome)` of the Kalman predictor about z, over the drives that begin within a
/// span of time.
template <class Figure>
double mean_of_drives(const Played& played, double from_s, double to_s, Figure figure) {
  double sum = 0.0;
  double count = 0.0;
  for (const evaluate::ReplayedDrive& drive : played.drives) {
    const double start_s = static_cast<double>(drive.start_ns) * 1e-9;
    if (drive.axis != kYaw || drive.predictor != app::Predictor::kalman || start_s < from_s ||
        start_s >= to_s) {
      continue;
    }
    sum += figure(drive.outcome);
    ++count;
  }
  return sum / count;
}

/// Root mean square of the heading drift [deg].
double drift_deg(const Played& played, double from_s, double to_s) {
  return std::sqrt(mean_of_drives(played, from_s, to_s, [](const evaluate::DriveOutcome& outcome) {
    return std::pow(outcome.drift_rad / kDps, 2);
  }));
}

/// Mean logarithm of the normal density that was predicted for the drift, at the drift that came
/// [nats].
double log_score(const Played& played) {
  return mean_of_drives(played, 0.0, 1e9, [](const evaluate::DriveOutcome& outcome) {
    return -0.5 * std::pow(outcome.drift_rad / outcome.sigma_rad, 2) -
           std::log(outcome.sigma_rad * std::sqrt(2.0 * std::numbers::pi));
  });
}

double coverage(const Played& played) {
  return played.result.scores[kYaw][static_cast<std::size_t>(app::Predictor::kalman)].coverage95();
}

TEST(BiasOf12Dps, IsAccepted) {
  const Played played = play("bias-12dps");
  EXPECT_LT(played.worst_dps(29.0, 270.0), kWanderDps);
  EXPECT_EQ(played.result.samples_disagreeing, 0U);
  EXPECT_TRUE(played.messages.back().health.model_inconsistent);  // 5 deg/s by [zero_rate]
}

// Far beyond the prediction, it may be a turn as well; the stop is too short to decide it.
TEST(ThermalBias, IsDoubtedUntilStopsHaveSettledIt) {
  const Played played = play("thermal-bias", gated());
  for (const double time_s : {665.0, 680.0, 719.0}) EXPECT_TRUE(played.disagrees(time_s)) << time_s;
}

TEST(ColdStart, IsCoveredByAModelThatKnowsOfIt) {
  model::SensorModel model = lsm6dso();
  model.warm_up = model::WarmUp{.amplitude_sigma_rad_s = 0.05 * kDps, .time_constant_s = 600.0};
  std::vector<double> gains;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Played extended = play("cold-start", model, seed);
    const Played base = play("cold-start", lsm6dso(), seed);
    EXPECT_LT(drift_deg(extended, 0.0, 1e9), drift_deg(base, 0.0, 1e9)) << "seed " << seed;
    // Twenty drives at 95 %: five standard deviations.
    EXPECT_GT(coverage(extended), 0.95 - 5.0 * std::sqrt(0.95 * 0.05 / 20.0)) << "seed " << seed;
    gains.push_back(log_score(extended) - log_score(base));
  }
  // Both cover nearly all drives, so it is the log score that tells them apart. Drives of one
  // recording depend on each other, recordings do not: five standard errors of the mean over them.
  const auto count = static_cast<double>(gains.size());
  const double mean = std::accumulate(gains.begin(), gains.end(), 0.0) / count;
  double squares = 0.0;
  for (const double gain : gains) squares += std::pow(gain - mean, 2);
  const double standard_error = std::sqrt(squares / (count - 1.0) / count);
  RecordProperty("gain_millinats", static_cast<int>(1000.0 * mean));
  RecordProperty("standard_error_millinats", static_cast<int>(1000.0 * standard_error));
  EXPECT_GT(mean, 5.0 * standard_error);
}

TEST(Temperature, HarmsLittleOnceItWasSeen) {
  model::SensorModel model = lsm6dso();
  model.white.angle_random_walk_rad_per_sqrt_s = simulate::kTemperatureArwDpsRtS * kDps;
  model.flicker->bias_instability_rad_s =
      simulate::kTemperatureBiasInstabilityDph / 3600.0 * kDps / 0.664;
  model.temperature = model::TemperatureDrift{.reference_degc = 35.0,
                                              .slope_sigma_rad_s_per_k = 0.03 * kDps,
                                              .curvature_sigma_rad_s_per_k2 = 2e-4 * kDps};
  const Played played = play("temperature", model);
  EXPECT_LE(drift_deg(played, 0.0, 2563.0), 1.5);
  EXPECT_LE(drift_deg(played, 2923.0, 1e9), 0.25);
}

TEST(BiasJump, IsDoubtedThenLearntWithinTheStop) {
  const Played played = play("bias-jump", gated());
  EXPECT_FALSE(played.disagrees(179.0));
  EXPECT_TRUE(played.disagrees(182.0));
  EXPECT_FALSE(played.disagrees(303.0));  // 2 min without a pulse, and it is still there
  EXPECT_LT(played.worst_dps(315.0, 450.0), kWanderDps);
}

TEST(Knocks, AreNotLearnt) {
  for (const model::SensorModel& model : {lsm6dso(), gated()}) {
    const Played played = play("knocks", model);
    EXPECT_TRUE(played.disagrees(313.0));
    EXPECT_FALSE(played.disagrees(319.0));
    EXPECT_LT(played.worst_dps(60.0, 1'200.0), kWanderDps);
  }
}

}  // namespace
}  // namespace zerorate::scenario
