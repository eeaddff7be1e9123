#include "host_tools/lib/simulate/vehicle.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "host_tools/lib/simulate/draws.hpp"
#include "host_tools/lib/simulate/require.hpp"
#include "host_tools/lib/simulate/tilt.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::simulate {

namespace {

constexpr double kAcceleration = 1.8;  // m/s2, brisk town driving

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
class VehicleDrive {
 public:
  VehicleDrive(const VehicleParams& params, double start_s, double length_s, Draws& draws)
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
  VehicleMotion motion{.sample_period_s = sample_period_s};
  // A trip begins with some time at the kerb.
  double next_drive_s = params.mean_stop_s + draws.exponential(params.mean_stop_s);
  VehicleDrive drive(params, -1e9, 0.0, draws);
  double distance_m = 0.0;
  const auto samples = static_cast<std::size_t>(params.duration_s / sample_period_s);
  for (std::size_t k = 0; k < samples; ++k) {
    const double t = static_cast<double>(k) * sample_period_s;
    if (t >= next_drive_s) {
      // Shorter than 10 s is no drive.
      const double length_s = 10.0 + draws.exponential(params.mean_drive_s - 10.0);
      drive = VehicleDrive(params, t, length_s, draws);
      next_drive_s = t + length_s + 3.0 + draws.exponential(params.mean_stop_s);
    }
    distance_m += drive.speed(t) * sample_period_s;
    motion.rate_rad_s.push_back(drive.rate(t));
    motion.turn_rad_s.push_back(motion.rate_rad_s.back()[2]);
    motion.speed_m_s.push_back(drive.speed(t));
    motion.odometer_pulses.push_back(
        static_cast<std::int64_t>(distance_m / params.metres_per_pulse));
  }
  return motion;
}

namespace {

constexpr double kFirstStop_s = 30.0;
constexpr double kGathered_m_s = 2.0;
constexpr double kBend_dps = 12.0;  // the peak of a bend at cruising speed

class Driver {
 public:
  Driver(const DriverParams& params, const random::RandomStream& stream)
      : params_(params), stream_(stream.substream("driver")) {}

  std::vector<Leg> drive() {
    stand(kFirstStop_s);
    while (time_s_ < params_.duration_s) {
      pull_away();
      cruise();
      come_to_rest();
      wait();
    }
    return legs_;
  }

 private:
  // Two draws in one expression or call come in an order that the compiler chooses: each has a
  // name.
  double uniform() { return stream_.uniform(next_++); }
  double around(double value) { return value * (0.6 + 0.8 * uniform()); }
  double exponential(double mean) { return -mean * std::log(uniform()); }
  bool happens(double share) { return uniform() < share; }

  /// Changes speed with an acceleration, then holds it for a time.
  void go(double held_s, double speed_m_s, double turn_dps, double acceleration_m_s2) {
    const double before_m_s = legs_.empty() ? 0.0 : legs_.back().speed_m_s;
    const double ramp_s = std::max(0.2, std::abs(speed_m_s - before_m_s) / acceleration_m_s2);
    legs_.push_back({.length_s = ramp_s + held_s,
                     .speed_m_s = speed_m_s,
                     .turn_dps = turn_dps,
                     .ramp_s = ramp_s});
    time_s_ += ramp_s + held_s;
  }

  void stand(double length_s) { go(length_s, 0.0, 0.0, around(params_.brakes_with_m_s2)); }

  void creep() {
    const double speed_m_s = around(params_.creep_speed_m_s);
    const double acceleration_m_s2 = around(params_.pulls_away_with_m_s2);
    const double bend_dps = turn_dps(speed_m_s);
    const double held_s = around(params_.creep_s);
    go(held_s, speed_m_s, bend_dps, acceleration_m_s2);
  }

  /// Yaw rate in a bend at random.
  double turn_dps(double speed_m_s) {
    const double side = happens(0.5) ? 1.0 : -1.0;
    const double radius_m = params_.tightest_bend_m *
                            std::pow(params_.widest_bend_m / params_.tightest_bend_m, uniform());
    return side * speed_m_s / radius_m * units::kDegPerRad;
  }

