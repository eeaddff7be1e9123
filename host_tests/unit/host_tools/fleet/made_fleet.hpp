/// @file
/// Fleets whose likelihoods are made by hand.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

#include "host_tools/lib/fleet/analysis.hpp"
#include "host_tools/lib/fleet/database.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::fleet {

/// Population that the made fleets are drawn from: ln N, ln of the amplitude at the pivot, d.
inline constexpr double kLogWhite = -9.0;
inline constexpr double kLogWhiteSpread = 0.15;
inline constexpr double kLogAmplitude = 0.4;
inline constexpr double kLogAmplitudeSpread = 0.3;
inline constexpr double kOrder = 0.55;
inline constexpr double kOrderSpread = 0.06;

/// Errors of the measured ln amplitude and d.
inline constexpr double kAmplitudeError = 0.3;
inline constexpr double kOrderError = 0.08;

/// Coordinates of an axis: ln N, ln of the amplitude at the pivot, d.
using Coordinates = std::array<double, 3>;

/// Axis whose likelihood is normal about the measured coordinates.
[[nodiscard]] inline AxisResult made_axis(const std::string& name, const Coordinates& measured,
                                          std::size_t innovations) {
  const auto& [white, amplitude, order] = measured;
  AxisResult axis{
      .axis = name,
      .angle_random_walk_rad_per_sqrt_s = std::exp(white),
      .bias_instability_rad_s = std::exp(white + amplitude + order * std::log(Grid::kPivot_rad_s)),
      .verdict = "consistent",
      .innovations = innovations};
  for (std::size_t i = 0; i < Grid::kOrders; ++i) {
    for (std::size_t j = 0; j < Grid::kAmplitudes; ++j) {
      const double of_amplitude = (Grid::log_amplitude(j) - amplitude) / kAmplitudeError;
      const double of_order = (Grid::order(i) - order) / kOrderError;
      axis.log_likelihood.push_back(
          static_cast<float>(-0.5 * (of_amplitude * of_amplitude + of_order * of_order)));
      axis.white.push_back(static_cast<float>(std::exp(white)));
    }
  }
  return axis;
}

struct MadeFleet {
  std::size_t sensors = 400;
  std::size_t recordings = 1;
  std::size_t lots = 10;
  std::set<std::size_t> bad_lots = {};
  double bad_lot_shift = 0.0;  ///< shift of ln N, and with it of ln B, in the bad lots
  double common_share = 0.0;   ///< share of the variance that the axes of a sensor have in common
  bool one_changes = false;    ///< the second recording of sensor 7
  bool one_jumps = true;       ///< bias jump of sensor 3
  std::size_t innovations = 2000;
  std::uint64_t seed = 2026;
};

/// Measured coordinates of an axis of a recording.
[[nodiscard]] inline Coordinates measured_axis(const MadeFleet& fleet, std::size_t sensor,
                                               std::size_t recording, std::int64_t axis) {
  const random::RandomStream stream{fleet.seed};
  const random::RandomStream truth = stream.substream(sensor);
  const random::RandomStream error = stream.substream(1'000'000 + 10 * sensor + recording);
  const std::size_t lot = sensor * fleet.lots / fleet.sensors;
  const double shift = fleet.bad_lots.contains(lot) ? fleet.bad_lot_shift : 0.0;
  const double change = fleet.one_changes && sensor == 7 && recording == 1 ? 1.5 : 0.0;
  const double white_error = std::sqrt(0.5 / static_cast<double>(fleet.innovations));
  const std::int64_t k = 3 * axis;
  const auto deviation = [&](std::int64_t coordinate) {
    constexpr std::int64_t kOfSensor = 100;
    return std::sqrt(fleet.common_share) * truth.normal(kOfSensor + coordinate) +
           std::sqrt(1.0 - fleet.common_share) * truth.normal(k + coordinate);
  };
  return {kLogWhite + shift + kLogWhiteSpread * deviation(0) + white_error * error.normal(k),
          kLogAmplitude + change + kLogAmplitudeSpread * deviation(1) +
              kAmplitudeError * error.normal(k + 1),
          kOrder + kOrderSpread * deviation(2) + kOrderError * error.normal(k + 2)};
}

/// @return a database of the fleet, in which sensor 3 has a bias jump unless none is asked for
[[nodiscard]] inline Database made_fleet(const std::filesystem::path& path,
                                         const MadeFleet& fleet) {
  Database database{path, Database::Access::write};
  for (std::size_t s = 0; s < fleet.sensors; ++s) {
    const std::size_t lot = s * fleet.lots / fleet.sensors;
    for (std::size_t r = 0; r < fleet.recordings; ++r) {
      StoredRecording one{.hash = "h" + std::to_string(1000 * s + r)};
      one.entry = {.name = std::to_string(s) + "-" + std::to_string(r),
                   .sensor = std::to_string(s),
                   .lot = "L" + std::to_string(lot)};
      one.result.rest_s = 1000.0;
      for (std::int64_t a = 0; a < 3; ++a) {
        one.result.axes.push_back(
            made_axis(std::string(1, "xyz"[a]), measured_axis(fleet, s, r, a), fleet.innovations));
      }
      if (s == 3 && fleet.one_jumps) {
        one.result.axes[1].verdict = "explained";
        one.result.axes[1].causes.push_back(
            {.effect = "bias_jump", .gain_nats = 40.0, .p_value = 1e-12});
      }
      database.store(one);
    }
  }
  return database;
}

}  // namespace zerorate::fleet
