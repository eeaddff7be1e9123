#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tools/lab/paper/measured_sets.hpp"
#include "host_tools/lab/paper/table1.hpp"

namespace zerorate::paper {
namespace {

constexpr std::size_t kRuns = 200;

// All runs and their exact expectations, made once. A fifth of the paper's 1000, which
// `zerorate-reproduce table1` takes: every tolerance below is computed from the runs.
const std::vector<SimulatedStanding>& table() {
  static const std::vector<SimulatedStanding> standings =
      simulate_table1({.runs = kRuns, .seed = 1}, {});
  return standings;
}

const SimulatedStanding& standing(std::string_view name) {
  for (const SimulatedStanding& s : table()) {
    if (s.measured.name == name) return s;
  }
  throw std::out_of_range("no such predictor");
}

double expected_ratio(const SimulatedStanding& s, double Expectation::*member) {
  return s.expected.value().*member / table().back().expected.value().*member;
}

// Four standard errors each; the controlled ratio has a tenth to a fifth of the plain one's.
TEST(SimulatedTable1, AgreesWithWhatTheCovarianceExpects) {
  for (const SimulatedStanding& s : table()) {
    if (!s.expected) continue;
    const Standing& m = s.measured;
    const Expectation& e = *s.expected;
    const double rsse = expected_ratio(s, &Expectation::mean_rsse);
    const double ie = expected_ratio(s, &Expectation::std_ie);
    EXPECT_NEAR(m.std_ie.value, e.std_ie, 4.0 * m.std_ie.error) << m.name;
    EXPECT_NEAR(m.mean_rsse.value, e.mean_rsse, 4.0 * m.mean_rsse.error) << m.name;
    EXPECT_NEAR(m.std_rsse.value, e.std_rsse, 4.0 * m.std_rsse.error) << m.name;
    EXPECT_NEAR(m.ie_ratio.value, ie, 4.0 * m.ie_ratio.error) << m.name;
    EXPECT_NEAR(m.rsse_ratio.value, rsse, 4.0 * m.rsse_ratio.error) << m.name;
    EXPECT_NEAR(s.controlled_rsse_ratio.value, rsse, 4.0 * s.controlled_rsse_ratio.error) << m.name;
    EXPECT_NEAR(m.coverage.value, e.coverage, 4.0 * m.coverage.error) << m.name;
  }
}

// References from 4000 runs of another program, whose own standard errors are 0.0012, 0.0013,
// 0.0015 and 0.0016: the expectations, which have none, lie within 0.003 of the first three, and of
// the fourth to the three decimals of the paper's 139/138.
TEST(SimulatedTable1, AgreesWithReferencesOfAnotherProgram) {
  const auto rsse_ratio = [](std::string_view name) {
    return expected_ratio(standing(name), &Expectation::mean_rsse);
  };
  EXPECT_NEAR(rsse_ratio("full-state Kalman (paper)"), 0.9847, 0.003);
  EXPECT_NEAR(rsse_ratio("optimum, b unknown"), 0.9775, 0.003);
  EXPECT_NEAR(rsse_ratio("optimum, b known"), 0.9712, 0.003);
  EXPECT_NEAR(rsse_ratio("moving average"), 139.0 / 138.0, 0.001);
  EXPECT_NEAR(rsse_ratio("moving average"), 1.0098, 3.0 * 0.0016);
}

// The paper's full-state filter: 0.930 and 0.9855 (Table I). These are expectations, without
// chance; rounding of the weights to single precision is below 1e-4.
TEST(DecadeFilter, IsBetterThanThePapersFilterAndNextToTheOptimum) {
  const SimulatedStanding& decade = standing("decade Kalman, zero start");
  const double rsse = expected_ratio(decade, &Expectation::mean_rsse);
  const double optimum = expected_ratio(standing("optimum, b unknown"), &Expectation::mean_rsse);
  EXPECT_LE(expected_ratio(decade, &Expectation::std_ie), 0.935);
  EXPECT_LE(rsse, 0.980);
  EXPECT_LT(rsse, expected_ratio(standing("full-state Kalman (paper)"), &Expectation::mean_rsse));
  EXPECT_LE(rsse, 1.001 * optimum);
  EXPECT_GE(rsse, optimum - 1e-4);
}

// A fitted autoregressive model's own band holds too little: that is why all have one under the
// noise model.
TEST(SimulatedTable1, FindsTheStatedBandsAndInnovations) {
  for (const SimulatedStanding& s : table()) {
    const Standing& m = s.measured;
    if (s.expected) {
      EXPECT_NEAR(s.expected->coverage, 0.9545, 0.01) << m.name;
    }
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
    const double expected = s.expected_decade_kalman.mean_rsse / s.expected_optimum.mean_rsse;
    EXPECT_LE(expected, 1.005) << s.order;
    EXPECT_GE(expected, 1.0 - 1e-4) << s.order;
    const Figure measured = s.decade_kalman.rsse_ratio;
    EXPECT_NEAR(measured.value, 1.0, 0.005 + 4.0 * measured.error) << s.order;
  }
}

TEST(DecadeFilter, StaysNextToTheOptimumUnderWhiteNoise) {
  SimulationOptions options{.runs = 40, .seed = 3};
  options.noise.white_variance = 10.0 * options.noise.innovation_variance;  // the paper's ratio
  const auto standings = compare_orders({0.5}, options, {});
  const Expectation& decade = standings.front().expected_decade_kalman;
  const Expectation& optimum = standings.front().expected_optimum;
  EXPECT_LE(decade.mean_rsse, 1.0005 * optimum.mean_rsse);
  EXPECT_LE(decade.std_ie, 1.01 * optimum.std_ie);
}

// The paper's real data have 0.990 and 0.915; ten runs of the sensor at hand gave 0.990 and 0.888.
TEST(MeasuredTable1, AgreesWithTheReferenceAtOneHertz) {
  const auto folder = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
  if (!folder) GTEST_SKIP() << "skipped: no recordings";
  std::vector<std::filesystem::path> files;
  for (const char* run : {"run1", "run2", "run3"}) {
    files.push_back(*folder / "adis16405_static" /
                    (std::string(run) + "_1hz_mean_with_accel.csv.gz"));
  }
  const auto tables = measure_table1(read_rest_recordings(files, 20.0), {}, {});
  ASSERT_EQ(tables.size(), 1U);
  for (const Standing& s : tables.front().standings) {
    if (s.name != "decade Kalman, d = 1/2") continue;
    EXPECT_NEAR(s.rsse_ratio.value, 0.990, 3.0 * s.rsse_ratio.error);
    EXPECT_NEAR(s.ie_ratio.value, 0.888, 3.0 * s.ie_ratio.error);
    EXPECT_LT(s.rsse_ratio.value + 2.0 * s.rsse_ratio.error, 1.0);
    EXPECT_NEAR(s.coverage.value, 0.9545, 0.01 + 3.0 * s.coverage.error);
  }
}

}  // namespace
}  // namespace zerorate::paper
