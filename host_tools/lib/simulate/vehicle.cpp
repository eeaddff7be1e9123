#include "host_tools/lib/simulate/vehicle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace zerorate::simulate {
namespace {

constexpr double kAcceleration = 1.8;  // m/s2, brisk town driving

/// Draws one after another from an addressable stream.
class Draws {
 public:
  explicit Draws(const random::RandomStream& stream) : stream_(stream) {}
  double uniform(double from, double to) { return from + (to - from) * stream_.uniform(next_++); }
  double exponential(double mean) { return -mean * std::log(stream_.uniform(next_++)); }

 private:
  random::RandomStream stream_;
  std::int64_t next_ = 0;
};

/// A half-sine of yaw rate.
struct Turn {
  double start_s = 0.0;
  double length_s = 1.0;
  double peak_rad_s = 0.0;

  [[nodiscard]] double rate(double t_s) const {
    const double phase = (t_s - start_s) / length_s;
    return phase <= 0.0 || phase >= 1.0 ? 0.0 : peak_rad_s * std::sin(std::numbers::pi * phase);
  }
};

/// One drive: a trapezoid of speed, and turns while it lasts.
class SimulatedDrive {
 public:
  SimulatedDrive(const VehicleParams& params, double start_s, double length_s, Draws& draws)
      : start_s_(start_s), length_s_(length_s) {
    cruise_ =
        std::min(params.cruise_speed_m_s * draws.uniform(0.6, 1.4), 0.5 * kAcceleration * length_s);
    for (double t = draws.uniform(1.0, 10.0); t < length_s; t += draws.exponential(20.0)) {
      const double peak = params.peak_turn_rad_s * draws.uniform(-1.0, 1.0);
      turns_.push_back({t, draws.uniform(3.0, 8.0), peak});
      t += turns_.back().length_s;
    }
  }

  [[nodiscard]] double speed(double t_s) const {
    const double since = t_s - start_s_;
    const double left = start_s_ + length_s_ - t_s;
    return std::max(0.0, std::min({cruise_, kAcceleration * since, kAcceleration * left}));
  }

  [[nodiscard]] std::array<double, 3> rate(double t_s) const {
    const double since = t_s - start_s_;
    double yaw = 0.0;
    for (const Turn& turn : turns_) yaw += turn.rate(since);
    yaw *= cruise_ > 0.0 ? speed(t_s) / cruise_ : 0.0;
    const double rock = rocking(since - length_s_);
    // The body leans out of a turn and nods over the road.
    return {0.05 * yaw,
            0.004 * std::sin(2.0 * std::numbers::pi * 1.3 * since) * speed(t_s) / 14.0 + rock, yaw};
  }

 private:
  /// Pitch after the brakes have brought the wheels to rest.
  [[nodiscard]] static double rocking(double since_stop_s) {
    if (since_stop_s < 0.0) return 0.0;
    return 0.03 * std::exp(-since_stop_s / 0.2) *
           std::cos(2.0 * std::numbers::pi * 1.6 * since_stop_s);
  }

  double start_s_;
  double length_s_;
  double cruise_ = 0.0;
  std::vector<Turn> turns_;
};

}  // namespace

VehicleMotion simulate_vehicle(const VehicleParams& params, double sample_period_s,
                               const random::RandomStream& stream) {
  Draws draws(stream.substream("vehicle"));
  VehicleMotion motion{
      .sample_period_s = sample_period_s, .rate_rad_s = {}, .speed_m_s = {}, .odometer_pulses = {}};
  // A trip begins with some time at the kerb.
  double next_drive_s = params.mean_stop_s + draws.exponential(params.mean_stop_s);
  SimulatedDrive drive(params, -1e9, 0.0, draws);
  double distance_m = 0.0;
  const auto samples = static_cast<std::size_t>(params.duration_s / sample_period_s);
  for (std::size_t k = 0; k < samples; ++k) {
    const double t = static_cast<double>(k) * sample_period_s;
    if (t >= next_drive_s) {
      // Shorter than 10 s is no drive.
      const double length_s = 10.0 + draws.exponential(params.mean_drive_s - 10.0);
      drive = SimulatedDrive(params, t, length_s, draws);
      next_drive_s = t + length_s + 3.0 + draws.exponential(params.mean_stop_s);
    }
    distance_m += drive.speed(t) * sample_period_s;
    motion.rate_rad_s.push_back(drive.rate(t));
    motion.speed_m_s.push_back(drive.speed(t));
    motion.odometer_pulses.push_back(
        static_cast<std::int64_t>(distance_m / params.metres_per_pulse));
  }
  return motion;
}

}  // namespace zerorate::simulate
