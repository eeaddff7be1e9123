// Each figure of the simulated odometer, measured in what it shows and counts.

#include "host_tools/lib/simulate/vehicle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "host_tools/lib/odometry/odometer_figures.hpp"

namespace zerorate::simulate {
namespace {

constexpr double kPeriod_s = 0.01;

/// Half an hour: 20 s of rest, up to 10 m/s at 0.5 m/s2, down again, and so on.
std::vector<double> drive() {
  std::vector<double> speed;
  for (int k = 0; k < 180'000; ++k) {
    const double in_cycle_s = std::fmod(k * kPeriod_s, 60.0);
    speed.push_back(std::max(0.0, 0.5 * std::min(in_cycle_s - 20.0, 60.0 - in_cycle_s)));
  }
  return speed;
}

odometry::SpeedRecord record_of(const OdometerParams& params) {
  odometry::SpeedRecord record{.name = "simulated"};
  record.reference_m_s = drive();
  record.odometer_m_s = shown_speed(record.reference_m_s, kPeriod_s, params);
  for (std::size_t k = 0; k < record.odometer_m_s.size(); ++k) {
    record.time_s.push_back(kPeriod_s * static_cast<double>(k));
  }
  return record;
}

odometry::OdometerFigures figures_of(const OdometerParams& params) {
  return odometry::measure_odometer(record_of(params));
}

TEST(SimulatedOdometer, IdealShowsTheSpeed) {
  const std::vector<double> speed = drive();
  EXPECT_EQ(shown_speed(speed, kPeriod_s, {}), speed);
}

TEST(SimulatedOdometer, CountsMetresPerPulse) {
  const std::vector<double> speed = drive();
  double distance_m = 0.0;
  for (const double v : speed) distance_m += v * kPeriod_s;
  for (const double metres_per_pulse : {0.02, 0.05, 1.9}) {
    const auto pulses = count_pulses(speed, kPeriod_s, {.metres_per_pulse = metres_per_pulse});
    EXPECT_NEAR(static_cast<double>(pulses.back()), distance_m / metres_per_pulse, 1.0);
  }
}

TEST(SimulatedOdometer, IsSilentInItsDeadBandWithHysteresis) {
  const auto figures =
      figures_of({.leaves_zero_at_m_s = 0.9, .silent_below_m_s = 0.6, .holds_s = 0.0});
  EXPECT_NEAR(figures.leaves_zero_m_s.sorted.front(), 0.9, 0.006);
  EXPECT_NEAR(figures.leaves_zero_m_s.sorted.back(), 0.9, 0.006);
  EXPECT_NEAR(figures.reaches_zero_m_s.sorted.front(), 0.6, 0.006);
  EXPECT_NEAR(figures.reaches_zero_m_s.sorted.back(), 0.6, 0.006);
}

TEST(SimulatedOdometer, HoldsItsSmallestSpeed) {
  const OdometerParams params{
      .leaves_zero_at_m_s = 0.75, .silent_below_m_s = 0.75, .holds_s = 2.0, .step_m_s = 0.25};
  const auto figures = figures_of(params);
  EXPECT_NEAR(figures.smallest_m_s.value_or(0.0), 0.75, 1e-9);
  EXPECT_NEAR(figures.holds_s.median.value, 2.0, 0.025);
}

TEST(SimulatedOdometer, IsLateByItsLatency) {
  for (const double late_s : {0.0, 0.1, 0.4}) {
    EXPECT_NEAR(figures_of({.latency_s = late_s}).latency_s.value, late_s, 0.005);
  }
}

TEST(SimulatedOdometer, RoundsToItsStep) {
  EXPECT_NEAR(figures_of({.step_m_s = 0.3}).step_m_s.value_or(0.0), 0.3, 1e-9);
}

// A message stands until the next one, which adds half an interval to the latency.
TEST(SimulatedOdometer, SendsMessagesAtItsRate) {
  for (const double rate_hz : {1.0, 2.5, 5.0, 15.0}) {
    const auto record = record_of({.message_rate_hz = rate_hz});
    int changes = 0;
    int moving = 0;
    for (std::size_t k = 1; k < record.size(); ++k) {
      if (record.reference_m_s[k - 1] == 0.0) continue;
      ++moving;
      changes += record.odometer_m_s[k] != record.odometer_m_s[k - 1] ? 1 : 0;
    }
    EXPECT_NEAR(changes / (moving * kPeriod_s), rate_hz, 0.05 * rate_hz);
    EXPECT_NEAR(odometry::measure_latency(record).value, 0.5 / rate_hz, 0.02) << rate_hz;
  }
}

TEST(SimulatedOdometer, CountsAtThePaceOfItsMessages) {
  const OdometerParams params{.metres_per_pulse = 0.01, .message_rate_hz = 1.0};
  const std::vector<double> speed = drive();
  const auto pulses = count_pulses(speed, kPeriod_s, params);
  for (std::size_t k = 3'100; k < 3'200; k += 10) {  // the message sent at 31 s says 5.5 m/s
    EXPECT_NEAR(static_cast<double>(pulses[k] - pulses[3'099]),
                static_cast<double>(k - 3'099) * 5.5, 1.0);
  }
}

TEST(SimulatedOdometer, OfACarHasTheFiguresOfThePage) {
  const auto figures = figures_of(car_odometer());
  EXPECT_NEAR(figures.smallest_m_s.value_or(0.0), 0.833, 0.001);
  EXPECT_NEAR(figures.step_m_s.value_or(0.0), 0.278, 0.001);
  // At 0.5 m/s2: as a message may be 0.4 s later than the wheel, and is 0.1 s late.
  EXPECT_GE(figures.leaves_zero_m_s.sorted.front(), 0.83);
  EXPECT_LE(figures.leaves_zero_m_s.sorted.back(), 0.83 + 0.5 * 0.52);
  EXPECT_NEAR(figures.holds_s.median.value, 2.8 + 0.3, 0.3);
  EXPECT_NEAR(figures.latency_s.value, 0.1 + 0.2, 0.03);
}

TEST(SimulatedOdometer, RefusesWhatNoOdometerCanHave) {
  const std::vector<double> speed(10, 1.0);
  for (const OdometerParams& params :
       {OdometerParams{.metres_per_pulse = 0.0},
        OdometerParams{.leaves_zero_at_m_s = 0.5, .silent_below_m_s = 0.6},
        OdometerParams{.holds_s = -1.0}, OdometerParams{.latency_s = -0.1},
        OdometerParams{.message_rate_hz = 101.0}, OdometerParams{.step_m_s = -0.1}}) {
    EXPECT_THROW((void)shown_speed(speed, kPeriod_s, params), std::invalid_argument);
  }
}

}  // namespace
}  // namespace zerorate::simulate
