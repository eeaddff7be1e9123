#include "host_tools/lib/identify/filter_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <sstream>
#include <string>
#include <string_view>

#include "host_tests/support/simulated_rest.hpp"
#include "host_tools/lib/identify/characterization_report.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

using units::kRadSPerDph;
using zerorate::testing::kRadPerDeg;
using zerorate::testing::rest_samples_of;
using zerorate::testing::simulate_rest;

Characterization characterize_made(const zerorate::testing::RestNoise& noise, std::size_t samples) {
  return characterize(rest_samples_of(simulate_rest(noise, samples, 0.1, 1)),
                      {.recording = "simulated.csv", .axes = {0}});
}

/// The number that follows a text; not a number where the text is missing.
double number_after(std::string_view file, std::string_view text) {
  const auto at = file.find(text);
  return at == std::string_view::npos ? std::nan("")
                                      : std::stod(std::string(file.substr(at + text.size())));
}

/// Six digits are written.
constexpr double kWritten = 1e-5;

const FilterNoise& made_noise() {
  static const FilterNoise noise{.recording = "made.csv",
                                 .axes = 3,
                                 .white_rad_per_sqrt_s = 4.8869e-5,
                                 .walk_rad_s_per_sqrt_s = 1.6163e-6,
                                 .sample_rate_hz = 104.17};
  return noise;
}

void expect_noise(double white, double walk) {
  EXPECT_NEAR(white / made_noise().white_rad_per_sqrt_s, 1.0, kWritten);
  EXPECT_NEAR(walk / *made_noise().walk_rad_s_per_sqrt_s, 1.0, kWritten);
}

TEST(FilterNoise, IsTheFitWithoutFlickerNoise) {
  const Characterization result = characterize_made({.bias_instability_dph = 60.0}, 100'000);
  const auto& pair = result.axes.front().coefficients.without_flicker;
  ASSERT_TRUE(pair.has_value());
  const FilterNoise noise = FilterNoise::of(result);
  EXPECT_DOUBLE_EQ(noise.white_rad_per_sqrt_s, pair->angle_random_walk_rad_per_sqrt_s.value);
  EXPECT_DOUBLE_EQ(noise.walk_rad_s_per_sqrt_s.value(),
                   pair->rate_random_walk_rad_s_per_sqrt_s.value);
}

TEST(FilterNoise, OfAWalkIsThatOfTheSimulation) {
  const FilterNoise noise = FilterNoise::of(characterize_made(
      {.bias_instability_dph = 0.0, .rate_random_walk_dph_per_sqrt_h = 600.0}, 100'000));
  EXPECT_NEAR(noise.white_rad_per_sqrt_s, 0.04 * kRadPerDeg, 0.02 * 0.04 * kRadPerDeg);
  EXPECT_NEAR(noise.walk_rad_s_per_sqrt_s.value(), 10.0 * kRadSPerDph, 2.0 * kRadSPerDph);
  EXPECT_DOUBLE_EQ(noise.sample_rate_hz, 10.0);
}

TEST(FilterNoise, OfWhiteNoiseLeavesTheWalkInAComment) {
  const FilterNoise noise =
      FilterNoise::of(characterize_made({.bias_instability_dph = 0.0}, 20'000));
  EXPECT_FALSE(noise.walk_rad_s_per_sqrt_s.has_value());
  EXPECT_NE(kalibr_yaml(noise).find("\n# gyroscope_random_walk: not detectable"),
            std::string::npos);
  EXPECT_NE(gtsam_python(noise).find("\n    # setBiasOmegaCovariance: not detectable"),
            std::string::npos);
  EXPECT_NE(matlab_function(noise).find("\n% gyro.RandomWalk = not detectable"), std::string::npos);
}

TEST(KalibrYaml, HoldsBothDensities) {
  const std::string file = kalibr_yaml(made_noise());
  expect_noise(number_after(file, "\ngyroscope_noise_density: "),
               number_after(file, "\ngyroscope_random_walk: "));
  EXPECT_NEAR(number_after(file, "\nupdate_rate: "), 104.17, 1e-3);
}

/// N and K as programs read them that know the curve alone, allan_variance_ros among them: off
/// straight lines of the slopes -1/2 and 1/2, at 1 s and 3 s.
TEST(AllanCsv, GivesTheNoiseOfTheFileByItsStraightLines) {
  const Characterization result = characterize_made(
      {.bias_instability_dph = 0.0, .rate_random_walk_dph_per_sqrt_h = 600.0}, 100'000);
  const FilterNoise noise = FilterNoise::of(result);
  std::istringstream csv{allan_csv(result)};
  std::string line;
  std::getline(csv, line);
  double white = std::nan("");
  double walk = std::nan("");
  // The lines cross at 25 s: a tenth and ten times of that are one slope within half a per cent.
  while (std::getline(csv, line)) {
    double tau_s = 0.0;
    double adev_dps = 0.0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%*[^,],%lf,%lf", &tau_s, &adev_dps), 2) << line;
    if (tau_s <= 2.5) white = adev_dps * kRadPerDeg * std::sqrt(tau_s);
    if (tau_s <= 250.0) walk = adev_dps * kRadPerDeg * std::sqrt(3.0 / tau_s);
  }
  // Four standard errors of some 4,000 and 40 independent differences.
  EXPECT_NEAR(white / noise.white_rad_per_sqrt_s, 1.0, 4.0 / std::sqrt(2.0 * 4000.0));
  EXPECT_NEAR(walk / noise.walk_rad_s_per_sqrt_s.value(), 1.0, 4.0 / std::sqrt(2.0 * 40.0));
}

TEST(GtsamPython, HoldsTheSquaresOfBothDensities) {
  const std::string file = gtsam_python(made_noise());
  expect_noise(std::sqrt(number_after(file, "setGyroscopeCovariance(")),
               std::sqrt(number_after(file, "setBiasOmegaCovariance(")));
}

TEST(MatlabFunction, DrawsTheSamplesAndStepsOfTheNoise) {
  const std::string file = matlab_function(made_noise());
  // Deviations of a sample and of a step by imuSensor, and those of the noise.
  const double rate_hz = number_after(file, "'SampleRate', ");
  const double sample = number_after(file, "NoiseDensity = ") * std::sqrt(rate_hz / 2.0);
  const double step = number_after(file, "RandomWalk = ") / std::sqrt(rate_hz / 2.0);
  expect_noise(sample / std::sqrt(rate_hz), step * std::sqrt(rate_hz));
}

TEST(RobotLocalizationYaml, HoldsTheVarianceOfASample) {
  const std::string file = robot_localization_yaml(made_noise());
  const double variance = number_after(file, "\nangular_velocity_covariance: [");
  EXPECT_NEAR(std::sqrt(variance / made_noise().sample_rate_hz) / made_noise().white_rad_per_sqrt_s,
              1.0, kWritten);
}

}  // namespace
}  // namespace zerorate::identify
