/// @file
/// Effects of noise.
#pragma once

#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"
#include "host_tools/lib/spectrum/fractional_filter.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"

namespace zerorate::simulate {

/// Angle random walk: white rate noise of two-sided density N^2.
struct WhiteNoise {
  static constexpr std::string_view kName = "white_noise";

  double angle_random_walk_rad_rt_s = 0.0;  ///< N, rad/sqrt(s)

  void apply(Signal& signal, const random::RandomStream& stream) const {
    const double sigma =
        std::sqrt(spectrum::white_variance(angle_random_walk_rad_rt_s, signal.sample_period_s));
    for (std::size_t k = 0; k < signal.size(); ++k) {
      signal.rate_rad_s[k] += sigma * stream.normal(static_cast<std::int64_t>(k));
    }
  }
};

/// 1/f noise as ARFIMA(0,d,0): x_k = sum_j psi_j w_{k-j} (Kirkko-Jaakkola et al. 2012, eq. 3), of
/// two-sided density B^2 / (2 pi nu)^(2d) well below the sample rate.
struct FlickerNoise {
  static constexpr std::string_view kName = "flicker_noise";

  /// B, rad/s at order 1/2 (see noise_strength.hpp for the others and for the Allan floor).
  double bias_instability_rad_s = 0.0;
  /// d in (-1/2, 1): 0 is white noise, 1/2 flicker noise, towards 1 a random walk.
  double order = 0.5;
  /// How long the sensor had been on before sample 0, in lengths of the record. 0: the noise starts
  /// from nothing at sample 0, as in the paper's simulation ("type II"). From d = 1/2 upwards the
  /// variance grows without bound with the history. Starts differ in the past only: innovation k
  /// of a stream is the same for all.
  double history_records = 4.0;

  void apply(Signal& signal, const random::RandomStream& stream) const {
    const double sigma = std::sqrt(spectrum::flicker_innovation_variance(
        bias_instability_rad_s, order, signal.sample_period_s));
    const auto history =
        static_cast<std::size_t>(history_records * static_cast<double>(signal.size()));
    std::vector<double> noise(signal.size());
    spectrum::integrate_fractionally(
        order,
        [&stream](std::ptrdiff_t first, std::span<double> block) {
          stream.fill_normal(first, block);
        },
        history, noise);
    for (std::size_t k = 0; k < noise.size(); ++k) signal.rate_rad_s[k] += sigma * noise[k];
  }
};

/// First-order Gauss-Markov noise, stationary from sample 0: autocovariance
/// sigma^2 exp(-|t| / time constant), sampled exactly.
struct CorrelatedNoise {
  static constexpr std::string_view kName = "correlated_noise";

  double sigma_rad_s = 0.0;
  double time_constant_s = 1.0;

  void apply(Signal& signal, const random::RandomStream& stream) const {
    const double decay = std::exp(-signal.sample_period_s / time_constant_s);
    const double drive = std::sqrt(-std::expm1(-2.0 * signal.sample_period_s / time_constant_s));
    double state = stream.normal(0);
    for (std::size_t k = 0; k < signal.size(); ++k) {
      if (k > 0) state = decay * state + drive * stream.normal(static_cast<std::int64_t>(k));
      signal.rate_rad_s[k] += sigma_rad_s * state;
    }
  }
};

/// Rate random walk: a sum of independent steps, 0 at sample 0; density K^2 / (2 pi nu)^2.
struct RateRandomWalk {
  static constexpr std::string_view kName = "rate_random_walk";

  double rate_random_walk_rad_s_rt_s = 0.0;  ///< K, rad/s/sqrt(s)

  void apply(Signal& signal, const random::RandomStream& stream) const {
    const double step = rate_random_walk_rad_s_rt_s * std::sqrt(signal.sample_period_s);
    double walk = 0.0;
    for (std::size_t k = 0; k < signal.size(); ++k) {
      signal.rate_rad_s[k] += walk;
      walk += step * stream.normal(static_cast<std::int64_t>(k));
    }
  }
};

/// A bias that switches between two levels at random, with exponential dwell times (a trapped
/// charge; "popcorn noise"); stationary from sample 0. Switches within one sample are seen at its
/// end only.
struct RandomTelegraphNoise {
  static constexpr std::string_view kName = "random_telegraph_noise";

  double height_rad_s = 0.0;  ///< from the lower level, 0, to the upper
  double mean_low_s = 10.0;
  double mean_high_s = 10.0;

  void apply(Signal& signal, const random::RandomStream& stream) const {
    // The two-state Markov chain in continuous time, sampled exactly.
    const double rate_hz = 1.0 / mean_low_s + 1.0 / mean_high_s;
    const double mixed = -std::expm1(-rate_hz * signal.sample_period_s);
    const double share_high = mean_high_s / (mean_low_s + mean_high_s);
    bool high = stream.uniform(0) < share_high;
    for (std::size_t k = 0; k < signal.size(); ++k) {
      if (k > 0) {
        const double switches = mixed * (high ? 1.0 - share_high : share_high);
        high = high != (stream.uniform(static_cast<std::int64_t>(k)) < switches);
      }
      if (high) signal.rate_rad_s[k] += height_rad_s;
    }
  }
};

/// White noise whose strength comes and goes (an engine idling, a supply under load): its density
/// swings as a raised cosine between zero, at sample 0, and a peak.
struct VariableNoise {
  static constexpr std::string_view kName = "variable_noise";

  double peak_angle_random_walk_rad_rt_s = 0.0;
  double swing_period_s = 600.0;

  void apply(Signal& signal, const random::RandomStream& stream) const {
    const double peak_sigma = std::sqrt(
        spectrum::white_variance(peak_angle_random_walk_rad_rt_s, signal.sample_period_s));
    for (std::size_t k = 0; k < signal.size(); ++k) {
      // sqrt((1 - cos 2a) / 2) = |sin a|
      const double share = std::sin(std::numbers::pi * signal.time_s(k) / swing_period_s);
      signal.rate_rad_s[k] += peak_sigma * share * stream.normal(static_cast<std::int64_t>(k));
    }
  }
};

}  // namespace zerorate::simulate
