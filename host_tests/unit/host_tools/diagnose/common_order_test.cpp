#include "host_tools/lib/diagnose/selection/common_order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "host_tests/support/simulated_rest.hpp"
#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::diagnose {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using zerorate::testing::kRadPerDeg;
using zerorate::testing::RestNoise;

constexpr std::size_t kSamples = 10'000;
constexpr double kPeriod = 0.1;

Record axis_of(const RestNoise& noise, std::uint64_t run) {
  return record_of(zerorate::testing::rest_samples_of(
                       zerorate::testing::simulate_rest(noise, kSamples, kPeriod, run)),
                   0);
}

/// Flicker noise as strong as that of order 1/2 at 0.01 Hz.
RestNoise of_order(double order) {
  const double pivot = 2.0 * std::numbers::pi * 0.01;
  return {.angle_random_walk_dps_per_sqrt_hz = 0.01,
          .bias_instability_dph = 25.0 * std::pow(pivot, order - 0.5),
          .order = order};
}

std::vector<std::string> causes_of(const Diagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const Cause& cause : diagnosis.causes) names.push_back(cause.effect);
  return names;
}

TEST(OrderProfile, PeaksWhereTheFreeOrderDoes) {
  const Record record = axis_of(of_order(0.7), 1);
  const EvenSeries series = even_series_of(record);
  const FitData data(series, 1);
  const Hypothesis base(data, {});

  const OrderProfile::Peak peak = OrderProfile(base).peak();

  const Hypothesis free = [&] {
    const auto candidate = make_fractional_order()->examine(base);
    return Hypothesis(data, {candidate->part}, &base);
  }();
  // The parabola through places 0.05 apart against the likelihood's own curvature.
  EXPECT_NEAR(peak.order, free.noise().spectrum.flicker_order, 0.1 * peak.standard_error);
  EXPECT_NEAR(peak.standard_error / free.noise().error(NoiseParameterId::flicker_order), 1.0, 0.25);
  EXPECT_NEAR(peak.log_likelihood, free.log_likelihood(), 0.05);
}

TEST(DiagnosisOfThreeAxes, NamesTheOrderThatNoneOfThemTellsAlone) {
  std::vector<Record> axes;
  for (const std::uint64_t run : {11U, 12U, 13U}) axes.push_back(axis_of(of_order(0.68), run));
  for (const Record& axis : axes) EXPECT_THAT(diagnose(axis).causes, IsEmpty());

  const std::vector<Diagnosis> diagnoses = diagnose(axes);

  ASSERT_THAT(diagnoses, SizeIs(3));
  for (const Diagnosis& diagnosis : diagnoses) {
    ASSERT_THAT(causes_of(diagnosis), ElementsAre("fractional_order"));
    const Cause& cause = diagnosis.causes.front();
    EXPECT_EQ(cause.axes, 3U);
    EXPECT_LT(cause.parameters.front().lo, 0.68);
    EXPECT_GT(cause.parameters.front().hi, 0.68);
    EXPECT_EQ(diagnosis.verdict, Verdict::explained);
    ASSERT_TRUE(diagnosis.extended_model.flicker);
    if (cause.in_model) {
      EXPECT_EQ(diagnosis.extended_model.flicker->order, cause.parameters.front().value);
    } else {
      EXPECT_EQ(diagnosis.extended_model, diagnosis.base_model);
    }
  }
}

TEST(DiagnosisOfThreeAxes, LeavesAnEffectOfOneAxisToThatAxis) {
  std::vector<Record> axes{axis_of(of_order(0.9), 21), axis_of(of_order(0.5), 22),
                           axis_of(of_order(0.5), 23)};

  const std::vector<Diagnosis> diagnoses = diagnose(std::move(axes));

  ASSERT_THAT(diagnoses[0].causes, SizeIs(1));
  EXPECT_EQ(diagnoses[0].causes.front().axes, 1U);
  EXPECT_THAT(diagnoses[1].causes, IsEmpty());
  EXPECT_THAT(diagnoses[2].causes, IsEmpty());
}

TEST(DiagnosisOfThreeAxes, IsThatOfEachWithoutACommonCause) {
  std::vector<Record> axes{axis_of(of_order(0.5), 31), axis_of(of_order(0.9), 32),
                           axis_of(of_order(0.5), 33)};
  std::vector<Diagnosis> alone;
  for (const Record& axis : axes) alone.push_back(diagnose(axis));

  const std::vector<Diagnosis> together = diagnose(std::move(axes));

  for (std::size_t i = 0; i < together.size(); ++i) {
    EXPECT_EQ(causes_of(together[i]), causes_of(alone[i]));
    EXPECT_EQ(together[i].extended_model, alone[i].extended_model);
  }
}

}  // namespace
}  // namespace zerorate::diagnose
