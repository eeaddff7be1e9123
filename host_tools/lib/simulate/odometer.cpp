#include "host_tools/lib/simulate/odometer.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace zerorate::simulate {
namespace {

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

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
  double messages = 0.0;  // that were sent
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
