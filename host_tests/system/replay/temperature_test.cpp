// The temperature block through the node: 25 -> 45 -> 30 deg C within 80 minutes at 0.03 deg/s/K, a
// minute of standstill and three of driving in turn (issue: the best peer drifts 2.17 deg a drive
// while the temperature is new, and 0.31 deg when it comes again).

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tests/support/made_recording.hpp"

namespace zerorate::evaluate {
namespace {

using testing::kRadPerDeg;
using testing::replay_file;
using testing::Replayed;
using testing::write_rows;
using zerorate::testing::ScratchFolder;

constexpr double kPeriod_s = 0.02;
constexpr double kEnd_s = 4800.0;
constexpr double kHottest_s = 2743.0;  // 20 K up, then 15 K down at the same pace
constexpr double kSlopeRadSK = 0.03 * kRadPerDeg;
constexpr double kArwRadRtS = 0.005 * kRadPerDeg;
constexpr double kBiasInstabilityRadS = 3.0 / 3600.0 * kRadPerDeg;
constexpr recording::Columns kOneRate{1, recording::RateUnit::rad_per_s, true, false, true};

double temperature_at(double t_s) {
  constexpr double kPace = 20.0 / kHottest_s;
  return t_s < kHottest_s ? 25.0 + kPace * t_s : 45.0 - kPace * (t_s - kHottest_s);
}

std::vector<recording::Row> rows_of_the_scenario(std::uint64_t seed) {
  const auto count = static_cast<std::size_t>(kEnd_s / kPeriod_s);
  simulate::Signal signal{count, kPeriod_s};
  for (std::size_t k = 0; k < count; ++k) {
    signal.temperature_degc.push_back(temperature_at(signal.time_s(k)));
  }
  const std::vector<simulate::Effect> effects{
      simulate::ConstantBias{.bias_rad_s = 0.3 * kRadPerDeg},
      simulate::WhiteNoise{.angle_random_walk_rad_rt_s = kArwRadRtS},
      simulate::FlickerNoise{.bias_instability_rad_s = kBiasInstabilityRadS},
      simulate::TemperatureDrift{.linear_rad_s_per_k = kSlopeRadSK}};
  const auto noisy = simulate::simulate(std::move(signal), effects, random::RandomStream{seed});
  const random::RandomStream thermometer{seed, 1};
  std::vector<recording::Row> rows(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double t_s = noisy.time_s(k);
    rows[k].time_ns = static_cast<std::int64_t>(k) * 20'000'000;
    rows[k].rate_rad_s[0] = static_cast<float>(noisy.rate_rad_s[k]);
    const double reading = noisy.temperature_degc[k] + 0.1 * thermometer.normal(std::int64_t(k));
    rows[k].temperature_degc = static_cast<float>(reading);
    rows[k].still = std::fmod(t_s, 240.0) < 60.0;
  }
  return rows;
}

/// The slope of this sensor is not known; that of its kind is, roughly.
model::SensorModel model_with_temperature() {
  return {
      .name = "made for a test",
      .white = {.angle_random_walk_rad_per_sqrt_s = kArwRadRtS},
      .flicker = model::Flicker{.bias_instability_rad_s = kBiasInstabilityRadS},
      .temperature = model::TemperatureDrift{.reference_degc = 35.0,
                                             .slope_sigma_rad_s_per_k = 0.03 * kRadPerDeg,
                                             .curvature_sigma_rad_s_per_k2 = 2e-4 * kRadPerDeg}};
}

/// The Kalman predictor's drives that end after `from_s` and no later than `to_s`.
struct Drives {
  double count = 0.0;
  double squares_deg2 = 0.0;
  double covered = 0.0;
  double normalised_squares = 0.0;

