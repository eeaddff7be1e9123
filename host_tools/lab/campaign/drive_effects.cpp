#include "host_tools/lab/campaign/drive_effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "host_tools/lib/units/units.hpp"

namespace zerorate::campaign {
namespace {

using sizing::Draws;
using units::kRadPerDeg;

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kRowsPerSecond = 25.0;

/// Adds an angle to the reference's heading in a row.
void turn_reference(simulate::ScenarioRow& row, double by_rad) {
  row.row.ref_heading_rad =
      static_cast<float>(std::remainder(double{row.row.ref_heading_rad} + by_rad, kTurn_rad));
}

double hours_share(const Hour& hour, std::size_t row) {
  return static_cast<double>(row) / static_cast<double>(hour.drive.rows.size());
}

/// The scale factor follows a temperature that falls, by the size over all of the hour.
void let_scale_follow_temperature(Hour& hour, double size) {
  for (std::size_t k = 0; k < hour.drive.rows.size(); ++k) {
    const double error = size * std::cos(kTurn_rad * 1.5 * hours_share(hour, k));
    hour.drive.rows[k].row.rate_rad_s[2] +=
        static_cast<float>(error * hour.motion.rate_rad_s[k][2]);
  }
}

/// The reference's heading swings with a period of eight minutes.
void let_reference_breathe(Hour& hour, double size) {
  constexpr double kPeriod_s = 480.0;
  for (std::size_t k = 0; k < hour.drive.rows.size(); ++k) {
    const double time_s = static_cast<double>(k) / kRowsPerSecond;
    turn_reference(hour.drive.rows[k], size * std::sin(kTurn_rad * time_s / kPeriod_s));
  }
}

/// Iron that turns with the vehicle: the reference errs with the heading and twice the heading.
void disturb_magnetically(Hour& hour, double size) {
  for (simulate::ScenarioRow& row : hour.drive.rows) {
    const double heading = row.true_heading_rad;
    turn_reference(row, size * (std::sin(heading) - 1.0 + std::cos(2.0 * heading + 0.7)));
  }
}

/// On the way the bias remembers the sense of the last turn.
void let_bias_remember(Hour& hour, double size) {
  constexpr double kFast_rad_s = 10.0 * kRadPerDeg;
  double sense = 0.0;
  for (std::size_t k = 0; k < hour.drive.rows.size(); ++k) {
    const double turn_rad_s = hour.motion.turn_rad_s[k];
    if (std::abs(turn_rad_s) > kFast_rad_s) sense = std::copysign(1.0, turn_rad_s);
    if (!(hour.motion.speed_m_s[k] > 0.0)) sense = 0.0;
    hour.drive.rows[k].row.rate_rad_s[2] += static_cast<float>(size * sense);
  }
}

/// Rows from a departure to the next arrival.
struct Way {
  std::size_t from = 0;
  std::size_t to = 0;
};

/// Two to five ways at random, none twice.
std::vector<Way> some_ways(const Hour& hour, Draws& draws) {
  std::vector<Way> all;
  for (std::size_t k = 1; k < hour.motion.speed_m_s.size(); ++k) {
    const bool moves = hour.motion.speed_m_s[k] > 0.0;
    if (moves && !(hour.motion.speed_m_s[k - 1] > 0.0)) all.push_back({k, k});
    if (moves) all.back().to = k;
  }
  const auto count = static_cast<std::size_t>(draws.uniform(2.0, 6.0));
  std::vector<Way> some;
  while (some.size() < count && !all.empty()) {
    const auto place =
        static_cast<std::ptrdiff_t>(draws.uniform(0.0, static_cast<double>(all.size())));
    some.push_back(all[static_cast<std::size_t>(place)]);
    all.erase(all.begin() + place);
  }
  return some;
}

std::size_t fastest_row(const Hour& hour, const Way& way) {
  const auto first = hour.motion.turn_rad_s.begin();
  const auto found = std::max_element(first + static_cast<std::ptrdiff_t>(way.from),
                                      first + static_cast<std::ptrdiff_t>(way.to),
                                      [](double a, double b) { return std::abs(a) < std::abs(b); });
  return static_cast<std::size_t>(found - first);
}

std::string delay(Hour& hour, Draws& draws) {
  const double delay_s = draws.uniform(0.1, 1.2);
  const auto rows = static_cast<std::size_t>(std::lround(delay_s * kRowsPerSecond));
  auto& all = hour.drive.rows;
  for (std::size_t k = all.size(); k-- > rows;) {
    all[k].row.ref_heading_rad = all[k - rows].row.ref_heading_rad;
  }
  return fmt::format("{:.2f} s", delay_s);
}

std::string jump(Hour& hour, Draws& draws) {
  const double size_rad = draws.uniform(2.0, 20.0) * kRadPerDeg;
  for (const Way& way : some_ways(hour, draws)) {
    const double from = draws.uniform(static_cast<double>(way.from), static_cast<double>(way.to));
    for (auto k = static_cast<std::size_t>(from); k < hour.drive.rows.size(); ++k) {
      turn_reference(hour.drive.rows[k], size_rad);
    }
  }
  return fmt::format("jumps of {:.1f} deg", size_rad / kRadPerDeg);
}

std::string turn_over(Hour& hour, Draws& draws) {
  for (const Way& way : some_ways(hour, draws)) {
    const double before = hour.drive.rows[way.from].true_heading_rad;
    const double all = hour.drive.rows[way.to].true_heading_rad - before;
    for (std::size_t k = way.from; k < hour.drive.rows.size(); ++k) {
      const double turned = k < way.to ? hour.drive.rows[k].true_heading_rad - before : all;
      turn_reference(hour.drive.rows[k], -2.0 * turned);
    }
  }
  return "wrong sign";
}

std::string freeze(Hour& hour, Draws& draws) {
  const double length_s = draws.uniform(3.0, 8.0);
  const auto half = static_cast<std::size_t>(0.5 * length_s * kRowsPerSecond);
  for (const Way& way : some_ways(hour, draws)) {
    const std::size_t middle = std::max(fastest_row(hour, way), half);
    for (std::size_t k = middle - half; k < middle + half && k < hour.drive.rows.size(); ++k) {
      hour.drive.rows[k].row.ref_heading_rad = hour.drive.rows[middle - half].row.ref_heading_rad;
    }
  }
  return fmt::format("frozen for {:.1f} s", length_s);
}

std::string lose_rows(Hour& hour, Draws& draws) {
  const double length_s = draws.uniform(0.3, 1.5);
  const auto rows = static_cast<std::size_t>(length_s * kRowsPerSecond);
  for (const Way& way : some_ways(hour, draws)) {
    const std::size_t from = fastest_row(hour, way);
    for (std::size_t k = from; k < from + rows && k < hour.drive.rows.size(); ++k)
      hour.drive.rows[k].row.time_ns = -1;
  }
  std::erase_if(hour.drive.rows,
                [](const simulate::ScenarioRow& row) { return row.row.time_ns < 0; });
  return fmt::format("gaps of {:.1f} s", length_s);
}

std::string clip(Hour& hour, Draws& draws) {
  double most = 0.0;
  for (const double rate : hour.motion.turn_rad_s) most = std::max(most, std::abs(rate));
  const double share = draws.uniform(0.6, 0.95);
  const auto limit = static_cast<float>(share * most);
  for (simulate::ScenarioRow& row : hour.drive.rows) {
    for (float& rate : row.row.rate_rad_s) rate = std::clamp(rate, -limit, limit);
  }
  return fmt::format("full scale {:.2f} of the fastest turn", share);
}

}  // namespace

std::span<const SizedDriveEffect> drive_effects() {
  static const std::array<SizedDriveEffect, 5> kEffects{{
      {.name = "scale_factor",
       .figure = "scale_factor_error_percent",
       .unit = 0.01,
       .first = 0.005,
       .make =
           [](HourOptions& hour, double size) {
             hour.errors.scale_factor = {size, size, size};
           }},
      {.name = "scale_asymmetry",
       .figure = "scale_asymmetry_percent",
       .unit = 0.01,
       .first = 0.002,
       .make =
           [](HourOptions& hour, double size) {
             hour.errors.asymmetry = {size, size, size};
           }},
      {.name = "bias_in_motion",
       .figure = "offset_at_10_mps_dps",
       .unit = kRadPerDeg,
       .first = 0.01 * kRadPerDeg,
       .make =
           [](HourOptions& hour, double size) {
             hour.errors.offset_rad_s = {size, size, size};
           }},
      {.name = "misalignment",
       .figure = "tilt_deg",
       .unit = kRadPerDeg,
       .first = 5.0 * kRadPerDeg,
       .power = 2.0,
       .make = [](HourOptions& hour,
                  double size) { hour.errors.mounting.roll_rad += std::abs(size); }},
      {.name = "g_sensitivity",
       .figure = "along_y_dps_per_g",
       .unit = kRadPerDeg,
       .first = 0.2 * kRadPerDeg,
       .make =
           [](HourOptions& hour, double size) {
             hour.per_g_rad_s = {size, size, size};
           }},
  }};
  return kEffects;
}

std::span<const SizedDriveEffect> drive_effects_outside() {
  static const std::array<SizedDriveEffect, 4> kEffects{{
      {.name = "scale_by_temperature", .first = 0.01, .change = let_scale_follow_temperature},
      {.name = "reference_breathes", .first = kRadPerDeg, .change = let_reference_breathe},
      {.name = "magnetic_disturbance", .first = kRadPerDeg, .change = disturb_magnetically},
      {.name = "hysteresis_of_turns", .first = 0.01 * kRadPerDeg, .change = let_bias_remember},
  }};
  return kEffects;
}

std::span<const DriveFault> drive_faults() {
  static const std::array<DriveFault, 6> kFaults{{
      {"reference_delay", delay},
      {"reference_fault", jump},
      {"reference_fault", turn_over},
      {"reference_fault", freeze},
      {"gap_in_turn", lose_rows},
      {"saturation_in_turn", clip},
  }};
  return kFaults;
}

}  // namespace zerorate::campaign
