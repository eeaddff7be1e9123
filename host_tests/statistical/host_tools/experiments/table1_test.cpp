#include "host_tools/lib/experiments/table1.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace zerorate::experiments {
namespace {

// All runs and their exact expectations, made once. 300 runs: the standard errors are 1.8 times
// those of the paper's 1000 (`zerorate reproduce table1`), and every tolerance below counts them.
const std::vector<SimulatedStanding>& table() {
  static const std::vector<SimulatedStanding> standings =
      simulate_table1({.runs = 200, .seed = 20120416}, {});
  return standings;
}

const SimulatedStanding& standing(std::string_view name) {
  for (const SimulatedStanding& s : table()) {
    if (s.measured.name == name) return s;
  }
  throw std::out_of_range("no such predictor");
}

// A reference from 4000 runs of another implementation has an error itself: half of ours at 1000.
void expect_near_reference(const SimulatedStanding& s, double reference, double tolerance) {
  const double error = s.measured.rsse_ratio.error;
  const double error_of_reference = error * std::sqrt(200.0 / 4000.0);
  EXPECT_NEAR(s.measured.rsse_ratio.value, reference,
              tolerance + 3.0 * std::hypot(error, error_of_reference))
      << s.measured.name;
}

TEST(SimulatedTable1, AgreesWithReferencesAndWithWhatTheCovarianceExpects) {
  expect_near_reference(standing("full-state Kalman (paper)"), 0.9847, 0.003);
  expect_near_reference(standing("optimum, b unknown"), 0.9775, 0.003);
  expect_near_reference(standing("optimum, b known"), 0.9712, 0.003);
  expect_near_reference(standing("moving average"), 1.0098, 0.003);
  for (const SimulatedStanding& s : table()) {
    if (!s.expected) continue;
    EXPECT_NEAR(s.measured.ie_ratio.value, s.expected->ie_ratio, 4.0 * s.measured.ie_ratio.error)
        << s.measured.name;
    EXPECT_NEAR(s.measured.std_ie.value, s.expected->std_ie, 4.0 * s.measured.std_ie.error)
        << s.measured.name;
  }
}

// The paper's full-state filter: .930 and .9855 (Table I). These are expectations, without chance;
// rounding of the weights to single precision is below 1e-4.
TEST(DecadeFilter, IsBetterThanThePapersFilterAndNextToTheOptimum) {
  const Expectation decade = standing("decade Kalman, zero start").expected.value();
  const Expectation optimum = standing("optimum, b unknown").expected.value();
  EXPECT_LE(decade.ie_ratio, 0.935);
  EXPECT_LE(decade.rsse_ratio, 0.980);
  EXPECT_LT(decade.rsse_ratio, standing("full-state Kalman (paper)").expected.value().rsse_ratio);
  EXPECT_LE(decade.rsse_ratio, 1.001 * optimum.rsse_ratio);
  EXPECT_GE(decade.rsse_ratio, optimum.rsse_ratio - 1e-4);
}

// A fitted autoregressive model's own band holds too little: that is why all have one under the
// noise model.
TEST(SimulatedTable1, FindsEveryPredictorsBandAndInnovationsAsTheyAreStated) {
  for (const SimulatedStanding& s : table()) {
    const Standing& m = s.measured;
    EXPECT_NEAR(m.coverage.value, 0.9545, 0.01 + 3.0 * m.coverage.error) << m.name;
    if (m.name.starts_with("decade")) {
      EXPECT_NEAR(m.nis.value, 1.0, 0.01 + 3.0 * m.nis.error) << m.name;
    }
    if (m.name.starts_with("AR")) {
      EXPECT_LT(m.own_coverage.value + 4.0 * m.own_coverage.error, 0.9545) << m.name;
    }
  }
}

TEST(DecadeFilter, IsWithinHalfAPercentOfTheOptimumAtAnyOrder) {
  const auto orders =
      compare_orders({0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}, {.runs = 40, .seed = 7}, {});
  for (const OrderStanding& s : orders) {
    EXPECT_LE(s.expected.rsse_ratio, 1.005) << s.order;
    EXPECT_GE(s.expected.rsse_ratio, 1.0 - 1e-4) << s.order;
    const Figure measured = s.decade_kalman.rsse_ratio;
    EXPECT_NEAR(measured.value, 1.0, 0.005 + 4.0 * measured.error) << s.order;
  }
}

TEST(DecadeFilter, StaysNextToTheOptimumUnderWhiteNoise) {
  SimulationOptions options{.runs = 40, .seed = 3};
  options.noise.white_variance = 10.0 * options.noise.innovation_variance;  // as the paper's sensor
  const auto standings = compare_orders({0.5}, options, {});
  EXPECT_LE(standings.front().expected.rsse_ratio, 1.0005);
  EXPECT_LE(standings.front().expected.ie_ratio, 1.01);
}

}  // namespace
}  // namespace zerorate::experiments
