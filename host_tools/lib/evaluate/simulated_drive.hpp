/// @file
/// Simulated recordings whose truth is known: of a gyro on a vehicle, and of a gyro at rest.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/recording/input.hpp"
#include "host_tools/lib/simulate/simulate.hpp"
#include "host_tools/lib/simulate/vehicle.hpp"

namespace zerorate::evaluate {

struct SimulatedDriveParams {
  model::SensorModel model;  ///< its white noise and 1/f noise are simulated
  double duration_s = 7200.0;
  double sample_rate_hz = 104.0;
  std::uint64_t seed = 1;
  /// Effects that the model does not know, added to the yaw axis.
  std::vector<simulate::Effect> hidden{};
};

/// An effect that the model lacks: a tone of a minute or so, like the beat of a gyro's drive with
/// that of its neighbour. Eight times the 1/f noise, so that half an hour at rest shows it.
[[nodiscard]] simulate::Effect draw_hidden_tone(const model::SensorModel& model,
                                                const random::RandomStream& stream);

class SimulatedDrive {
 public:
  SimulatedDrive(simulate::VehicleMotion motion, std::array<std::vector<double>, 3> rest_rate_rad_s)
      : motion_(std::move(motion)), rest_rate_rad_s_(std::move(rest_rate_rad_s)) {}

  [[nodiscard]] double sample_period_s() const { return motion_.sample_period_s; }
  [[nodiscard]] std::array<float, 3> true_rate_rad_s(std::uint64_t row) const;
  /// Rate that the gyro would have read without any motion: bias and noise.
  [[nodiscard]] std::span<const double> rest_rate_rad_s(std::size_t axis) const {
    return rest_rate_rad_s_[axis];
  }
  /// Writes a recording with odometer pulses. Throws recording::Error.
  void write(const std::filesystem::path& path) const;
  /// The yaw axis as it would have been recorded with the vehicle parked for so long, or for the
  /// length of the drive. Throws recording::Error.
  void write_parked(const std::filesystem::path& path, double duration_s) const;

 private:
  simulate::VehicleMotion motion_;
  std::array<std::vector<double>, 3> rest_rate_rad_s_;
};

/// Each axis has its own noise and a constant bias of the order of 1 deg/s.
[[nodiscard]] SimulatedDrive simulate_drive(const SimulatedDriveParams& params);

struct SimulatedRestParams {
  model::SensorModel model;  ///< its white noise and flicker noise are simulated
  double duration_s = 7200.0;
  double sample_rate_hz = 20.0;
  std::uint64_t seed = 1;
};

/// Rates of three axes at rest [rad/s], as write_simulated_rest() writes them.
[[nodiscard]] std::array<std::vector<double>, 3> simulate_rest(const SimulatedRestParams& params);

/// Writes a recording of three axes at rest. Each has its own noise and a constant bias of the
/// order of 1 deg/s. Throws recording::Error.
void write_simulated_rest(const SimulatedRestParams& params, const std::filesystem::path& path);

/// One axis of a recording made at rest, complete in memory.
struct RestRecording {
  std::vector<double> rate_rad_s;
  double sample_period_s = 0.0;  ///< the mean interval, holes left out
};

/// Leaves out the rows whose rate is lost. Throws recording::Error.
[[nodiscard]] RestRecording read_at_rest(const recording::Input& input, std::size_t axis);

}  // namespace zerorate::evaluate
