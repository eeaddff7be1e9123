/// @file
/// The information that sizes hidden effects, against dense covariances and exact likelihoods.

#include "host_tools/lib/simulate/sizing/base_loss.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "host_tools/lab/campaign/outside_catalogue.hpp"
#include "host_tools/lib/simulate/sizing/sized_effect.hpp"
#include "host_tools/lib/spectrum/fractional_filter.hpp"

namespace zerorate::sizing {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kSamples = 160;

/// The covariance of ARFIMA(0,d,0) that has been on for sixty records.
MatrixXd dense_fractional(double order) {
  constexpr int kHistory = 60 * kSamples;
  std::vector<double> psi;
  spectrum::FractionalWeights weights{order};
  for (int j = 0; j < kHistory + kSamples; ++j) psi.push_back(weights.next());
  MatrixXd response = MatrixXd::Zero(kSamples, kHistory + kSamples);
  for (int k = 0; k < kSamples; ++k) {
    for (int i = 0; i <= kHistory + k; ++i) {
      response(k, i) = psi[static_cast<std::size_t>(kHistory + k - i)];
    }
  }
  return response * response.transpose();
}

MatrixXd dense_walk() {
  MatrixXd covariance(kSamples, kSamples);
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) covariance(i, j) = std::min(i, j);
  }
  return covariance;
}

/// An orthonormal basis of what is orthogonal to the constant (Helmert), unlike the DCT's.
MatrixXd helmert() {
  MatrixXd basis = MatrixXd::Zero(kSamples - 1, kSamples);
  for (int row = 0; row < kSamples - 1; ++row) {
    const double n = row + 1.0;
    for (int column = 0; column <= row; ++column) basis(row, column) = 1.0 / std::sqrt(n * (n + 1));
    basis(row, row + 1) = -n / std::sqrt(n * (n + 1));
  }
  return basis;
}

/// A covariance without its constant.
MatrixXd without_constant(const MatrixXd& covariance) {
  const MatrixXd basis = helmert();
  return basis * covariance * basis.transpose();
}

/// Kullback-Leibler divergence of normal distributions.
double dense_divergence(const MatrixXd& t, const MatrixXd& model) {
  const Eigen::LLT<MatrixXd> m(model);
  const double log_ratio = 2.0 * m.matrixLLT().diagonal().array().log().sum() -
                           2.0 * Eigen::LLT<MatrixXd>(t).matrixLLT().diagonal().array().log().sum();
  return 0.5 * (m.solve(t).trace() - (kSamples - 1) + log_ratio);
}

/// The least divergence over the weights of white noise and some others, by halving steps along the
/// axes: nothing of spectra in it.
double least_dense_divergence(const MatrixXd& truth, const std::vector<MatrixXd>& others) {
  const auto at = [&](const std::vector<double>& log_weights) {
    MatrixXd model = std::exp(log_weights.back()) * MatrixXd::Identity(kSamples - 1, kSamples - 1);
    for (std::size_t i = 0; i < others.size(); ++i) model += std::exp(log_weights[i]) * others[i];
    return dense_divergence(truth, model);
  };
  std::vector<double> log_weights(others.size() + 1, 0.0);
  double least = at(log_weights);
  for (double step = 1.0; step > 0.05;) {
    const double before = least;
    for (double& log_weight : log_weights) {
      for (const double change : {step, -step}) {
        log_weight += change;
        const double trial = at(log_weights);
        if (trial < least) {
          least = trial;
        } else {
          log_weight -= change;
        }
      }
    }
    if (least == before) step *= 0.5;
  }
  return least;
}

TEST(BaseLoss, AgreesWithDenseCovariancesForNoiseOfAnotherSpectrum) {
  const double flicker_sigma = 0.3;
  const BaseNoise noise(kSamples, 1.0, flicker_sigma);
  const MatrixXd flicker = dense_fractional(0.5);
  for (const double step : {0.4, 2.0}) {
    const MatrixXd truth = MatrixXd::Identity(kSamples, kSamples) +
                           flicker_sigma * flicker_sigma * flicker + step * step * dense_walk();
    Spectrum spectrum = noise.spectrum();
    const Spectrum walk = fractional_spectrum(kSamples, 1.0);
    for (std::size_t k = 0; k < spectrum.size(); ++k) spectrum[k] += step * step * walk[k];
    const double dense =
        least_dense_divergence(without_constant(truth), {without_constant(flicker)});
    EXPECT_NEAR(noise.loss_to_spectrum(spectrum), dense, 0.1 * dense) << step;
  }
}

