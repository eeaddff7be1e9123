#include "core/estimator/evidence.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::core {
namespace {

constexpr std::size_t kHypotheses = 3;
constexpr std::array kVariances{0.25F, 1.0F, 4.0F};
constexpr std::array kLogPriors{-0.5F, 0.0F, -0.25F};
using Three = Evidence<kHypotheses, 2>;

/// Hypotheses as a filter is given them.
struct Given {
  struct One {
    float log_prior = 0.0F;
    [[nodiscard]] static float first_log_evidence() { return 0.0F; }
  };
  std::size_t count = kHypotheses;
  float kept = 1.0F;
  std::array<One, kHypotheses> all{{{kLogPriors[0]}, {kLogPriors[1]}, {kLogPriors[2]}}};
};

/// Variance that a hypothesis predicts for a measurement: no two have a constant ratio.
float variance(std::size_t m, std::int64_t k) {
  return k % 10 == 0 ? 5.0F * kVariances[m] : 1.0F + 0.1F * static_cast<float>(m);
}

/// Residual of measurement k on an axis: the second hypothesis is right, at a scale of 9 or 1.
float residual(std::int64_t k, std::size_t axis) {
  const random::RandomStream noise{5, axis};
  const double scale = axis == 0 ? 9.0 : 1.0;
  return static_cast<float>(std::sqrt(scale * double{variance(1, k)}) * noise.normal(k));
}

Three told(std::int64_t measurements, float kept = 1.0F) {
  Three evidence;
  const Given given{.kept = kept};
  evidence.start(given);
  for (std::int64_t k = 0; k < measurements; ++k) {
    for (std::size_t m = 0; m < kHypotheses; ++m) {
      for (std::size_t i = 0; i < 2; ++i) {
        evidence.observe(m, i, variance(m, k), residual(k, i), kept);
      }
    }
    evidence.conclude(given);
  }
  return evidence;
}

/// The normal-inverse-gamma posterior of all measurements at once.
struct Batch {
  double shape = double{Three::kPriorShape};
  double rate = double{Three::kPriorShape};
  double log_evidence = 0.0;
};
Batch batch(std::int64_t measurements, std::size_t m, std::size_t axis) {
  Batch posterior;
  for (std::int64_t k = 0; k < measurements; ++k) {
    const double e = double{residual(k, axis)};
    posterior.shape += 0.5;
    posterior.rate += 0.5 * e * e / double{variance(m, k)};
    posterior.log_evidence -= 0.5 * std::log(double{variance(m, k)});
  }
  posterior.log_evidence -= posterior.shape * std::log(posterior.rate);
  return posterior;
}

TEST(EvidenceOfManyMeasurements, IsThatOfTheConjugatePosterior) {
  constexpr std::int64_t kMeasurements = 40;
  const Three evidence = told(kMeasurements);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::array<double, kHypotheses> expected{};
    double sum = 0.0;
    for (std::size_t m = 0; m < kHypotheses; ++m) {
      // Less that of the second hypothesis, so that no exponential overflows.
      const auto gained = [&](std::size_t of_axis) {
        return batch(kMeasurements, m, of_axis).log_evidence -
               batch(kMeasurements, 1, of_axis).log_evidence;
      };
      expected[m] = std::exp(double{kLogPriors[m]} + gained(axis) + 0.2 * gained(1 - axis));
      sum += expected[m];
    }
    for (std::size_t m = 0; m < kHypotheses; ++m) {
      const Batch one = batch(kMeasurements, m, axis);
      EXPECT_NEAR(double{evidence.hypotheses[m][axis].weight}, expected[m] / sum, 2e-5) << m;
      EXPECT_NEAR(double{evidence.hypotheses[m][axis].scale}, one.rate / one.shape,
                  2e-5 * one.rate);
      EXPECT_NEAR(double{evidence.mean_scale(m, axis)}, one.rate / (one.shape - 1.0),
                  2e-5 * one.rate);
    }
  }
}

TEST(EvidenceOfManyMeasurements, FindsTheHypothesisAndTheScaleOfEachAxis) {
  const Three evidence = told(4000);
  EXPECT_GT(evidence.hypotheses[1][0].weight, 0.99F);
  EXPECT_GT(evidence.hypotheses[1][1].weight, 0.99F);
  // The relative error of a variance of n measurements is sqrt(2 / n): four of them.
  const double tolerance = 4.0 * std::sqrt(2.0 / 4000.0);
  EXPECT_NEAR(double{evidence.hypotheses[1][0].scale}, 9.0, 9.0 * tolerance);
  EXPECT_NEAR(double{evidence.hypotheses[1][1].scale}, 1.0, tolerance);
}

TEST(EvidenceThatFades, RestsOnTheNewestMeasurements) {
  constexpr float kKept = 0.99F;  // a memory of a hundred measurements
  const Three evidence = told(4000, kKept);
  EXPECT_NEAR(evidence.shape, 0.5F / (1.0F - kKept), 0.5F);
}

TEST(EvidenceBeforeAnyMeasurement, IsThePrior) {
  const Three evidence = told(0);
  float sum = 0.0F;
  for (const float log_prior : kLogPriors) sum += std::exp(log_prior);
  for (std::size_t m = 0; m < kHypotheses; ++m) {
    EXPECT_NEAR(evidence.hypotheses[m][0].weight, std::exp(kLogPriors[m]) / sum, 1e-6F);
  }
}

TEST(EvidenceOfAnImpossibleMeasurement, StaysFinite) {
  Three evidence = told(100);
  for (std::size_t m = 0; m < kHypotheses; ++m) {
    evidence.observe(m, 0, 1e-12F, 1e6F, 1.0F);
    evidence.observe(m, 1, 1e-30F, 0.0F, 1.0F);
  }
  evidence.conclude(Given{});
  for (std::size_t m = 0; m < kHypotheses; ++m) {
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_TRUE(is_finite(evidence.hypotheses[m][i].weight));
      EXPECT_TRUE(is_finite_positive(evidence.hypotheses[m][i].scale));
    }
  }
}

}  // namespace
}  // namespace zerorate::core