  [[nodiscard]] double rms_deg() const { return std::sqrt(squares_deg2 / count); }
};
Drives drives_between(const Replayed& replayed, double from_s, double to_s) {
  Drives drives;
  for (const ReplayedDrive& drive : replayed.drives) {
    const double start_s = static_cast<double>(drive.start_ns) * 1e-9;
    if (drive.predictor != app::Predictor::kalman || start_s < from_s || start_s >= to_s) continue;
    const DriveOutcome& outcome = drive.outcome;
    ++drives.count;
    drives.squares_deg2 += std::pow(outcome.drift_rad / kRadPerDeg, 2);
    drives.normalised_squares += std::pow(outcome.drift_rad / outcome.sigma_rad, 2);
    if (std::abs(outcome.drift_rad) <= 1.96 * outcome.sigma_rad) ++drives.covered;
  }
  return drives;
}

TEST(ReplayThroughAChangingTemperature, DriftsLittleAfterLearning) {
  const ScratchFolder folder;
  Drives unseen;
  Drives seen;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto path =
        write_rows(folder.path() / "scenario.csv", kOneRate, rows_of_the_scenario(seed));
    for (const Through through : {Through::source, Through::chip}) {
      if (through == Through::chip && seed > 1) continue;
      const Replayed replayed =
          replay_file(path, {.model = model_with_temperature(), .through = through});
      EXPECT_EQ(replayed.result.samples_without_temperature, 0U);
      const Drives heating = drives_between(replayed, 0.0, kHottest_s - 180.0);
      const Drives cooling = drives_between(replayed, kHottest_s + 180.0, kEnd_s);
      ASSERT_GE(heating.count, 10.0);
      ASSERT_GE(cooling.count, 7.0);
      EXPECT_LE(heating.rms_deg(), 1.5) << "seed " << seed;
      EXPECT_LE(cooling.rms_deg(), 0.25) << "seed " << seed;
      for (const auto& [sum, part] : {std::pair{&unseen, heating}, std::pair{&seen, cooling}}) {
        sum->count += part.count;
        sum->squares_deg2 += part.squares_deg2;
        sum->covered += part.covered;
        sum->normalised_squares += part.normalised_squares;
      }
    }
  }
  RecordProperty("unseen_deg_x1000", static_cast<int>(1000.0 * unseen.rms_deg()));
  RecordProperty("seen_deg_x1000", static_cast<int>(1000.0 * seen.rms_deg()));
  // About 90 drives, neighbours alike: the interval is honest within a fifth of its width. Besides,
  // the strength of the slow noise is learnt from some ten stops at a time, on three axes: its
  // logarithm is known to sqrt(2 / 30) = 0.26. Two standard deviations: exp(0.52) = 1.68.
  const double spread =
      (unseen.normalised_squares + seen.normalised_squares) / (unseen.count + seen.count);
  EXPECT_GE(spread, 0.8 * 0.8 / 1.68);
  EXPECT_LE(spread, 1.2 * 1.2 * 1.68);
  EXPECT_GE((unseen.covered + seen.covered) / (unseen.count + seen.count), 0.88);
}

TEST(ReplayThatLosesItsTemperature, SaysSoAndIsNoSurerThanItMayBe) {
  const ScratchFolder folder;
  auto rows = rows_of_the_scenario(5);
  constexpr double kLost_s = 2200.0;
  for (auto& row : rows) {
    if (static_cast<double>(row.time_ns) * 1e-9 > kLost_s) {
      row.temperature_degc = std::numeric_limits<float>::quiet_NaN();
    }
  }
  const auto path = write_rows(folder.path() / "lost.csv", kOneRate, rows);
  const Replayed replayed = replay_file(path, {.model = model_with_temperature()});
  const auto missed = static_cast<double>(replayed.result.samples_without_temperature);
  EXPECT_NEAR(missed * kPeriod_s, kEnd_s - kLost_s - 5.0, 1.0);
  const Drives before = drives_between(replayed, 500.0, kLost_s - 240.0);
  const Drives after = drives_between(replayed, kLost_s, kEnd_s);
  EXPECT_GT(after.rms_deg(), 3.0 * before.rms_deg());
  EXPECT_LE(after.normalised_squares / after.count, 1.5);
}

}  // namespace
}  // namespace zerorate::evaluate
