/// @file
/// A wheel odometer with a dead band, and one whose speed comes in messages.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace zerorate::simulate {

/// Physical figures of an odometer; those of an ideal one by default.
struct OdometerParams {
  double metres_per_pulse = 0.05;
  double leaves_zero_at_m_s = 0.0;  ///< speed above which a silent odometer begins to count
  double silent_below_m_s = 0.0;    ///< at most leaves_zero_at_m_s: the difference is hysteresis
  /// Time below silent_below_m_s after which the odometer falls silent; until then it shows at
  /// least leaves_zero_at_m_s.
  double holds_s = 0.0;
  double latency_s = 0.0;        ///< from the wheel to the message or pulse
  double message_rate_hz = 0.0;  ///< 0: no messages, the wheel's own pulses
  double step_m_s = 0.0;         ///< to which the speed is rounded; 0: not rounded
};

/// Speed signal of a car: the figures of docs/reference/real-odometers.md.
[[nodiscard]] OdometerParams car_odometer();

/// Speed that the odometer shows at each sample [m/s].
/// @param speed_m_s  true magnitudes; the vehicle stood before the first
/// Throws std::invalid_argument for parameters that no odometer can have.
[[nodiscard]] std::vector<double> shown_speed(std::span<const double> speed_m_s,
                                              double sample_period_s, const OdometerParams& params);

/// Pulses counted up to each sample, at the pace of shown_speed(). Throws as shown_speed().
[[nodiscard]] std::vector<std::int64_t> count_pulses(std::span<const double> speed_m_s,
                                                     double sample_period_s,
                                                     const OdometerParams& params);

}  // namespace zerorate::simulate