TEST(BaseLoss, AgreesWithDenseCovariancesBesideNoiseThatIsKnown) {
  const double flicker_sigma = 0.3;
  const double markov_sigma = 4.0;
  const double time_constant = 3.0;
  const double step = 1.0;
  MatrixXd markov(kSamples, kSamples);
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) markov(i, j) = std::exp(-std::abs(i - j) / time_constant);
  }
  const MatrixXd flicker = without_constant(dense_fractional(0.5));
  const MatrixXd walk = without_constant(dense_walk());
  markov = without_constant(markov);
  const MatrixXd truth = MatrixXd::Identity(kSamples - 1, kSamples - 1) +
                         flicker_sigma * flicker_sigma * flicker +
                         markov_sigma * markov_sigma * markov + step * step * walk;
  const BaseNoise alone(kSamples, 1.0, flicker_sigma);
  const BaseNoise with_walk = alone.with_noise(fractional_spectrum(kSamples, 1.0), step * step);
  const Spectrum markov_spectrum = gauss_markov_spectrum(kSamples, time_constant);
  const BaseNoise with_markov = alone.with_noise(markov_spectrum, markov_sigma * markov_sigma);
  const Spectrum spectrum =
      with_walk.with_noise(markov_spectrum, markov_sigma * markov_sigma).spectrum();
  const auto expect_loss = [&](const BaseNoise& noise, const MatrixXd& known) {
    const double dense = least_dense_divergence(truth, {flicker, known});
    EXPECT_NEAR(noise.loss_to_spectrum(spectrum), dense, 0.15 * dense);
    EXPECT_LT(noise.loss_to_spectrum(spectrum), 0.9 * alone.loss_to_spectrum(spectrum));
  };
  expect_loss(with_walk, walk);
  expect_loss(with_markov, markov);
}

TEST(BaseLoss, IsLessBesideAKnownMeanByWhatThatCanTake) {
  const BaseNoise alone(kSamples, 1.0, 1e-6);
  std::vector<double> ramp(kSamples);
  std::vector<double> jump(kSamples);
  for (int k = 0; k < kSamples; ++k) {
    ramp[static_cast<std::size_t>(k)] = 0.01 * k;
    jump[static_cast<std::size_t>(k)] = k < kSamples / 2 ? 0.0 : 1.0;
  }
  // A step in the middle and a straight line, both centred, have the correlation sqrt(3) / 2.
  const std::vector<double> left = beyond(alone.spectrum(), contrasts(jump), {contrasts(ramp)});
  EXPECT_NEAR(alone.squared_norm(left), 0.25 * alone.squared_norm(contrasts(jump)), 0.01);
  EXPECT_DOUBLE_EQ(alone.beside_mean(contrasts(ramp)).loss_to_mean(contrasts(jump)),
                   alone.loss_to_mean(left));
}

TEST(BaseLoss, CountsTheWhiteNoiseThatALowPassLeaves) {
  const double share = 0.4;
  const BaseNoise noise = BaseNoise(20'000, 2.0, 0.1).behind(low_pass_gain(20'000, share));
  // Variance of y += a (x - y): a / (2 - a).
  EXPECT_NEAR(noise.white_sigma(), 2.0 * std::sqrt(share / (2.0 - share)), 0.002);
}

TEST(BaseLoss, IsHalfTheSquaredNormOfAMeanInTheMetricOfTheNoise) {
  const double flicker_sigma = 0.3;
  const BaseNoise noise(kSamples, 1.0, flicker_sigma);
  const MatrixXd basis = helmert();
  const MatrixXd covariance = basis *
                              (MatrixXd::Identity(kSamples, kSamples) +
                               flicker_sigma * flicker_sigma * dense_fractional(0.5)) *
                              basis.transpose();
  for (const double cycles : {0.0, 0.5, 2.3, 20.0}) {
    VectorXd mean(kSamples);
    for (int k = 0; k < kSamples; ++k) {
      mean(k) = cycles == 0.0 ? 0.01 * k : std::sin(2.0 * std::numbers::pi * cycles * k / kSamples);
    }
    const VectorXd contrast = basis * mean;
    const double dense = contrast.dot(covariance.llt().solve(contrast));
    EXPECT_NEAR(noise.squared_norm(contrasts({mean.data(), kSamples})), dense, 0.08 * dense);
  }
}

