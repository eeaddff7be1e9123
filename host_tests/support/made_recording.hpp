/// @file
/// Recordings made for a test, and what a replay of them said.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <utility>
#include <vector>

#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/recording/writer.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::evaluate::testing {

inline constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;
/// A middling MEMS gyro.
inline constexpr double kArwRadRtS = 0.02 * kRadPerDeg;
inline constexpr double kBiasInstabilityRadS = 20.0 / 3600.0 * kRadPerDeg;

[[nodiscard]] inline model::SensorModel sensor_model() {
  return {.name = "made for a test",
          .white = {.angle_random_walk_rad_per_sqrt_s = kArwRadRtS},
          .flicker = model::Flicker{.bias_instability_rad_s = kBiasInstabilityRadS}};
}

/// Three axes at rest: the model's noise around biases of 0.3, -0.2 and 0.1 deg/s.
[[nodiscard]] inline std::vector<recording::Row> rows_at_rest(std::size_t count, double period_s,
                                                              std::uint64_t seed) {
  std::vector<recording::Row> rows(count);
  const std::array<double, 3> bias_dps{0.3, -0.2, 0.1};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<simulate::Effect> effects{
        simulate::ConstantBias{.bias_rad_s = bias_dps[axis] * kRadPerDeg},
        simulate::WhiteNoise{.angle_random_walk_rad_rt_s = kArwRadRtS},
        simulate::FlickerNoise{.bias_instability_rad_s = kBiasInstabilityRadS}};
    const auto signal = simulate::simulate(simulate::Signal{count, period_s}, effects,
                                           random::RandomStream{seed, axis});
    for (std::size_t k = 0; k < count; ++k) {
      rows[k].rate_rad_s[axis] = static_cast<float>(signal.rate_rad_s[k]);
    }
  }
  const auto period_ns = static_cast<std::int64_t>(period_s * 1e9 + 0.5);
  for (std::size_t k = 0; k < count; ++k)
    rows[k].time_ns = static_cast<std::int64_t>(k) * period_ns;
  return rows;
}

inline std::filesystem::path write_rows(const std::filesystem::path& path,
                                        const recording::Columns& columns,
                                        const std::vector<recording::Row>& rows) {
  recording::Writer writer{path, columns};
  for (const recording::Row& row : rows) writer.write(row);
  writer.finish();
  return path;
}

inline constexpr recording::Columns kRates{3, recording::RateUnit::rad_per_s, false, false, false};

/// A replay and everything that it reported on the way.
struct Replayed {
  ReplayResult result;
  std::vector<app::RateMessage> messages;
  std::vector<char> moving;
  std::vector<ReplayedDrive> drives;
};

[[nodiscard]] inline Replayed replay_file(
    const std::filesystem::path& path, const ReplayOptions& options,
    std::function<std::array<float, 3>(std::uint64_t)> true_rate = {}) {
  Replayed replayed;
  recording::Reader reader{path};
  const ReplayObserver observer{
      .true_rate = std::move(true_rate),
      .on_sample =
          [&](const ReplayedSample& sample) {
            replayed.messages.push_back(sample.message);
            replayed.moving.push_back(sample.moving ? 1 : 0);
          },
      .on_drive = [&](const ReplayedDrive& drive) { replayed.drives.push_back(drive); }};
  replayed.result = replay(reader, options, observer);
  return replayed;
}

}  // namespace zerorate::evaluate::testing