  /// Maybe with a creep, and in a bend until it has gathered speed.
  void pull_away() {
    if (happens(params_.creeping_share)) creep();
    const double acceleration_m_s2 = around(params_.pulls_away_with_m_s2);
    const double bend_dps = turn_dps(kGathered_m_s);
    go(0.0, kGathered_m_s, bend_dps, acceleration_m_s2);
  }

  void cruise() {
    const double speed_m_s = around(params_.cruise_speed_m_s);
    const double bend_dps = kBend_dps * (2.0 * uniform() - 1.0);
    const double held_s = exponential(params_.mean_drive_s);
    go(0.5 * held_s, speed_m_s, 0.0, around(params_.pulls_away_with_m_s2));
    go(4.0, speed_m_s, bend_dps, params_.pulls_away_with_m_s2);
    go(0.5 * held_s, speed_m_s, 0.0, params_.pulls_away_with_m_s2);
  }

  void come_to_rest() {
    if (!happens(params_.creeping_share)) return;
    go(0.0, params_.creep_speed_m_s, 0.0, around(params_.brakes_with_m_s2));
    creep();
  }

  /// A stop, and as many moves forward within it as chance gives.
  void wait() {
    const double share = params_.inches_per_stop / (1.0 + params_.inches_per_stop);
    stand(2.0 + exponential(params_.mean_stop_s));
    while (happens(share)) {
      creep();
      stand(2.0 + exponential(params_.mean_stop_s));
    }
  }

  DriverParams params_;
  random::RandomStream stream_;
  std::int64_t next_ = 0;
  double time_s_ = 0.0;
  std::vector<Leg> legs_;
};

}  // namespace

std::vector<Leg> drive_in_traffic(const DriverParams& params, const random::RandomStream& stream) {
  return Driver{params, stream}.drive();
}

VehicleMotion follow(std::span<const Leg> legs, double sample_period_s, double metres_per_pulse) {
  constexpr double kLean_rad_per_m_s2 =
      5.0 * units::kRadPerDeg / units::kGravity_m_s2;  // 5 deg per g
  using units::kRadPerDeg;
  VehicleMotion motion{.sample_period_s = sample_period_s};
  Tilt tilt_before;
  Leg before = legs.front();
  double distance_m = 0.0;
  double start_s = 0.0;
  for (const Leg& leg : legs) {
    for (;;) {
      const double t_s = static_cast<double>(motion.size()) * sample_period_s;
      if (t_s >= start_s + leg.length_s) break;
      const double share = std::min(1.0, (t_s - start_s) / leg.ramp_s);
      const double speed = std::lerp(before.speed_m_s, leg.speed_m_s, share);
      const double yaw = std::lerp(before.turn_dps, leg.turn_dps, share) * kRadPerDeg;
      const double nod =
          0.004 * std::sin(2.0 * std::numbers::pi * 1.3 * t_s) * std::min(1.0, speed / 14.0);
      const double lean_rad = kLean_rad_per_m_s2 * speed * yaw;
      const Tilt tilt{.roll_rad = std::atan(std::lerp(before.bank, leg.bank, share)) + lean_rad,
                      .pitch_rad = -std::atan(std::lerp(before.grade, leg.grade, share))};
      if (motion.size() == 0) tilt_before = tilt;
      const auto turn = seen_by(tilt, {0.0, 0.0, yaw});
      const double speed_before = motion.size() == 0 ? speed : motion.speed_m_s.back();
      const double pushed_m_s2 = (speed - speed_before) / sample_period_s;
      motion.force_g.push_back(seen_by(
          tilt, {pushed_m_s2 / units::kGravity_m_s2, speed * yaw / units::kGravity_m_s2, 1.0}));
      const double rolls = (tilt.roll_rad - tilt_before.roll_rad) / sample_period_s;
      const double pitches = (tilt.pitch_rad - tilt_before.pitch_rad) / sample_period_s;
      tilt_before = tilt;
      distance_m += speed * sample_period_s;
      motion.rate_rad_s.push_back({rolls + turn[0], nod + pitches + turn[1], turn[2]});
      motion.turn_rad_s.push_back(yaw);
      motion.speed_m_s.push_back(speed);
      motion.odometer_pulses.push_back(static_cast<std::int64_t>(distance_m / metres_per_pulse));
    }
    start_s += leg.length_s;
    before = leg;
  }
  return motion;
}

namespace {

void validate(const OdometerParams& params, double sample_period_s) {
  require(sample_period_s > 0.0, "sample_period_s: expected a time above 0");
  require(params.metres_per_pulse > 0.0, "metres_per_pulse: expected a distance above 0");
  require(params.silent_below_m_s >= 0.0 && params.leaves_zero_at_m_s >= params.silent_below_m_s,
          "silent_below_m_s: expected a speed from 0 to leaves_zero_at_m_s");
  require(params.holds_s >= 0.0 && params.latency_s >= 0.0, "holds_s and latency_s: from 0 on");
  require(params.message_rate_hz >= 0.0 && params.message_rate_hz * sample_period_s <= 1.0,
          "message_rate_hz: expected at most a message a sample");
  require(params.step_m_s >= 0.0, "step_m_s: expected a speed from 0 on");
}

/// A wheel sensor that is silent while the wheel turns too slowly.
class WheelSensor {
 public:
  explicit WheelSensor(const OdometerParams& params) : params_(params) {}

