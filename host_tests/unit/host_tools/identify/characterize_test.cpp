#include "host_tools/lib/identify/characterize.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "firmware/model/model_file.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tests/support/simulated_rest.hpp"
#include "host_tools/lib/identify/characterization_report.hpp"
#include "host_tools/lib/identify/density.hpp"

namespace zerorate::identify {
namespace {

using core::Duration;
using zerorate::testing::kRadPerDeg;
using zerorate::testing::rest_samples_of;
using zerorate::testing::simulate_rest;

Characterization characterize_simulated(const zerorate::testing::RestNoise& noise,
                                        std::size_t samples) {
  return characterize(rest_samples_of(simulate_rest(noise, samples, 0.1, 1)),
                      {.recording = "simulated.csv", .axes = {0}});
}

TEST(IdentificationTick, IsTheNodesExceptAtExtremeLengths) {
  const Duration period = Duration::milliseconds(10);
  EXPECT_EQ(identification_tick(Duration::seconds(10'000), period), Duration::milliseconds(500));
  // 100 s: 200 ticks of 0.5 s, 800 of 0.125 s, 1600 of 0.0625 s.
  EXPECT_EQ(identification_tick(Duration::seconds(100), period), Duration::microseconds(62'500));
  // 33 h: 237,600 ticks of 0.5 s, 59,400 of 2 s.
  EXPECT_EQ(identification_tick(Duration::seconds(118'800), period), Duration::seconds(2));
}

TEST(IdentificationTick, IsNeverShorterThanTheSamplePeriod) {
  EXPECT_EQ(identification_tick(Duration::seconds(100), Duration::seconds(2)),
            Duration::seconds(2));
  EXPECT_EQ(identification_tick(Duration::seconds(100), Duration::milliseconds(300)),
            Duration::milliseconds(500));
}

TEST(ModelAllanDeviation, OfWhiteNoiseFallsWithTheRootOfTau) {
  model::SensorModel model;
  model.white.angle_random_walk_rad_per_sqrt_s = 1e-3;
  EXPECT_DOUBLE_EQ(model_allan_deviation(model, 4.0), 5e-4);
}

TEST(ModelAllanDeviation, OfOneOverFNoiseIsFlatAtTheFloorOfIeee952) {
  model::SensorModel model;
  model.flicker = model::Flicker{.bias_instability_rad_s = 1e-5};
  const double floor = std::sqrt(2.0 * std::numbers::ln2 / std::numbers::pi) * 1e-5;
  // Between the quickest decade, 0.5 s, and the slowest, 50,000 s: the ripple of one pole a decade.
  for (const double tau_s : {10.0, 37.0, 100.0, 290.0, 1000.0}) {
    EXPECT_NEAR(model_allan_deviation(model, tau_s), floor, 0.03 * floor) << tau_s;
  }
}

TEST(CornerFrequency, IsWhereBothDensitiesAreEqual) {
  model::SensorModel model;
  model.white.angle_random_walk_rad_per_sqrt_s = 7e-4;
  model.flicker = model::Flicker{.bias_instability_rad_s = 1e-4, .order = 0.7};
  EXPECT_NEAR(model_density(model, corner_frequency_hz(model)), 2.0 * 7e-4 * 7e-4, 1e-15);
}

TEST(Characterization, GivesAModelThatAFileHoldsAndTheNodeRuns) {
  const Characterization result = characterize_simulated({}, 50'000);
  const model::SensorModel& model = result.axes.front().model;
  ASSERT_TRUE(model.flicker.has_value());
  EXPECT_NE(model.flicker->source.find("identified from simulated.csv"), std::string::npos);
  EXPECT_EQ(model::parse_model(model::format_model(model), "test"), model);
}

TEST(Characterization, OfEqualNoiseDoesNotDependOnTheAxis) {
  RestSamples samples = rest_samples_of(simulate_rest({}, 20'000, 0.1, 2));
  samples.axis_count = 3;
  for (auto& rate : samples.rate_rad_s) rate = {rate[0], rate[0], 4.0F * rate[0]};
  const Characterization result =
      characterize(samples, {.recording = "three", .axes = {0, 1, 2}, .order = 0.5});
  const auto arw = [&](std::size_t i) {
    return result.axes[i].fit.angle_random_walk_rad_per_sqrt_s.value;
  };
  EXPECT_EQ(arw(0), arw(1));
  EXPECT_NEAR(arw(2), 4.0 * arw(0), 1e-3 * arw(2));
  EXPECT_EQ(result.axes[2].axis, "z");
  EXPECT_NE(middle_axis(result).axis, "z");
}

// In the first stop of this recording, 80 samples and as long as any, all noise looks like flicker
// noise: a fit that began there ended without finding any in the whole.
TEST(CharacterizationOfStops, IsNotLedAstrayByAnOddStop) {
  constexpr std::uint64_t kOddRun = 1069;
  simulate::Signal signal = simulate_rest({.bias_instability_dph = 60.0}, 30'000, 0.5, kOddRun);
  zerorate::testing::drop_drives(signal, 80);
  const Characterization result =
      characterize(rest_samples_of(signal), {.recording = "stops", .axes = {0}, .order = 0.5});
  const InnovationsFit& fit = result.axes.front().fit;
  ASSERT_TRUE(fit.flicker.has_value());
  EXPECT_NEAR(fit.angle_random_walk_rad_per_sqrt_s.value, 0.04 * zerorate::testing::kRadPerDeg,
              4.0 * fit.angle_random_walk_rad_per_sqrt_s.standard_error);
}

TEST(CharacterizationOfStops, TakesItsCurvesFromTheLongestOne) {
  simulate::Signal signal = simulate_rest({}, 30'000, 0.1, 3);
  zerorate::testing::drop_drives(signal, 2'000);
  const Characterization result =
      characterize(rest_samples_of(signal), {.recording = "stops", .axes = {0}, .order = 0.5});
  ASSERT_FALSE(result.axes.front().allan.empty());
  EXPECT_NEAR(result.axes.front().allan.front().tau_s, 0.1, 1e-9);
  EXPECT_LT(result.axes.front().allan.back().tau_s, 100.0);
  EXPECT_NEAR(result.rest_s, 1000.0, 5.0);
}

// Rest in pieces of 0.3 s, of which each touches one or two ticks of half a second.
TEST(CharacterizationOfStops, CountsNoMoreRestThanThereWas) {
  simulate::Signal signal = simulate_rest({}, 30'000, 0.02, 4);
  zerorate::testing::drop_drives(signal, 15);
  RestSamples samples = rest_samples_of(signal);
  for (std::size_t k = 1; k < samples.time.size(); ++k) {
    if (samples.time[k] - samples.time[k - 1] > samples.sample_period * 2) {
      samples.after_drives.push_back(k);
    }
  }
  const Characterization result =
      characterize(samples, {.recording = "pieces", .axes = {0}, .order = 0.5});
  EXPECT_NEAR(result.rest_s, 200.1, 1e-6);  // 667 pieces
}

TEST(NoiseOfRest, IsRefusedWhereNothingIsKnown) {
  Characterization result{.rest_s = 355.0};
  result.axes.push_back({.axis = "z"});
  auto& white = result.axes.front().fit.angle_random_walk_rad_per_sqrt_s;
  white = {.value = 1e-5, .standard_error = 1e-6, .lo = 0.8e-5, .hi = 1.2e-5};
  EXPECT_NO_THROW(require_noise_of_rest(result));
  white.lo = 1e-29;
  EXPECT_THROW(require_noise_of_rest(result), recording::DataError);
}

/// Whether an estimate lies within four of its standard errors of the truth, on the scale of its
/// logarithm: one in 16,000 recordings does not.
bool is_near(const IntervalEstimate& estimate, double truth) {
  const double error = estimate.standard_error / estimate.value;
  return std::abs(std::log(estimate.value / truth)) < 4.0 * error && error < 0.5;
}

constexpr double kDph = kRadPerDeg / 3600.0;

TEST(NoiseCoefficients, OfARandomWalkAreNAndK) {
  const auto noise = characterize_simulated(
      {.bias_instability_dph = 0.0, .rate_random_walk_dph_per_sqrt_h = 600.0}, 100'000);
  const NoiseCoefficients& found = noise.axes.front().coefficients;
  EXPECT_TRUE(is_near(found.angle_random_walk_rad_per_sqrt_s, 0.04 * kRadPerDeg));
  EXPECT_FALSE(found.bias_instability_rad_s.has_value());
  ASSERT_TRUE(found.rate_random_walk_rad_s_per_sqrt_s.has_value());
  EXPECT_TRUE(is_near(*found.rate_random_walk_rad_s_per_sqrt_s, 600.0 * kDph / 60.0));
}

TEST(NoiseCoefficients, OfFlickerNoiseAreNAndB) {
  const auto noise = characterize_simulated({.bias_instability_dph = 60.0}, 100'000);
  const NoiseCoefficients& found = noise.axes.front().coefficients;
  ASSERT_TRUE(found.bias_instability_rad_s.has_value());
  EXPECT_TRUE(is_near(*found.bias_instability_rad_s, 60.0 * kDph));
  EXPECT_FALSE(found.rate_random_walk_rad_s_per_sqrt_s.has_value());
  ASSERT_TRUE(found.without_flicker.has_value());
}

TEST(NoiseCoefficients, OfBothAreAllThree) {
  const auto noise = characterize_simulated({.angle_random_walk_dps_per_sqrt_hz = 0.02,
                                             .bias_instability_dph = 40.0,
                                             .rate_random_walk_dph_per_sqrt_h = 200.0},
                                            200'000);
  const NoiseCoefficients& found = noise.axes.front().coefficients;
  // The quickest flicker noise within a tick counts as white: N is off by more than its error.
  EXPECT_NEAR(found.angle_random_walk_rad_per_sqrt_s.value, 0.02 * kRadPerDeg,
              0.03 * 0.02 * kRadPerDeg);
  ASSERT_TRUE(found.bias_instability_rad_s && found.rate_random_walk_rad_s_per_sqrt_s);
  EXPECT_TRUE(is_near(*found.bias_instability_rad_s, 40.0 * kDph));
  EXPECT_TRUE(is_near(*found.rate_random_walk_rad_s_per_sqrt_s, 200.0 * kDph / 60.0));
}

TEST(NoiseCoefficients, OfWhiteNoiseAreNAlone) {
  const auto noise = characterize_simulated({.bias_instability_dph = 0.0}, 20'000);
  const NoiseCoefficients& found = noise.axes.front().coefficients;
  EXPECT_FALSE(found.bias_instability_rad_s || found.rate_random_walk_rad_s_per_sqrt_s);
}

TEST(AllanFloor, IsNoDipOfTheLongAveragingTimes) {
  AxisCharacterization axis;
  axis.allan = {{.tau_s = 1.0, .adev = 3.0, .lo = 2.9, .hi = 3.1},
                {.tau_s = 80.0, .adev = 2.0, .lo = 1.8, .hi = 2.3},
                {.tau_s = 3000.0, .adev = 1.5, .lo = 0.9, .hi = 5.0}};
  EXPECT_EQ(axis.allan_floor().tau_s, 80.0);
}

TEST(AllanCsv, HasALineForEachAxisAndAveragingTime) {
  const auto noise = characterize_simulated({}, 20'000);
  const std::string csv = allan_csv(noise);
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "axis,tau_s,adev_dps,lo95_dps,hi95_dps");
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(csv, '\n')),
            noise.axes.front().allan.size() + 1);
}

TEST(CharacterizationJson, HoldsFiguresWithIntervals) {
  const auto json = nlohmann::json::parse(to_json(characterize_simulated({}, 50'000)));
  EXPECT_EQ(json["schema"], "zerorate.characterization/1");
  const auto& axis = json["axes"]["rate"];
  const auto& arw = axis["angle_random_walk_dps_per_sqrt_hz"];
  EXPECT_NEAR(arw["value"].get<double>(), 0.04, 0.002);
  EXPECT_LT(arw["lo95"], arw["value"]);
  EXPECT_NEAR(axis["angle_random_walk_deg_per_sqrt_h"]["value"].get<double>(),
              60.0 * arw["value"].get<double>(), 1e-9);
  EXPECT_TRUE(axis["flicker"]["order"]["source"].is_string());
  EXPECT_FALSE(axis["allan_deviation"].empty());
  EXPECT_FALSE(axis["density"].empty());
}

TEST(CharacterizationJson, HasNullForFlickerNoiseThatIsNotThere) {
  const auto json =
      nlohmann::json::parse(to_json(characterize_simulated({.bias_instability_dph = 0.0}, 20'000)));
  EXPECT_TRUE(json["axes"]["rate"]["flicker"].is_null());
  EXPECT_TRUE(json["axes"]["rate"]["local_whittle_order"].is_null());
  EXPECT_FALSE(json["axes"]["rate"]["remarks"].empty());
}

TEST(CharacterizationReport, ShowsEveryAxisAndItsModel) {
  const std::string html = make_report(characterize_simulated({}, 20'000), "test").html();
  EXPECT_NE(html.find("Allan deviation of axis rate"), std::string::npos);
  EXPECT_NE(html.find("zerorate.model/2"), std::string::npos);
}

TEST(CharacterizationOfARealSensor, AgreesWithItsDescription) {
  const auto folder = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
  if (!folder) GTEST_SKIP() << "skipped: no recordings";
  recording::Reader reader{*folder / "adis16405_static/run2_10hz_mean.csv.gz"};
  const Characterization result =
      characterize(read_rest_samples(reader), {.recording = "run2", .axes = {0, 1, 2}});
  for (const auto& axis : result.axes) {
    // The README of the recordings: one-sided 0.054 to 0.066 deg/s/sqrt(Hz), Allan floor 0.007 to
    // 0.009 deg/s at 60 to 300 s (and somewhat earlier on x), PSD slope -0.75 to -1.17 at low
    // frequencies, which is twice d, and some more since the slope is flattened by white noise.
    const double one_sided =
        axis.fit.angle_random_walk_rad_per_sqrt_s.value * std::sqrt(2.0) / kRadPerDeg;
    EXPECT_GT(one_sided, 0.05) << axis.axis;
    EXPECT_LT(one_sided, 0.068) << axis.axis;
    EXPECT_GT(axis.allan_floor().adev / kRadPerDeg, 0.006) << axis.axis;
    EXPECT_LT(axis.allan_floor().adev / kRadPerDeg, 0.011) << axis.axis;
    ASSERT_TRUE(axis.fit.flicker.has_value()) << axis.axis;
    EXPECT_GT(axis.fit.flicker->order.hi, 0.5) << axis.axis;
    EXPECT_LT(axis.fit.flicker->order.lo, 0.7) << axis.axis;
    // Two estimators that share nothing but the data.
    ASSERT_TRUE(axis.local_whittle_order.has_value()) << axis.axis;
    EXPECT_NEAR(axis.local_whittle_order->value, axis.fit.flicker->order.value, 0.25) << axis.axis;
  }
}

}  // namespace
}  // namespace zerorate::identify
