/// @file
/// A scenario by its name, through the simulated chip, its driver and the node.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/model/catalogue.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/recording/writer.hpp"
#include "host_tools/lib/simulate/scenario.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace zerorate::scenario {

inline constexpr double kDps = 3.14159265358979323846 / 180.0;
inline constexpr std::size_t kYaw = 2;
/// How far the bias of a sound node may be off: five standard deviations of four decades of 1/f
/// noise with a floor of 5 deg/h, 5 * 1.289 * 5 * sqrt(4) deg/h.
inline constexpr double kWanderDps = 0.018;

/// Puts the mean over the second around it in the place of each row's bias: the quickest part of
/// the 1/f noise averages out within any drive, and no node tries to predict it.
inline void smooth_biases(std::vector<simulate::ScenarioRow>& rows) {
  constexpr std::size_t kHalf = 52;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> sum{0.0};
    for (const auto& row : rows) sum.push_back(sum.back() + double{row.bias_rad_s[axis]});
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const std::size_t from = k < kHalf ? 0 : k - kHalf;
      const std::size_t to = std::min(k + kHalf, rows.size());
      rows[k].bias_rad_s[axis] =
          static_cast<float>((sum[to] - sum[from]) / static_cast<double>(to - from));
    }
  }
}

/// Messages of the node at each row of a scenario.
struct Played {
  simulate::ScenarioDrive drive;
  evaluate::ReplayResult result;
  std::vector<app::RateMessage> messages;
  std::vector<evaluate::ReplayedDrive> drives;

  [[nodiscard]] double time_s(std::size_t row) const {
    return static_cast<double>(drive.rows[row].row.time_ns) * 1e-9;
  }
  /// Error of the published bias about an axis [deg/s].
  [[nodiscard]] double error_dps(std::size_t row, std::size_t axis = kYaw) const {
    const double bias = double{messages[row].axes[axis].bias.in(core::rad_per_s)};
    return std::abs(bias - double{drive.rows[row].bias_rad_s[axis]}) / kDps;
  }
  /// The rows within a span of time.
  template <class Visit>
  void between(double from_s, double to_s, Visit visit) const {
    for (std::size_t row = 0; row < messages.size(); ++row) {
      if (time_s(row) >= from_s && time_s(row) < to_s) visit(row);
    }
  }
  /// The largest error of any axis within a span of time [deg/s].
  [[nodiscard]] double worst_dps(double from_s, double to_s) const {
    double worst = 0.0;
    between(from_s, to_s, [&](std::size_t row) {
      for (std::size_t axis = 0; axis < 3; ++axis) worst = std::max(worst, error_dps(row, axis));
    });
    return worst;
  }
  /// The mean error about z within a span of time [deg/s].
  [[nodiscard]] double mean_dps(double from_s, double to_s) const {
    double sum = 0.0;
    double rows = 0.0;
    between(from_s, to_s, [&](std::size_t row) {
      sum += double{messages[row].axes[kYaw].bias.in(core::rad_per_s)} -
             double{drive.rows[row].bias_rad_s[kYaw]};
      ++rows;
    });
    return sum / rows / kDps;
  }
  [[nodiscard]] bool disagrees(double at_s) const {
    bool disagrees = false;
    between(at_s, at_s + 0.015,
            [&](std::size_t row) { disagrees = messages[row].health.odometer_disagreement; });
    return disagrees;
  }
  [[nodiscard]] std::size_t samples(core::Motion motion, double from_s, double to_s) const {
    std::size_t samples = 0;
    between(from_s, to_s,
            [&](std::size_t row) { samples += messages[row].motion == motion ? 1U : 0U; });
    return samples;
  }
};

[[nodiscard]] inline model::SensorModel lsm6dso() {
  return model::find_model("lsm6dso");
}

/// Whether true drives are scored against the scenario's reference too.
enum class Scored : bool { no, against_reference };

/// @param references that the node learns from
[[nodiscard]] inline Played play(simulate::ScenarioDrive scenario, const model::SensorModel& model,
                                 Scored scored = Scored::no,
                                 const std::optional<evaluate::ReferenceUse>& references = {}) {
  Played played{.drive = std::move(scenario), .result = {}, .messages = {}, .drives = {}};
  const zerorate::testing::ScratchFolder folder;
  const auto path = folder.path() / "scenario.csv";
  recording::Writer writer{path, played.drive.columns};
  for (const auto& row : played.drive.rows) writer.write(row.row);
  writer.finish();
  std::optional<truth::Truth> truth;
  if (scored == Scored::against_reference) {
    recording::Reader track{path};
    truth = truth::find_truth(truth::read_track(track), {.vertical = truth::VerticalAxis{}});
  }
  recording::Reader reader{path};
  const evaluate::ReplayObserver observer{
      .true_rate = [&](std::uint64_t row) { return played.drive.rows[row].true_rate_rad_s; },
      .truth = std::move(truth),
      .on_sample =
          [&](const evaluate::ReplayedSample& sample) {
            played.messages.push_back(sample.message);
          },
      .on_drive = [&](const evaluate::ReplayedDrive& drive) { played.drives.push_back(drive); },
      .on_progress = {}};
  played.result = evaluate::replay(reader,
                                   {.model = model,
                                    .through = evaluate::Through::chip,
                                    .has_data_ready = played.drive.has_data_ready,
                                    .references = references},
                                   observer);
  smooth_biases(played.drive.rows);
  return played;
}

/// @param seed of the vehicle and of the gyro
[[nodiscard]] inline Played play(std::string_view name, const model::SensorModel& model = lsm6dso(),
                                 std::uint64_t seed = 1) {
  return play(simulate::find_scenario(name).make(seed), model);
}

}  // namespace zerorate::scenario