  double sense(double speed_m_s, double period_s) {
    slow_s_ = speed_m_s < params_.silent_below_m_s ? slow_s_ + period_s : 0.0;
    if (speed_m_s >= params_.leaves_zero_at_m_s) is_counting_ = true;
    if (slow_s_ > params_.holds_s) is_counting_ = false;
    if (!is_counting_) return 0.0;
    const bool is_held = slow_s_ > 0.0;
    return is_held ? std::max(speed_m_s, params_.leaves_zero_at_m_s) : speed_m_s;
  }

 private:
  OdometerParams params_;
  double slow_s_ = 0.0;  ///< time for which the wheel has been too slow
  bool is_counting_ = false;
};

double rounded(double speed_m_s, double step_m_s) {
  return step_m_s > 0.0 ? step_m_s * std::round(speed_m_s / step_m_s) : speed_m_s;
}

}  // namespace

OdometerParams car_odometer() {
  constexpr double kKmH = 1.0 / 3.6;
  return {.leaves_zero_at_m_s = 3.0 * kKmH,
          .silent_below_m_s = 0.8,
          .holds_s = 2.8,
          .latency_s = 0.1,
          .message_rate_hz = 2.5,
          .step_m_s = kKmH};
}

std::vector<double> shown_speed(std::span<const double> speed_m_s, double sample_period_s,
                                const OdometerParams& params) {
  validate(params, sample_period_s);
  WheelSensor wheel{params};
  const auto late = static_cast<std::size_t>(std::lround(params.latency_s / sample_period_s));
  std::vector<double> shown(speed_m_s.size(), 0.0);
  double message_m_s = 0.0;
  double messages = 0.0;  // messages sent so far
  for (std::size_t k = 0; k + late < speed_m_s.size(); ++k) {
    const double sensed_m_s = wheel.sense(speed_m_s[k], sample_period_s);
    const double time_s = static_cast<double>(k) * sample_period_s;
    if (time_s * params.message_rate_hz >= messages || params.message_rate_hz == 0.0) {
      message_m_s = rounded(sensed_m_s, params.step_m_s);
      messages += 1.0;
    }
    shown[k + late] = message_m_s;
  }
  return shown;
}

std::vector<std::int64_t> count_pulses(std::span<const double> speed_m_s, double sample_period_s,
                                       const OdometerParams& params) {
  std::vector<std::int64_t> pulses;
  pulses.reserve(speed_m_s.size());
  double distance_m = 0.0;
  for (const double shown_m_s : shown_speed(speed_m_s, sample_period_s, params)) {
    distance_m += shown_m_s * sample_period_s;
    pulses.push_back(static_cast<std::int64_t>(distance_m / params.metres_per_pulse));
  }
  return pulses;
}

}  // namespace zerorate::simulate
