#include "host_tools/lib/simulate/scenario.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>

#include "host_tools/lib/simulate/motion_scenarios.hpp"
#include "host_tools/lib/simulate/simulate.hpp"
#include "host_tools/lib/simulate/vehicle.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::simulate {
namespace {

using units::kRadPerDeg;
constexpr double kPeriod_s = kScenarioPeriod_s;

ScenarioDrive record(const std::vector<Leg>& legs, const ScenarioGyro& gyro, std::uint64_t seed) {
  return record(follow(legs, kPeriod_s), gyro, seed);
}

std::vector<Leg> repeated(int times, const std::vector<Leg>& legs) {
  std::vector<Leg> all;
  for (int i = 0; i < times; ++i) all.insert(all.end(), legs.begin(), legs.end());
  return all;
}

constexpr Leg stop(double length_s) {
  return {.length_s = length_s};
}
/// A stretch of town: a bend of 8 deg/s, then straight on.
std::vector<Leg> stops_and_drives(int times, double stop_s, double drive_s) {
  return repeated(times, {stop(stop_s), {8.0, 10.0, 8.0}, {drive_s - 8.0, 10.0, 0.0}});
}
const std::vector<Leg> kSlowTurn{stop(60.0), {60.0, 5.0, 1.0}, stop(30.0)};

double time_s(const ScenarioRow& row) {
  return static_cast<double>(row.row.time_ns) * 1e-9;
}

VehicleMotion town(double duration_s, std::uint64_t seed) {
  return simulate_vehicle({.duration_s = duration_s, .mean_stop_s = 30.0, .mean_drive_s = 90.0},
                          kPeriod_s, random::RandomStream{seed});
}

ScenarioDrive city(std::uint64_t seed) {
  return record(town(1800.0, seed), {}, seed);
}

ScenarioDrive motorway(std::uint64_t seed) {
  const VehicleParams params{.duration_s = 3600.0,
                             .mean_stop_s = 120.0,
                             .mean_drive_s = 900.0,
                             .cruise_speed_m_s = 33.0,
                             .peak_turn_rad_s = 0.05};
  return record(simulate_vehicle(params, kPeriod_s, random::RandomStream{seed}), {}, seed);
}

/// A pulse every three seconds, and a turn too slow to be told from a bias within a stop.
ScenarioDrive parking_creep(std::uint64_t seed) {
  return record(
      std::vector<Leg>{
          stop(60.0), {120.0, 0.05 / 3.0, 0.25}, {60.0, 0.05 / 3.0, -0.25}, stop(60.0)},
      {}, seed);
}

ScenarioDrive slow_turn(std::uint64_t seed) {
  return record(kSlowTurn, {}, seed);
}

/// From `from_s` on no pulse comes.
void cut_wire(ScenarioDrive& drive, double from_s) {
  std::int64_t counted = 0;
  for (ScenarioRow& row : drive.rows) {
    if (time_s(row) < from_s) counted = row.row.odometer_pulses;
    row.row.odometer_pulses = counted;
  }
}

ScenarioDrive slow_turn_dead_odometer(std::uint64_t seed) {
  ScenarioDrive drive = slow_turn(seed);
  cut_wire(drive, 0.0);
  return drive;
}

ScenarioDrive carousel(std::uint64_t seed) {
  return record(std::vector<Leg>{stop(60.0), {90.0, 0.0, 6.0}, stop(60.0)}, {}, seed);
}

/// Two minutes in the harbour, then at sea: it rolls, and changes its course now and then.
ScenarioDrive ferry(std::uint64_t seed) {
  constexpr double kSails_s = 120.0;
  constexpr double kLands_s = 720.0;
  std::vector<Leg> legs{stop(kSails_s + 10.0)};
  for (int turn = 0; turn < 5; ++turn) {
    legs.push_back({60.0, 0.0, turn % 2 == 0 ? 0.5 : -0.5});
    legs.push_back(stop(60.0));
  }
  legs.push_back(stop(120.0));
  VehicleMotion motion = follow(legs, kPeriod_s);
  for (std::size_t k = 0; k < motion.size(); ++k) {
    const double t_s = static_cast<double>(k) * kPeriod_s;
    if (t_s < kSails_s || t_s > kLands_s) continue;
    const double swell = 1.5 * kRadPerDeg * std::sin(2.0 * std::numbers::pi * t_s / 8.0);
    motion.rate_rad_s[k][0] += swell;
    motion.rate_rad_s[k][1] += 0.4 * swell;
  }
  return record(motion, {}, seed);
}

ScenarioDrive dead_encoder(std::uint64_t seed) {
  ScenarioDrive drive = city(seed);
  cut_wire(drive, 600.0);
  return drive;
}

/// The contact chatters at 10 kHz for 20 s of a stop.
ScenarioDrive bouncing_encoder(std::uint64_t seed) {
  ScenarioDrive drive = record(stops_and_drives(3, 60.0, 60.0), {}, seed);
  std::int64_t chattered = 0;
  for (ScenarioRow& row : drive.rows) {
    if (time_s(row) >= 140.0 && time_s(row) < 160.0) chattered += 96;
    row.row.odometer_pulses += chattered;
  }
  return drive;
}

ScenarioDrive idle_vibration(double frequency_hz, std::uint64_t seed) {
  const double amplitude = 2.0 * std::numbers::sqrt2 * kRadPerDeg;
  return record(stops_and_drives(6, 20.0, 30.0),
                {.disturbance = {PeriodicDisturbance{.amplitude_rad_s = amplitude,
                                                     .frequency_hz = frequency_hz}}},
                seed);
}
ScenarioDrive idle_22_hz(std::uint64_t seed) {
  return idle_vibration(22.5, seed);
}
ScenarioDrive idle_45_hz(std::uint64_t seed) {
  return idle_vibration(45.0, seed);
}

/// The bias drifts by 1.3 deg/s, most of it while the vehicle drives.
ScenarioDrive thermal_bias(std::uint64_t seed) {
  return record(
      std::vector<Leg>{stop(60.0), {600.0, 10.0, 3.0}, stop(60.0)},
      {.bias_dps = {0.3, -0.2, 1.4},
       .drift = {WarmUpTransient{.amplitude_rad_s = -1.3 * kRadPerDeg, .time_constant_s = 200.0}}},
      seed);
}

ScenarioDrive cold_start(std::uint64_t seed) {
  return record(
      stops_and_drives(20, 60.0, 60.0),
      {.drift = {WarmUpTransient{.amplitude_rad_s = 0.05 * kRadPerDeg, .time_constant_s = 600.0}}},
      seed);
}

/// 25 -> 45 -> 30 deg C at the same pace.
double temperature_at(double t_s) {
  constexpr double kHottest_s = 2743.0;
  constexpr double kPace = 20.0 / kHottest_s;
  return t_s < kHottest_s ? 25.0 + kPace * t_s : 45.0 - kPace * (t_s - kHottest_s);
}

ScenarioDrive temperature(std::uint64_t seed) {
  return record(stops_and_drives(20, 60.0, 180.0),
                {.arw_dps_rt_s = kTemperatureArwDpsRtS,
                 .bias_instability_dph = kTemperatureBiasInstabilityDph,
                 .drift = {TemperatureDrift{.linear_rad_s_per_k = 0.03 * kRadPerDeg}},
                 .temperature_degc = temperature_at},
                seed);
}

ScenarioDrive bias_jump(std::uint64_t seed) {
  const std::vector<Leg> legs{
      stop(60.0), {60.0, 10.0, 3.0}, stop(240.0), {60.0, 10.0, 3.0}, stop(30.0)};
  return record(legs, {.drift = {BiasJump{.height_rad_s = 0.5 * kRadPerDeg, .time_s = 180.0}}},
                seed);
}

ScenarioDrive bias_12_dps(std::uint64_t seed) {
  return record(stops_and_drives(3, 30.0, 60.0), {.bias_dps = {-12.0, 4.0, 12.0}}, seed);
}

/// In a tenth of the stops a door slams: 5 deg/s for a second.
ScenarioDrive knocks(std::uint64_t seed) {
  ScenarioDrive drive = record(stops_and_drives(20, 20.0, 40.0), {}, seed);
  for (ScenarioRow& row : drive.rows) {
    const double in_ten_stops_s = std::fmod(time_s(row), 600.0);
    if (in_ten_stops_s < 312.0 || in_ten_stops_s >= 313.0) continue;
    for (float& rate : row.row.rate_rad_s) rate += static_cast<float>(5.0 * kRadPerDeg);
  }
  return drive;
}

ScenarioDrive wild_start(std::uint64_t seed) {
  ScenarioDrive drive = record(stops_and_drives(2, 30.0, 30.0), {}, seed);
  const random::RandomStream wild = random::RandomStream{seed}.substream("wild");
  for (std::size_t k = 0; k < 10; ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double share = wild.uniform(static_cast<std::int64_t>(3 * k + axis)) - 0.5;
      drive.rows[k].row.rate_rad_s[axis] = static_cast<float>(500.0 * kRadPerDeg * share);
    }
  }
  return drive;
}

