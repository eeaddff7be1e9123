#include "host_tools/lib/simulate/odometer_scenarios.hpp"

#include "host_tools/lib/simulate/driver.hpp"
#include "host_tools/lib/simulate/odometer.hpp"
#include "host_tools/lib/simulate/scenario_gyro.hpp"

namespace zerorate::simulate {
namespace {

ScenarioDrive drive(const DriverParams& driver, const OdometerParams& odometer,
                    std::uint64_t seed) {
  VehicleMotion motion =
      follow(drive_in_traffic(driver, random::RandomStream{seed}), kScenarioPeriod_s);
  motion.odometer_pulses = count_pulses(motion.speed_m_s, kScenarioPeriod_s, odometer);
  return record(motion, {}, seed);
}

}  // namespace

ScenarioDrive dead_band(std::uint64_t seed) {
  return drive({}, car_odometer(), seed);
}

ScenarioDrive inching(std::uint64_t seed) {
  return drive({.mean_stop_s = 8.0, .inches_per_stop = 4.0, .widest_bend_m = 800.0}, car_odometer(),
               seed);
}

ScenarioDrive parking_turn(std::uint64_t seed) {
  return drive({.creep_s = 4.0,
                .creeping_share = 1.0,
                .inches_per_stop = 1.5,
                .tightest_bend_m = 4.0,
                .widest_bend_m = 8.0},
               car_odometer(), seed);
}

ScenarioDrive speed_by_can(std::uint64_t seed) {
  OdometerParams odometer = car_odometer();
  odometer.message_rate_hz = 1.0;
  return drive({}, odometer, seed);
}

}  // namespace zerorate::simulate
