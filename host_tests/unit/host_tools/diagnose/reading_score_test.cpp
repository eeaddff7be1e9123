#include "host_tools/lib/diagnose/forecast_gain/reading_score.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace zerorate::diagnose {
namespace {

using Forecast = core::SampleScreen::Forecast;

constexpr Forecast kMixture{.expected_rad_s = 0.3F,
                            .variance = 1.0F,
                            .outlier = 0.02F,
                            .outlier_variance = 25.0F,
                            .moved = 0.1F,
                            .offset_rad_s = -2.0F,
                            .offset_variance = 4.0F};

/// Probability of all readings, summed over cells of this width.
double total(const Forecast& forecast, const Scale& scale, double width, double from, double to) {
  double sum = 0.0;
  for (double reading = from; reading <= to + 0.5 * width; reading += width) {
    sum += width * std::exp(log_score(forecast, reading, scale));
  }
  return sum;
}

TEST(ReadingScore, OfARateIsADensity) {
  EXPECT_NEAR(total(kMixture, {}, 0.01, -60.0, 60.0), 1.0, 1e-6);
}

TEST(ReadingScore, OfRoundedReadingsSumsToOneOverTheirLevels) {
  for (const double step : {0.5, 1.0, 2.0}) {
    EXPECT_NEAR(total(kMixture, {.step_rad_s = step}, step, -60.0, 60.0), 1.0, 1e-9) << step;
  }
}

TEST(ReadingScore, OfUnknownLevelsSumsToOne) {
  for (const double step : {0.3, 1.5, 6.0, 30.0}) {
    const Scale scale{.unknown_step_rad_s = step};
    const double from = -std::ceil(90.0 / step) * step;
    constexpr Forecast kNormal{.expected_rad_s = 0.3F, .variance = 1.0F};
    EXPECT_NEAR(total(kNormal, scale, step, from, 90.0), 1.0, 1e-6) << step;
  }
}

TEST(ReadingScore, OfFineRoundingIsThatOfTheRate) {
  for (const double reading : {-3.0, 0.0, 0.7, 4.0}) {
    EXPECT_NEAR(
        log_score(kMixture, reading, {.step_rad_s = 0.01, .rounding_variance = 0.01 * 0.01 / 12.0}),
        log_score(kMixture, reading, {}), 1e-4);
  }
}

TEST(ReadingScore, OfAnEndOfTheRangeIsTheProbabilityOfAllBeyond) {
  constexpr double kCell = 0.1;
  const Scale scale{.end_cell_rad_s = kCell, .range = {.lower_rad_s = -1.5F, .upper_rad_s = 2.0F}};
  // Densities between the ends by the midpoint rule, and what is at the ends.
  constexpr double kWidth = 0.001;
  const double inside = total(kMixture, scale, kWidth, -1.5 + 0.5 * kWidth, 2.0 - 0.6 * kWidth);
  const double ends = kCell * (std::exp(log_score(kMixture, -1.5, scale)) +
                               std::exp(log_score(kMixture, 2.0, scale)));
  EXPECT_NEAR(inside + ends, 1.0, 1e-6);
}

TEST(ReadingScore, OfRoundedReadingsInARangeSumsToOne) {
  const Scale scale{.step_rad_s = 0.5, .range = {.lower_rad_s = -1.5F, .upper_rad_s = 2.0F}};
  EXPECT_NEAR(total(kMixture, scale, 0.5, -1.5, 2.0), 1.0, 1e-9);
}

}  // namespace
}  // namespace zerorate::diagnose