/// Every twentieth sample is lost, five seconds of each minute, and once a whole minute.
ScenarioDrive gaps(std::uint64_t seed) {
  ScenarioDrive drive = city(seed);
  const random::RandomStream lost = random::RandomStream{seed}.substream("lost");
  std::erase_if(drive.rows, [&](const ScenarioRow& row) {
    const double t_s = time_s(row);
    return lost.uniform(row.row.time_ns) < 0.05 || std::fmod(t_s, 60.0) >= 55.0 ||
           (t_s >= 600.0 && t_s < 660.0);
  });
  return drive;
}

/// A sample of each ten seconds carries a stamp of the past, and once two hundred in a row do.
ScenarioDrive time_backwards(std::uint64_t seed) {
  ScenarioDrive drive = record(stops_and_drives(4, 60.0, 60.0), {}, seed);
  for (std::size_t k = 1000; k < drive.rows.size(); ++k) {
    if (k % 1040 == 0) drive.rows[k].row.time_ns -= 50'000'000;
    if (k >= 20'000 && k < 20'200) drive.rows[k].row.time_ns -= 5'000'000'000;
  }
  return drive;
}

/// After half a minute the sensor's clock runs 2 % fast.
ScenarioDrive rate_off(std::uint64_t seed) {
  ScenarioDrive drive = record(stops_and_drives(6, 60.0, 60.0), {}, seed);
  constexpr std::int64_t kFrom_ns = 30'000'000'000;
  for (ScenarioRow& row : drive.rows) {
    if (row.row.time_ns > kFrom_ns) row.row.time_ns -= (row.row.time_ns - kFrom_ns) / 50;
  }
  return drive;
}

