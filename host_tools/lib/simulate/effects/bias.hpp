/// @file
/// Effects on the bias: what is added to the rate and varies slowly.
#pragma once

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// The bias of this power-up.
struct ConstantBias {
  static constexpr std::string_view kName = "constant_bias";

  double bias_rad_s = 0.0;

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    for (double& rate : signal.rate_rad_s) rate += bias_rad_s;
  }
};

/// A bias that is another from one moment on, as after a shock.
struct BiasJump {
  static constexpr std::string_view kName = "bias_jump";

  double height_rad_s = 0.0;
  double time_s = 0.0;  ///< the first sample at or after it has the new bias

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    for (std::size_t k = 0; k < signal.size(); ++k) {
      if (signal.time_s(k) >= time_s) signal.rate_rad_s[k] += height_rad_s;
    }
  }
};

/// Jumps of the bias, each of its own height, that decay with one time constant, as stress relaxes.
struct Relaxation {
  static constexpr std::string_view kName = "relaxation";

  struct Jump {
    double time_s = 0.0;
    double height_rad_s = 0.0;
  };
  std::vector<Jump> jumps;
  double time_constant_s = 60.0;

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    for (const Jump& jump : jumps) {
      for (std::size_t k = 0; k < signal.size(); ++k) {
        const double since_s = signal.time_s(k) - jump.time_s;
        if (since_s < 0.0) continue;
        signal.rate_rad_s[k] += jump.height_rad_s * std::exp(-since_s / time_constant_s);
      }
    }
  }
};

/// A bias that changes at a constant rate, 0 at sample 0.
struct RateRamp {
  static constexpr std::string_view kName = "rate_ramp";

  double slope_rad_s2 = 0.0;

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    for (std::size_t k = 0; k < signal.size(); ++k) {
      signal.rate_rad_s[k] += slope_rad_s2 * signal.time_s(k);
    }
  }
};

/// The exponential that dies out after switch-on at sample 0.
struct WarmUpTransient {
  static constexpr std::string_view kName = "warm_up_transient";

  double amplitude_rad_s = 0.0;  ///< at sample 0
  double time_constant_s = 60.0;

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    for (std::size_t k = 0; k < signal.size(); ++k) {
      signal.rate_rad_s[k] += amplitude_rad_s * std::exp(-signal.time_s(k) / time_constant_s);
    }
  }
};

/// A bias driven by the temperature of the signal, which the sensing element follows with a lag.
/// Throws std::invalid_argument when the signal has no temperature.
struct TemperatureDrift {
  static constexpr std::string_view kName = "temperature_drift";

  double linear_rad_s_per_k = 0.0;
  double quadratic_rad_s_per_k2 = 0.0;
  double reference_degc = 25.0;  ///< where the drift is 0
  double lag_s = 0.0;            ///< time constant of the sensing element; 0: none

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    if (signal.temperature_degc.size() != signal.size()) {
      throw std::invalid_argument(
          "TemperatureDrift: the signal has no temperature for each sample");
    }
    if (signal.size() == 0) return;
    const double follow = lag_s > 0.0 ? -std::expm1(-signal.sample_period_s / lag_s) : 1.0;
    double element_degc = signal.temperature_degc.front();
    for (std::size_t k = 0; k < signal.size(); ++k) {
      element_degc += follow * (signal.temperature_degc[k] - element_degc);
      const double excess_k = element_degc - reference_degc;
      signal.rate_rad_s[k] += (linear_rad_s_per_k + quadratic_rad_s_per_k2 * excess_k) * excess_k;
    }
  }
};

/// A bias driven by the rate of change of the temperature of the signal, behind a first-order lag.
/// Throws std::invalid_argument when the signal has no temperature.
struct TemperatureRate {
  static constexpr std::string_view kName = "temperature_rate";

  double coefficient_rad_per_k = 0.0;  ///< rad/s for each K/s
  double lag_s = 60.0;                 ///< time constant of the lag, positive

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    if (signal.temperature_degc.size() != signal.size()) {
      throw std::invalid_argument("TemperatureRate: the signal has no temperature for each sample");
    }
    if (signal.size() == 0) return;
    const double follow = -std::expm1(-signal.sample_period_s / lag_s);
    double element_degc = signal.temperature_degc.front();
    for (std::size_t k = 0; k < signal.size(); ++k) {
      element_degc += follow * (signal.temperature_degc[k] - element_degc);
      signal.rate_rad_s[k] +=
          coefficient_rad_per_k * (signal.temperature_degc[k] - element_degc) / lag_s;
    }
  }
};

/// A line in the spectrum, such as vibration or a supply's ripple. A frequency above half the
/// sample rate folds, as it does in the sensor.
struct PeriodicDisturbance {
  static constexpr std::string_view kName = "periodic_disturbance";

  double amplitude_rad_s = 0.0;  ///< peak
  double frequency_hz = 1.0;
  double phase_rad = 0.0;  ///< phase of the sine at sample 0

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    for (std::size_t k = 0; k < signal.size(); ++k) {
      const double cycles = frequency_hz * signal.time_s(k);
      const double turn = 2.0 * std::numbers::pi * (cycles - std::floor(cycles));
      signal.rate_rad_s[k] += amplitude_rad_s * std::sin(turn + phase_rad);
    }
  }
};

}  // namespace zerorate::simulate
