#include "host_tools/lib/identify/quasi_likelihood.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "host_tools/lib/identify/minimise.hpp"

namespace zerorate::identify {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTick = 0.5;

model::SensorModel model_of(double white, double flicker, double order) {
  model::SensorModel model{.name = "test"};
  model.white.angle_random_walk_rad_per_sqrt_s = white;
  model.flicker = model::Flicker{.bias_instability_rad_s = flicker, .order = order};
  return model;
}

/// Parameters log N, log B and d.
model::SensorModel model_at(const Eigen::VectorXd& theta) {
  return model_of(std::exp(theta(0)), std::exp(theta(1)), theta(2));
}

/// Density of the mean of a tick's samples by every alias and the sum of their delays.
double density_by_sums(const model::SensorModel& model, int samples, double f) {
  const double sample_s = kTick / samples;
  const double white = model.white.angle_random_walk_rad_per_sqrt_s;
  const double b = model.flicker->bias_instability_rad_s;
  double sum = 0.0;
  for (int alias = 0; alias < samples; ++alias) {
    const double g = (f + alias) / samples;
    std::complex<double> mean = 0.0;
    for (int i = 0; i < samples; ++i) mean += std::polar(1.0 / samples, -2.0 * kPi * g * i);
    const double fractional =
        std::pow(std::abs(1.0 - std::polar(1.0, -2.0 * kPi * g)), -2.0 * model.flicker->order);
    sum += std::norm(mean) *
           (white * white / sample_s +
            b * b * std::pow(sample_s, 2.0 * model.flicker->order - 1.0) * fractional);
  }
  return sum / samples;
}

TEST(NoiseDensity, IsThatOfTheMeanOfATicksSamples) {
  const model::SensorModel model = model_of(1e-4, 2e-4, 0.6);
  for (const int samples : {1, 2, 5, 10}) {
    for (const double f : {1e-3, 0.02, 0.1, 0.3, 0.5}) {
      const double expected = density_by_sums(model, samples, f);
      EXPECT_NEAR(noise_density(model, kTick, samples, f), expected, 1e-9 * expected)
          << samples << " samples, f " << f;
    }
  }
}

TEST(NoiseDensity, LeavesOutLittleOfManySamples) {
  const model::SensorModel model = model_of(1e-4, 2e-4, 0.5);
  for (const double f : {0.1, 0.5}) {
    const double expected = density_by_sums(model, 500, f);
    EXPECT_NEAR(noise_density(model, kTick, 500, f), expected, 2e-3 * expected) << f;
  }
}

TEST(FilterDensity, IsThatOfTheNoiseWithinTheRipple) {
  const model::SensorModel model = model_of(1e-9, 2e-4, 0.5);
  for (const double f : {1e-4, 1e-3, 0.02, 0.1, 0.3, 0.5}) {
    EXPECT_NEAR(filter_density(model, kTick, f) / noise_density(model, kTick, 1, f), 1.0, 0.07)
        << f;
  }
}

/// Where the expected likelihood of the filter is greatest, by a search along it over all Fourier
/// frequencies.
Eigen::VectorXd likeliest_of_filter(const model::SensorModel& truth, const TickSampling& sampling) {
  const auto minus_two_log = [&](const Eigen::VectorXd& theta) {
    double sum = 0.0;
    for (double j = 1.0; j <= 0.5 * sampling.ticks; j += 1.0) {
      const double f = j / sampling.ticks;
      const double filter = filter_density(model_at(theta), kTick, f);
      sum += std::log(filter) + noise_density(truth, kTick, sampling.samples, f) / filter;
    }
    return sum;
  };
  const Eigen::Vector3d start{std::log(truth.white.angle_random_walk_rad_per_sqrt_s),
                              std::log(truth.flicker->bias_instability_rad_s),
                              truth.flicker->order};
  const Eigen::MatrixXd steps = Eigen::Vector3d(0.003, 0.01, 0.005).asDiagonal();
  const Eigen::Vector3d room{1.0, 1.0, 0.3};
  return minimise(minus_two_log, start, steps, start - room, start + room).at;
}

TEST(NoiseOfAFilterFit, IsTheNoiseThatTheFilterTookForAnother) {
  // 1/f noise at the tick of a third of the white noise: N by the filter is 4 % too small.
  const TickSampling sampling{.tick_s = kTick, .samples = 10, .ticks = 4000.0};
  const model::SensorModel truth = model_of(7e-5, 5.8e-5, 0.5);
  const FittedParameters of_filter{likeliest_of_filter(truth, sampling),
                                   Eigen::Vector3d(4e-4, 4e-3, 1e-3).asDiagonal()};
  ASSERT_LT(std::exp(of_filter.at(0)), 0.97 * 7e-5);
  const FittedParameters noise =
      noise_of_filter_fit(model_at, of_filter, sampling, Eigen::Vector3d(0.08, 0.8, 0.4));
  // The sums go by eighths of an octave, the search ends at a thirtieth of a step.
  EXPECT_NEAR(std::exp(noise.at(0)) / 7e-5, 1.0, 0.003);
  EXPECT_NEAR(std::exp(noise.at(1)) / 5.8e-5, 1.0, 0.01);
  EXPECT_NEAR(noise.at(2), 0.5, 0.003);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::sqrt(noise.covariance(i, i) / of_filter.covariance(i, i)), 1.0, 0.15) << i;
  }
}

}  // namespace
}  // namespace zerorate::identify
