#include "host_tools/lib/identify/density.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "firmware/model/flicker_fit.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::identify {

namespace {

using spectrum::RealFft;

double mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Periodic Hann window.
std::vector<double> hann(std::size_t size) {
  std::vector<double> window(size);
  const double step = 2.0 * std::numbers::pi / static_cast<double>(size);
  for (std::size_t k = 0; k < size; ++k) {
    window[k] = 0.5 - 0.5 * std::cos(step * static_cast<double>(k));
  }
  return window;
}

/// Sum of the squared magnitudes of all windowed segments at the bins 1 .. size/2.
std::vector<double> summed_powers(std::span<const double> rate, std::span<const double> window,
                                  std::size_t step) {
  const double centre = mean(rate);
  const RealFft fft(window.size());
  std::vector<double> tapered(window.size());
  std::vector<std::complex<double>> bins(fft.bins());
  std::vector<double> powers(fft.bins() - 1);
  for (std::size_t first = 0; first + window.size() <= rate.size(); first += step) {
    for (std::size_t k = 0; k < window.size(); ++k) {
      tapered[k] = window[k] * (rate[first + k] - centre);
    }
    fft.forward(tapered, bins);
    for (std::size_t j = 0; j < powers.size(); ++j) powers[j] += std::norm(bins[j + 1]);
  }
  return powers;
}

std::vector<DensityPoint> densities(std::span<const double> rate, double sample_period_s,
                                    std::span<const double> window, std::size_t step) {
  const std::vector<double> powers = summed_powers(rate, window, step);
  const std::size_t segments = (rate.size() - window.size()) / step + 1;
  const double window_power = std::inner_product(window.begin(), window.end(), window.begin(), 0.0);
  const double scale = 2.0 * sample_period_s / (static_cast<double>(segments) * window_power);
  const double spacing_hz = 1.0 / (sample_period_s * static_cast<double>(window.size()));
  std::vector<DensityPoint> points(powers.size());
  for (std::size_t j = 0; j < points.size(); ++j) {
    points[j] = {static_cast<double>(j + 1) * spacing_hz, scale * powers[j]};
  }
  points.back().density *= 0.5;  // half the sample rate is its own mirror image
  return points;
}

}  // namespace

std::vector<DensityPoint> welch_density(std::span<const double> rate, double sample_period_s,
                                        std::size_t segment) {
  if (segment < 2 || segment % 2 != 0 || segment > rate.size()) {
    throw std::invalid_argument("welch_density: the segment must be even and fit the record");
  }
  return densities(rate, sample_period_s, hann(segment), segment / 2);
}

std::vector<DensityPoint> periodogram(std::span<const double> rate, double sample_period_s) {
  if (rate.size() < 2) throw recording::DataError("periodogram: fewer than 2 samples");
  const std::size_t size = spectrum::fast_length_below(rate.size());
  const std::vector<double> no_window(size, 1.0);
  return densities(rate.first(size), sample_period_s, no_window, size);
}

std::vector<DensityBin> bin_logarithmically(std::span<const DensityPoint> points,
                                            double bins_per_decade) {
  std::vector<DensityBin> bins;
  double current = 0.0;
  for (const DensityPoint& point : points) {
    const double bin = std::floor(bins_per_decade * std::log10(point.frequency_hz));
    if (bins.empty() || bin != current) bins.push_back({0.0, 0.0, 0});
    current = bin;
    bins.back().frequency_hz += point.frequency_hz;
    bins.back().density += point.density;
    ++bins.back().points;
  }
  for (DensityBin& bin : bins) {
    bin.frequency_hz /= static_cast<double>(bin.points);
    bin.density /= static_cast<double>(bin.points);
  }
  return bins;
}

namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// Allan variance of an exponentially correlated process of unit variance, a = tau / T.
double lag_allan_variance(double a) {
  // The series where the closed form would be a difference of nearly equal numbers.
  if (a < 1e-3) return 2.0 / 3.0 * a * (1.0 - 0.75 * a);
  return 2.0 / a * (1.0 - (3.0 - 4.0 * std::exp(-a) + std::exp(-2.0 * a)) / (2.0 * a));
}

}  // namespace

double model_density(const model::SensorModel& model, double frequency_hz) {
  const double white = model.white.angle_random_walk_rad_per_sqrt_s;
  double density = white * white;
  if (model.flicker) {
    const double b = model.flicker->bias_instability_rad_s;
    density += b * b * std::pow(kTwoPi * frequency_hz, -2.0 * model.flicker->order);
  }
  return density;
}

double model_allan_deviation(const model::SensorModel& model, double tau_s) {
  const double white = model.white.angle_random_walk_rad_per_sqrt_s;
  double variance = white * white / tau_s;
  if (model.flicker) {
    const auto decades =
        model::fit_flicker(*model.flicker, model.flicker->shortest_time_constant_s);
    for (std::size_t i = 0; i < decades.time_constants_s.size(); ++i) {
      variance +=
          decades.variances_rad2_s2[i] * lag_allan_variance(tau_s / decades.time_constants_s[i]);
    }
  }
  return std::sqrt(variance);
}

double corner_frequency_hz(const model::SensorModel& model) {
  const double ratio =
      model.flicker->bias_instability_rad_s / model.white.angle_random_walk_rad_per_sqrt_s;
  return std::pow(ratio, 1.0 / model.flicker->order) / kTwoPi;
}

}  // namespace zerorate::identify
