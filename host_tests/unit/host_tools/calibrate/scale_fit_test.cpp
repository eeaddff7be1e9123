#include "host_tools/lib/calibrate/scale_fit.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::calibrate {
namespace {

constexpr double kRound = 2.0 * std::numbers::pi;
constexpr double kMark = 2.0 * std::numbers::pi / 180.0;

TEST(ScaleFit, OfExactTurnsIsExact) {
  const std::array<CountedTurn, 2> turns{
      {{.measured_rad = 10.0 * kRound * 1.005, .sigma_rad = 0.01, .turns = 10},
       {.measured_rad = -10.0 * kRound * 1.001, .sigma_rad = 0.01, .turns = -10}}};
  const ScaleFit fit = fit_scale(turns, {.mark_sigma_rad = kMark});
  EXPECT_NEAR(fit.scale.value, 0.003, 1e-12);
  ASSERT_TRUE(fit.asymmetry);
  EXPECT_NEAR(fit.asymmetry->value, 0.002, 1e-12);
}

TEST(ScaleFit, KnowsThatTheMiddleMarkEntersBothTurns) {
  const std::array<CountedTurn, 2> turns{{{.measured_rad = 10.0 * kRound, .turns = 10},
                                          {.measured_rad = -10.0 * kRound, .turns = -10}}};
  const ScaleFit fit = fit_scale(turns, {.mark_sigma_rad = kMark});
  // (m1 - m0) - (m2 - m1) over 20 rounds: six variances of a mark. Both ends alone are two.
  EXPECT_NEAR(fit.scale.sigma, std::sqrt(6.0) * kMark / (20.0 * kRound), 1e-12);
  EXPECT_NEAR(fit.asymmetry->sigma, std::sqrt(2.0) * kMark / (20.0 * kRound), 1e-12);
}

TEST(ScaleFit, OfOneSenseContainsTheAsymmetryThatTheSheetAllows) {
  const std::array<CountedTurn, 1> turns{{{.measured_rad = 10.0 * kRound, .turns = 10}}};
  const double marks = std::sqrt(2.0) * kMark / (10.0 * kRound);
  const ScaleFit fit = fit_scale(turns, {.mark_sigma_rad = kMark, .asymmetry_sigma = 0.003});
  EXPECT_FALSE(fit.asymmetry);
  EXPECT_NEAR(fit.scale.sigma, std::hypot(marks, 0.003), 1e-12);
}

TEST(ScaleFit, TrustsTheBetterTurnMore) {
  const std::array<CountedTurn, 2> turns{
      {{.measured_rad = kRound * 1.01, .sigma_rad = 1.0, .turns = 1},
       {.measured_rad = kRound, .sigma_rad = 0.1, .turns = 1}}};
  EXPECT_LT(fit_scale(turns, {.mark_sigma_rad = 0.001}).scale.value, 0.0002);
}

// Two to five turns in changing senses: 600 calibrations, for which a coverage of 0.95 has a
// standard error of 0.009. The bars are four of them.
TEST(ScaleFit, IntervalsHoldForNineteenOfTwenty) {
  constexpr int kCalibrations = 600;
  int scale_inside = 0;
  int asymmetry_inside = 0;
  for (int k = 0; k < kCalibrations; ++k) {
    const random::RandomStream draws{41, static_cast<std::uint64_t>(k)};
    const double scale = 0.01 * draws.normal(0);
    const double asymmetry = 0.002 * draws.normal(1);
    std::vector<CountedTurn> turns;
    double mark_rad = kMark * draws.normal(2);
    for (int i = 0; i < 2 + k % 4; ++i) {
      const int count = (i % 2 == 0 ? 1 : -1) * (5 + 5 * (i % 3));
      const double next_rad = kMark * draws.normal(10 + 2 * i);
      const double true_rad = kRound * count + next_rad - mark_rad;
      const double sigma_rad = 0.02 * (1 + i);
      mark_rad = next_rad;
      turns.push_back({.measured_rad = (1.0 + scale) * true_rad + asymmetry * std::abs(true_rad) +
                                       sigma_rad * draws.normal(11 + 2 * i),
                       .sigma_rad = sigma_rad,
                       .turns = count});
    }
    const ScaleFit fit = fit_scale(turns, {.mark_sigma_rad = kMark});
    if (std::abs(fit.scale.value - scale) < fit.scale.half_width()) ++scale_inside;
    if (std::abs(fit.asymmetry->value - asymmetry) < fit.asymmetry->half_width()) {
      ++asymmetry_inside;
    }
  }
  EXPECT_NEAR(scale_inside / double{kCalibrations}, 0.95, 0.036);
  EXPECT_NEAR(asymmetry_inside / double{kCalibrations}, 0.95, 0.036);
}

}  // namespace
}  // namespace zerorate::calibrate