TEST(BaseLoss, IsBelowHalfTheSquaredNormOfAMeanTakenForNoise) {
  const BaseNoise noise(20'000, 1.0, 0.1);
  std::vector<double> ramp(20'000);
  for (std::size_t k = 0; k < ramp.size(); ++k) ramp[k] = 1e-4 * static_cast<double>(k);
  const std::vector<double> contrast = contrasts(ramp);
  const double known = 0.5 * noise.squared_norm(contrast);
  EXPECT_LT(noise.loss_to_mean(contrast), 0.9 * known);
  EXPECT_LT(noise.loss_with_walk_to_mean(contrast), noise.loss_to_mean(contrast));
  EXPECT_GT(noise.loss_with_walk_to_mean(contrast), 0.0);
}

TEST(BaseLoss, IsZeroForTheBaseItself) {
  const BaseNoise noise(20'000, 1.0, 0.1);
  EXPECT_NEAR(noise.loss_to_spectrum(noise.spectrum()), 0.0, 1e-3);
}

TEST(LowCoefficientsOfFlickerNoise, HaveTheKnownCorrections) {
  const Spectrum flicker = fractional_spectrum(20'000, 0.5);
  const auto nominal = [](double k) {
    return 1.0 / (2.0 * std::sin(std::numbers::pi * k / 40'000));
  };
  EXPECT_NEAR(flicker[0] / nominal(1), 0.77, 0.01);
  EXPECT_NEAR(flicker[1] / nominal(2), 0.90, 0.01);
  EXPECT_NEAR(flicker[2] / nominal(3), 0.93, 0.01);
}

/// log p(y) of two levels in white noise of unit variance, all paths summed (forward recursion).
double log_likelihood_of_two_levels(const std::vector<double>& y, double height, double up,
                                    double down) {
  double low = down / (up + down);
  double high = 1.0 - low;
  double sum = 0.0;
  for (const double value : y) {
    const double at_low = low * std::exp(-0.5 * value * value);
    const double at_high = high * std::exp(-0.5 * (value - height) * (value - height));
    const double both = at_low + at_high;
    sum += std::log(both);
    low = (at_low * (1.0 - up) + at_high * down) / both;
    high = 1.0 - low;
  }
  return sum;
}

TEST(LossToTelegraphNoise, IsALowerBoundOfTheExactLoss) {
  constexpr std::size_t kLength = 4000;
  const random::RandomStream stream(7);
  RecordingSetting setting{.samples = kLength,
                           .period_s = 1.0,
                           .noise = BaseNoise(kLength, 1.0, 1e-6),
                           .temperature_degc = std::vector<double>(kLength, 25.0),
                           .stream = stream};
  Draws draws{stream.substream("effects")};
  const SizedEffect telegraph = draw_random_telegraph_noise(setting, draws);
  const double height = size_for(telegraph, 60.0).value();
  const std::vector<double> level = alone(setting, telegraph.at(height));
  double up = 0.0;
  double down = 0.0;
  double high_samples = 0.0;
  for (std::size_t k = 1; k < kLength; ++k) {
    up += level[k - 1] == 0.0 && level[k] != 0.0 ? 1.0 : 0.0;
    down += level[k - 1] != 0.0 && level[k] == 0.0 ? 1.0 : 0.0;
    high_samples += level[k] != 0.0 ? 1.0 : 0.0;
  }
  const double signed_height =
      *std::ranges::max_element(level, {}, [](double rate) { return std::abs(rate); });

  const std::vector<Spectrum> shapes{flat_spectrum(kLength), fractional_spectrum(kLength, 0.5)};
  constexpr int kRuns = 60;
  double sum = 0.0;
  double squares = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<double> y = level;
    stream.substream("noise").substream(static_cast<std::uint64_t>(run)).fill_normal(0, y);
    for (std::size_t k = 0; k < kLength; ++k) y[k] += level[k];
    std::vector<double> periodogram = contrasts(y);
    for (double& coefficient : periodogram) coefficient *= coefficient;
    const double base = -best_fit(periodogram, shapes, {1.0, 0.01}).cost_nats;
    const double gain = log_likelihood_of_two_levels(
                            y, signed_height, up / (kLength - high_samples), down / high_samples) -
                        base;
    sum += gain / kRuns;
    squares += gain * gain / kRuns;
  }
  const double standard_error = std::sqrt((squares - sum * sum) / kRuns);
  // The base is fitted to each record, which gains its two parameters one nat.
  EXPECT_GT(sum, 60.0 - 1.0 - 4.0 * standard_error);
  // The times of the switches are known to a few samples only: each has a few nats of them back.
  EXPECT_LT(sum, 60.0 + 5.0 * (up + down) + 4.0 * standard_error);
}

TEST(EveryEffect, IsSizedToTheNatsThatAreAskedFor) {
  const random::RandomStream stream(11);
  const RecordingSetting setting = draw_setting(20'000, 0.0, stream);
  Draws draws{stream.substream("effects")};
  for (const auto entries : {catalogue(), campaign::outside_catalogue()}) {
    for (const EffectEntry& entry : entries) {
      const SizedEffect effect = entry.draw(setting, draws);
      const auto size = size_for(effect, 40.0);
      ASSERT_TRUE(size) << entry.name;
      EXPECT_EQ(effect.name, entry.name);
      // A loss counted over the record's own path is a little rough.
      EXPECT_NEAR(effect.loss_nats(*size), 40.0, 2.0) << entry.name;
      EXPECT_GT(effect.loss_nats(1.5 * *size), 41.0) << entry.name;
    }
  }
}

EffectEntry entry_of(std::string_view name) {
  return *std::ranges::find(catalogue(), name, &EffectEntry::name);
}

TEST(EffectsOfAPair, CostTheNatsThatAreAskedForBesideEachOther) {
  const random::RandomStream stream(12);
  const RecordingSetting setting = draw_setting(20'000, 0.0, stream);
  Draws draws{stream.substream("effects")};
  const std::vector<EffectEntry> entries{entry_of("correlated_noise"), entry_of("bias_jump")};
  constexpr double kNats = 30.0;

  const auto pair = size_together(entries, setting, kNats, draws);

  ASSERT_TRUE(pair);
  const HiddenEffect& markov = pair->at(0);
  const HiddenEffect& jump = pair->at(1);
  const double sigma = markov.figures.at("sigma_dps") / kDegPerRad;
  const Spectrum shape = gauss_markov_spectrum(
      setting.noise.samples(), markov.figures.at("time_constant_s") / setting.period_s);
  const std::vector<double> mean = contrasts(alone(setting, jump.part));
  const BaseNoise known = setting.noise.with_noise(shape, sigma * sigma);
  // Those who know the jump lose this much of the process, and the other way round. Neighbours of
  // the time constant, which is not known to them, take a little more of the jump.
  EXPECT_NEAR(setting.noise.loss_to_spectrum(known.spectrum()), kNats, 1.0);
  EXPECT_GE(known.loss_to_mean(mean), kNats - 1.0);
  EXPECT_LT(known.loss_to_mean(mean), kNats + 3.0);
  EXPECT_GT(setting.noise.loss_to_mean(mean), kNats + 5.0) << "alone it would be plainer to see";
}

TEST(EffectsOfAPair, KeepTheirSizesWhereNeitherHidesTheOther) {
  const random::RandomStream stream(13);
  const RecordingSetting setting = draw_setting(20'000, 0.0, stream);
  const Draws draws{stream.substream("effects")};
  const std::vector<EffectEntry> entries{entry_of("rate_ramp"), entry_of("dropped_samples")};
  Draws of_pair = draws;
  Draws of_each = draws;

  const auto pair = size_together(entries, setting, 30.0, of_pair);

  ASSERT_TRUE(pair);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const SizedEffect effect = entries[i].draw(setting, of_each);
    EXPECT_NEAR(pair->at(i).size, size_for(effect, 30.0).value(), 1e-3 * pair->at(i).size);
  }
}

}  // namespace
}  // namespace zerorate::sizing
