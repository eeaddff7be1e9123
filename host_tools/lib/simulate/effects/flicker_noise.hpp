#pragma once

#include <cmath>
#include <string_view>
#include <vector>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"
#include "host_tools/lib/spectrum/fractional_filter.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"

namespace zerorate::simulate {

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

}  // namespace zerorate::simulate
