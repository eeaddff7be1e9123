// Samples that were cut toward zero, half a step away from it again.

#include "core/samples/truncation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/samples/rounding_watch.hpp"

namespace zerorate::core {
namespace {

/// Rate that a chip cuts to whole steps of 1 rad/s, and the node undoes.
double read_and_undone(double rate) {
  constexpr Truncation kTruncation{.half_step_rad_s = 0.5F};
  const auto cut = static_cast<float>(std::trunc(rate));
  return double{kTruncation.undone(rad_per_s(cut)).in(rad_per_s)};
}

TEST(Truncation, IsUndoneAwayFromZeroOnAllAxes) {
  constexpr Truncation kTruncation{.half_step_rad_s = 0.5F};
  const Truncation::Rates cut{rad_per_s(3.0F), rad_per_s(-1.0F), rad_per_s(0.0F)};
  const Truncation::Rates undone{rad_per_s(3.5F), rad_per_s(-1.5F), rad_per_s(0.0F)};
  EXPECT_EQ(kTruncation.undone(cut), undone);
}
TEST(TruncationThatIsOff, KeepsTheRates) {
  const Truncation::Rates rates{rad_per_s(3.0F), rad_per_s(-1e-30F), rad_per_s(0.0F)};
  EXPECT_EQ(Truncation{}.undone(rates), rates);
}
TEST(TruncationUndone, LeavesNoErrorToRatesThatCrossManySteps) {
  double error = 0.0;
  constexpr int kRates = 2000;
  for (int k = 0; k < kRates; ++k) {
    const double rate = 40.0 * (static_cast<double>(k) + 0.5) / kRates - 10.0;
    error += read_and_undone(rate) - rate;
  }
  EXPECT_NEAR(error / kRates, 0.0, 1e-9);
}

/// Mean error of noisy samples about a rate, by draws.
double mean_error(double rate, double sigma, std::mt19937& random) {
  constexpr int kDraws = 20'000;
  std::normal_distribution<double> noisy{rate, sigma};
  double sum = 0.0;
  for (int k = 0; k < kDraws; ++k) sum += read_and_undone(noisy(random)) - rate;
  return sum / kDraws;
}

// Three deviations of the mean of the draws are 0.02 steps times the noise.
TEST(CellOfZero, HasAVarianceAboveItsErrorAndNoMoreThanNeeded) {
  std::mt19937 random(11);
  for (const double sigma : {0.2, 0.5, 1.0, 2.0}) {
    double squares = 0.0;
    constexpr int kPlaces = 20;
    for (int k = 0; k < kPlaces; ++k) {
      const double rate = (1.0 + sigma) * (static_cast<double>(k) + 0.5) / kPlaces;
      squares += std::pow(mean_error(rate, sigma, random), 2) / kPlaces;
    }
    const auto noise = static_cast<float>(sigma * sigma);
    const double claimed = std::sqrt(double{cell_of_zero_variance(1.0F, noise)});
    EXPECT_GT(claimed, std::sqrt(squares) - 0.02 * sigma) << sigma;
    EXPECT_LT(claimed, 2.0 * std::sqrt(squares) + 0.02 * sigma) << sigma;
    EXPECT_FLOAT_EQ(cell_of_zero_variance(2.0F, 4.0F * noise),
                    4.0F * cell_of_zero_variance(1.0F, noise));
  }
  EXPECT_EQ(cell_of_zero_variance(0.0F, 1.0F), 0.0F);
}

/// Deviation that a watch adds to the bias after rest at a rate, in steps.
/// @param sigma_of_model  noise by the model, which may be wrong
double claimed_at(double rate, double sigma, double sigma_of_model) {
  RoundingWatch<1> watch{{.step_rad_s = 1.0F, .is_truncation = true},
                         static_cast<float>(sigma_of_model * sigma_of_model)};
  std::mt19937 random(5);
  std::normal_distribution<double> noisy{rate, sigma};
  for (int window = 0; window < 64; ++window) {
    RoundingWatch<1>::Rates squares{};
    float before = 0.0F;
    for (int k = 0; k <= 50; ++k) {
      const auto sample = static_cast<float>(read_and_undone(noisy(random)));
      watch.take({sample});
      if (k > 0) squares[0] += (sample - before) * (sample - before);
      before = sample;
    }
    watch.observe(squares, 50);
  }
  return std::sqrt(double{watch.variance_rad2_s2(0)});
}

TEST(RoundingWatchOfTruncation, DoublesTheStepNearZeroAlone) {
  EXPECT_NEAR(claimed_at(0.4, 0.05, 0.05), 1.0 / std::sqrt(3.0), 0.01);
  EXPECT_NEAR(claimed_at(6.4, 0.05, 0.05), 0.5 / std::sqrt(3.0), 0.01);
  EXPECT_NEAR(claimed_at(0.4, 1.0, 1.0), 0.113, 0.02);
  EXPECT_LT(claimed_at(8.4, 1.0, 1.0), 1e-3);
}
TEST(RoundingWatchOfTruncation, CoversNoiseBelowThatOfTheModel) {
  EXPECT_NEAR(claimed_at(0.4, 0.05, 1.0), 1.0 / std::sqrt(3.0), 0.01);
}

}  // namespace
}  // namespace zerorate::core
