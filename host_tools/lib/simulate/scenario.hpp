/// @file
/// Drives that go wrong, by name: what the vehicle does, what its gyro gives, and what is true.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "host_tools/lib/recording/row.hpp"
#include "host_tools/lib/simulate/gyro_in_motion.hpp"
#include "host_tools/lib/simulate/heading_references.hpp"
#include "host_tools/lib/simulate/simulate.hpp"
#include "host_tools/lib/simulate/vehicle.hpp"

namespace zerorate::simulate {

/// A row of a recording, and what nobody but the simulator knows about it.
struct ScenarioRow {
  recording::Row row;
  std::array<float, 3> true_rate_rad_s{};  ///< rate of the vehicle about its own axes
  /// Bias of the gyro: all that is slow and not motion, its offset in motion included.
  std::array<float, 3> bias_rad_s{};
  double true_heading_rad = 0.0;  ///< since the start, about the vertical, whole turns included
};

struct ScenarioDrive {
  recording::Columns columns;  ///< without accelerations, which a caller may add
  std::vector<ScenarioRow> rows;
  /// Headings in the column ref_heading_deg; empty: that column has the true heading in each row.
  std::vector<SensedHeading> references{};
  bool has_data_ready = true;  ///< false: the pin's wire is broken
};

/// One axis' noise of every scenario but `temperature`: the figures of the catalogue's `lsm6dso`.
inline constexpr double kScenarioArwDpsRtS = 0.00269;
inline constexpr double kScenarioBiasInstabilityDph = 5.0;

/// White noise of the scenario `temperature`, which has a better sensor.
inline constexpr double kTemperatureArwDpsRtS = 0.005;
inline constexpr double kTemperatureBiasInstabilityDph = 2.0;

struct Scenario {
  std::string_view name;
  std::string_view summary;
  ScenarioDrive (*make)(std::uint64_t seed);
};

/// All of them, in the order in which they are listed.
[[nodiscard]] std::span<const Scenario> scenarios();

/// Throws std::invalid_argument that lists the names.
[[nodiscard]] const Scenario& find_scenario(std::string_view name);

/// Half an hour in town with the odometer of a car.
[[nodiscard]] ScenarioDrive dead_band(std::uint64_t seed);
/// In queues: several moves forward within a stop, some of them in a bend.
[[nodiscard]] ScenarioDrive inching(std::uint64_t seed);
/// Manoeuvres: each creep turns as tightly as a car can.
[[nodiscard]] ScenarioDrive parking_turn(std::uint64_t seed);
/// The drive of dead_band(), with a speed message once a second.
[[nodiscard]] ScenarioDrive speed_by_can(std::uint64_t seed);

inline constexpr double kScenarioPeriod_s = 1.0 / 104.0;

/// Particulars of the gyro of a scenario.
struct ScenarioGyro {
  std::array<double, 3> bias_dps{0.3, -0.2, 0.1};
  double arw_dps_rt_s = kScenarioArwDpsRtS;
  double bias_instability_dph = kScenarioBiasInstabilityDph;
  std::vector<Effect> drift{};        ///< drift of the bias about z
  std::vector<Effect> disturbance{};  ///< disturbance of the measurement about every axis
  MotionErrors errors{};              ///< errors that rest does not show
  std::function<double(double)> temperature_degc{};  ///< at a time in seconds; none: no thermometer
};

/// The gyro on the vehicle, its odometer, and the motion's own heading, rate and speed as
/// reference.
[[nodiscard]] ScenarioDrive record(const VehicleMotion& motion, const ScenarioGyro& gyro,
                                   std::uint64_t seed);

/// Puts headings of a source in the place of the true ones: each stands in the first row at or
/// after its time, and all other rows have none.
/// @param headings in order of time
void show_references(std::vector<SensedHeading> headings, ScenarioDrive& drive);

}  // namespace zerorate::simulate
