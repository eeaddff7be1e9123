// Figures of docs/reference/real-odometers.md, measured again on the recordings.

#include <gtest/gtest.h>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/odometry/odometer_figures.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::odometry {
namespace {

class RealOdometer : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
    if (!folder_) GTEST_SKIP() << "skipped: no recordings";
  }
  [[nodiscard]] OdometerFigures measure(const char* name) const {
    return measure_odometer(read_speed_record(*folder_ / "vehicle_drives" / name));
  }

 private:
  std::optional<std::filesystem::path> folder_;
};

/// Expects a figure of the page, to the digits that stand there.
void expect_figure(const BootstrapFigure& figure, double value, double lo, double hi,
                   double digit) {
  EXPECT_NEAR(figure.value, value, 0.51 * digit);
  EXPECT_NEAR(figure.lo, lo, 0.51 * digit);
  EXPECT_NEAR(figure.hi, hi, 0.51 * digit);
}

const Rolling& in(Situation situation, const OdometerFigures& figures) {
  return figures.rolling_by_situation[static_cast<std::size_t>(situation)];
}

TEST_F(RealOdometer, OfK19IsAsDocumented) {
  const OdometerFigures figures = measure("speeds_kingston_k19_1_5hz.csv.gz");
  EXPECT_NEAR(figures.smallest_m_s.value_or(0.0), 3.0 / 3.6, 1e-3);
  EXPECT_NEAR(figures.step_m_s.value_or(0.0), 1.0 / 3.6, 1e-3);
  expect_figure(figures.leaves_zero_m_s.median, 0.83, 0.75, 0.945, 0.01);
  expect_figure(figures.holds_s.median, 3.0, 2.8, 3.0, 0.1);
  expect_figure(figures.renewal_s.median, 0.4, 0.4, 0.4, 0.1);
  expect_figure(figures.latency_s, -0.068, -0.083, -0.052, 0.001);
  expect_figure(figures.scale, 0.994, 0.993, 0.995, 0.001);
  expect_figure(figures.rolling.share, 0.095, 0.053, 0.180, 0.001);
  EXPECT_EQ(in(Situation::before_stop, figures).rows, 49U);
  EXPECT_EQ(in(Situation::after_stop, figures).rows, 205U);
  EXPECT_EQ(in(Situation::inching, figures).rows, 82U);
  EXPECT_EQ(in(Situation::passing, figures).rows, 50U);
}

TEST_F(RealOdometer, OfT19IsAsDocumented) {
  const OdometerFigures figures = measure("speeds_toronto_t19_2_5hz.csv.gz");
  EXPECT_NEAR(figures.smallest_m_s.value_or(0.0), 3.0 / 3.6, 1e-3);
  EXPECT_NEAR(figures.step_m_s.value_or(0.0), 1.0 / 3.6, 1e-3);
  expect_figure(figures.leaves_zero_m_s.median, 0.80, 0.75, 0.855, 0.01);
  expect_figure(figures.holds_s.median, 2.8, 2.8, 2.8, 0.1);
  expect_figure(figures.latency_s, -0.036, -0.047, -0.026, 0.001);
  expect_figure(figures.rolling.share, 0.097, 0.063, 0.153, 0.001);
  EXPECT_EQ(in(Situation::after_stop, figures).rows, 292U);
}

TEST_F(RealOdometer, OfK08IsAsDocumented) {
  const OdometerFigures figures = measure("kingston2008_10hz.csv.gz");
  expect_figure(figures.latency_s, 0.38, 0.33, 0.43, 0.01);
  expect_figure(figures.rolling.share, 0.049, 0.021, 0.141, 0.001);
  const auto turning_dps = [](const std::vector<double>& sorted_rad_s, double p) {
    return statistics::quantile_of_sorted(sorted_rad_s, p) * units::kDegPerRad;
  };
  EXPECT_NEAR(turning_dps(figures.rolling.turning_rad_s, 0.5), 0.025, 0.0006);
  EXPECT_NEAR(turning_dps(figures.rolling.turning_rad_s, 0.95), 0.25, 0.006);
  EXPECT_NEAR(turning_dps(figures.rolling.turning_rad_s, 1.0), 1.42, 0.006);
  EXPECT_NEAR(turning_dps(figures.standing_turning_rad_s, 0.5), 0.0056, 0.0001);
}

}  // namespace
}  // namespace zerorate::odometry