ScenarioDrive no_data_ready(std::uint64_t seed) {
  ScenarioDrive drive = record(stops_and_drives(3, 60.0, 60.0), {}, seed);
  drive.has_data_ready = false;
  return drive;
}

constexpr std::array kScenarios{
    Scenario{"city", "half an hour of stops and drives in town", city},
    Scenario{"motorway", "an hour of long drives at 33 m/s", motorway},
    Scenario{"parking-creep", "a pulse every 3 s, while it turns at 0.25 deg/s", parking_creep},
    Scenario{"slow-turn", "60 s at 1 deg/s between two stops", slow_turn},
    Scenario{"slow-turn-dead-odometer", "the same, and no pulse ever comes",
             slow_turn_dead_odometer},
    Scenario{"carousel", "on a turntable, 90 s at 6 deg/s, no pulses", carousel},
    Scenario{"ferry", "parked on a ship that rolls and changes its course", ferry},
    Scenario{"dead-encoder", "city; the odometer's wire breaks after 10 min", dead_encoder},
    Scenario{"bouncing-encoder", "10 kHz for 20 s of a stop", bouncing_encoder},
    Scenario{"idle-22hz", "an idling engine, 2 deg/s rms at 22.5 Hz", idle_22_hz},
    Scenario{"idle-45hz", "an idling engine, 2 deg/s rms at 45 Hz", idle_45_hz},
    Scenario{"thermal-bias", "a bias that is 1.3 deg/s another at the next stop", thermal_bias},
    Scenario{"cold-start", "a warm-up of 0.05 deg/s with a time constant of 600 s", cold_start},
    Scenario{"temperature", "25, 45, 30 deg C at 0.03 deg/s/K", temperature},
    Scenario{"bias-jump", "0.5 deg/s in the middle of a stop", bias_jump},
    Scenario{"bias-12dps", "biases of -12, 4 and 12 deg/s", bias_12_dps},
    Scenario{"knocks", "5 deg/s for a second in a tenth of the stops", knocks},
    Scenario{"wild-start", "the first ten samples mean nothing", wild_start},
    Scenario{"gaps", "city; samples, seconds and a minute are lost", gaps},
    Scenario{"time-backwards", "stamps of the past, single and two hundred in a row",
             time_backwards},
    Scenario{"rate-off", "2 % more samples a second than nominal", rate_off},
    Scenario{"no-data-ready", "the data-ready wire is broken", no_data_ready},
    Scenario{"dead-band", "traffic; the speed signal is 0 below 0.8 m/s", dead_band},
    Scenario{"inching", "the same in queues, forward bit by bit within the stops", inching},
    Scenario{"parking-turn", "the same, and each creep turns at 2 to 9 deg/s", parking_turn},
    Scenario{"speed-by-can", "dead-band with a new speed once a second", speed_by_can},
    Scenario{"scale-1-percent", "streets; the scale factor is 1 % too large", scale_1_percent},
    Scenario{"mounted-askew", "the same, with a gyro tilted by 5 deg; two antennas", mounted_askew},
    Scenario{"motorway-hour", "no stop for an hour, tunnels; a GNSS course", motorway_hour},
    Scenario{"car-park", "ramps and tight turns without GNSS, streets around", car_park},
    Scenario{"spinning-robot", "spins on the spot, both senses; a mark at stops", spinning_robot},
};

}  // namespace

std::span<const Scenario> scenarios() {
  return kScenarios;
}

const Scenario& find_scenario(std::string_view name) {
  for (const Scenario& scenario : kScenarios) {
    if (scenario.name == name) return scenario;
  }
  std::string names;
  for (const Scenario& scenario : kScenarios) names += " " + std::string(scenario.name);
  throw std::invalid_argument("no scenario \"" + std::string(name) + "\"; there are:" + names);
}

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
