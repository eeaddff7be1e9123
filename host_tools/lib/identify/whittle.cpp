#include "host_tools/lib/identify/whittle.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "host_tools/lib/identify/minimise.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/spectrum/fractional_filter.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::identify {

namespace {

constexpr double kBinGrowth = 1.03;
constexpr int kBits = 18;  // precision of a minimum

/// Neighbouring coefficients of nearly the same density.
struct Bin {
  double cycles_per_sample;
  double mean_square;
  double count;
};

std::vector<Bin> binned_coefficients(std::span<const double> rate) {
  const std::vector<double> coefficients = spectrum::cosine_transform(rate);
  std::vector<Bin> bins;
  std::size_t first = 1;
  while (first < coefficients.size()) {
    const auto grown = static_cast<std::size_t>(static_cast<double>(first) * kBinGrowth);
    const std::size_t end =
        first <= kDctRatios ? first + 1 : std::min(std::max(grown, first + 1), coefficients.size());
    double sum = 0.0;
    for (std::size_t k = first; k < end; ++k) sum += coefficients[k] * coefficients[k];
    const auto count = static_cast<double>(end - first);
    const double centre = 0.5 * static_cast<double>(first + end - 1);
    bins.push_back({centre / static_cast<double>(2 * coefficients.size()), sum / count, count});
    first = end;
  }
  return bins;
}

/// Density of flicker noise of unit innovation variance in each bin.
std::vector<double> flicker_shape(std::span<const Bin> bins, double order) {
  std::vector<double> shape(bins.size());
  const std::array<double, kDctRatios> ratios = dct_power_ratios(order);
  for (std::size_t b = 0; b < bins.size(); ++b) {
    shape[b] = spectrum::fractional_density(order, bins[b].cycles_per_sample);
    if (b < ratios.size()) shape[b] *= ratios[b];
  }
  return shape;
}

/// The scale-free half of the likelihood: white variance r, flicker variance ratio * r.
struct Profile {
  double minus_two_log_likelihood;
  double white_variance;  ///< the best for the given ratio
};

Profile profile(std::span<const Bin> bins, std::span<const double> shape, double ratio) {
  double logs = 0.0;
  double scaled = 0.0;
  double count = 0.0;
  for (std::size_t b = 0; b < bins.size(); ++b) {
    const double relative = 1.0 + ratio * shape[b];
    logs += bins[b].count * std::log(relative);
    scaled += bins[b].count * bins[b].mean_square / relative;
    count += bins[b].count;
  }
  const double white = scaled / count;
  return {logs + count * (std::log(white) + 1.0), white};
}

ScalarMinimum best_log_ratio(std::span<const Bin> bins, std::span<const double> shape) {
  constexpr double kLowest = -20.0;  // log of flicker over white variance that counts as zero
  constexpr double kHighest = 12.0;
  const auto objective = [&](double log_ratio) {
    return profile(bins, shape, std::exp(log_ratio)).minus_two_log_likelihood;
  };
  return minimise(objective, kLowest, kHighest, 32, kBits);
}

double best_order(std::span<const Bin> bins) {
  constexpr double kLowest = 0.05;
  constexpr double kHighest = 1.0;
  const auto objective = [&](double order) {
    return best_log_ratio(bins, flicker_shape(bins, order)).value;
  };
  return minimise(objective, kLowest, kHighest, 10, kBits).at;
}

/// Covariance of (r, s_f^2, d) by the expected information, 1/2 sum n_b dS dS' / S^2; the last row
/// and column are zero where d is known.
Eigen::Matrix3d covariance(std::span<const Bin> bins, std::span<const double> shape, double white,
                           double flicker, bool order_is_free) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (std::size_t b = 0; b < bins.size(); ++b) {
    const double sine = 2.0 * std::sin(std::numbers::pi * bins[b].cycles_per_sample);
    const double order_slope = -2.0 * flicker * shape[b] * std::log(sine);
    const double density = white + flicker * shape[b];
    const Eigen::Vector3d slope = Eigen::Vector3d(1.0, shape[b], order_slope) / density;
    information += 0.5 * bins[b].count * slope * slope.transpose();
  }
  const Eigen::Index free = order_is_free ? 3 : 2;
  // Scaled to a unit diagonal first: the three parameters differ by many orders of magnitude.
  const Eigen::VectorXd scale = information.diagonal().head(free).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation =
      scale.asDiagonal() * information.topLeftCorner(free, free) * scale.asDiagonal();
  Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
  result.topLeftCorner(free, free) =
      scale.asDiagonal() * correlation.inverse() * scale.asDiagonal();
  return result;
}

double p_value_of(double likelihood_ratio, bool order_is_free) {
  if (likelihood_ratio <= 0.0) return 1.0;
  const double tail = statistics::chi_squared_tail(likelihood_ratio, order_is_free ? 2.0 : 1.0);
  return order_is_free ? tail : 0.5 * tail;
}

}  // namespace

namespace {

/// Integrals over 0 < u < 1 by the double exponential rule, u = 1 / (1 + exp(-pi sinh t)), which
/// takes the singularity of the covariance at 0. The nodes and the kernels of all coefficients are
/// those of any order.
class DctQuadrature {
 public:
  static const DctQuadrature& get() {
    static const DctQuadrature quadrature;
    return quadrature;
  }

  /// Integrals of a covariance over the kernels (1 - u) cos(p u) - sin(p u) / p, p = pi k.
  /// @param covariance  of log u
  template <class Covariance>
  [[nodiscard]] std::array<double, kDctRatios> operator()(const Covariance& covariance) const {
    std::array<double, kDctRatios> sums{};
    for (const Node& node : nodes_) {
      const double value = covariance(node.log_u);
      for (std::size_t k = 0; k < kDctRatios; ++k) sums[k] += value * node.kernels[k];
    }
    return sums;
  }

 private:
  struct Node {
    double log_u;
    std::array<double, kDctRatios> kernels;  ///< times the weight
  };

  /// The widest gap between nodes is 0.8 of a radian of the quickest kernel.
  static constexpr double kStep = 0.01;
  /// Down to u = 1e-165, below which the covariance of order 0.01 still has 5e-4 of its integral.
  static constexpr double kFirst = -5.5;
  static constexpr double kLast = 3.3;  // 1 - u = 1e-18

  DctQuadrature() {
    for (double t = kFirst; t < kLast; t += kStep) {
      const double x = std::numbers::pi * std::sinh(t);
      const double u = 1.0 / (1.0 + std::exp(-x));
      const double rest = 1.0 / (1.0 + std::exp(x));  // 1 - u
      const double weight = kStep * std::numbers::pi * std::cosh(t) * u * rest;
      Node node{.log_u = -std::log1p(std::exp(-x)), .kernels = {}};
      for (std::size_t k = 0; k < kDctRatios; ++k) {
        const double p = std::numbers::pi * static_cast<double>(k + 1);
        node.kernels[k] = weight * (rest * std::cos(p * u) - std::sin(p * u) / p);
      }
      nodes_.push_back(node);
    }
  }

  std::vector<Node> nodes_;
};

}  // namespace

std::array<double, kDctRatios> dct_power_ratios(double order) {
  std::array<double, kDctRatios> ratios;
  ratios.fill(1.0);
  if (order <= 0.0) return ratios;
  // The covariance up to a constant, which no coefficient but c_0 sees: -log(u) / pi at d = 1/2.
  const double half_slope = std::tgamma(2.0 * order) * std::cos(std::numbers::pi * order);
  const auto covariance = [&](double log_u) {
    if (std::abs(order - 0.5) < 1e-9) return -log_u / std::numbers::pi;
    return std::expm1((2.0 * order - 1.0) * log_u) / (2.0 * half_slope);
  };
  const std::array<double, kDctRatios> integrals = DctQuadrature::get()(covariance);
  for (std::size_t k = 0; k < kDctRatios; ++k) {
    ratios[k] =
        2.0 * integrals[k] * std::pow(std::numbers::pi * static_cast<double>(k + 1), 2.0 * order);
  }
  return ratios;
}

WhiteFlickerFit fit_white_flicker(std::span<const double> rate,
                                  const WhiteFlickerOptions& options) {
  constexpr std::size_t kFewest = 64;
  if (rate.size() < kFewest) {
    throw recording::DataError("fit_white_flicker: fewer than 64 samples");
  }
  const bool constant = std::ranges::adjacent_find(rate, std::not_equal_to{}) == rate.end();
  const std::vector<Bin> bins =
      binned_coefficients(rate.first(spectrum::fast_length_below(rate.size())));
  const double order = options.order ? *options.order : best_order(bins);
  const std::vector<double> shape = flicker_shape(bins, order);
  const Profile white_alone = profile(bins, shape, 0.0);
  if (constant || !std::isfinite(white_alone.white_variance)) {
    throw recording::DataError("fit_white_flicker: the record is constant or not finite");
  }
  const ScalarMinimum best = best_log_ratio(bins, shape);

  WhiteFlickerFit fit{};
  fit.likelihood_ratio = std::max(0.0, white_alone.minus_two_log_likelihood - best.value);
  fit.p_value = p_value_of(fit.likelihood_ratio, !options.order);
  if (fit.p_value > options.significance) {
    const auto count = static_cast<double>(rate.size() - 1);
    fit.white_variance = {white_alone.white_variance,
                          white_alone.white_variance * std::sqrt(2.0 / count)};
    return fit;
  }
  const double ratio = std::exp(best.at);
  const double white = profile(bins, shape, ratio).white_variance;
  const Eigen::Matrix3d errors = covariance(bins, shape, white, ratio * white, !options.order);
  fit.white_variance = {white, std::sqrt(errors(0, 0))};
  fit.flicker =
      FlickerEstimate{{ratio * white, std::sqrt(errors(1, 1))}, {order, std::sqrt(errors(2, 2))}};
  return fit;
}

namespace {

/// The objective R(d) of one record, and what does not depend on d.
class LocalWhittle {
 public:
  LocalWhittle(std::span<const double> values, std::size_t frequencies)
      : centred_(values.begin(), values.end()), log_gains_(frequencies), fft_(values.size()) {
    const double mean = mean_of(values);
    for (double& value : centred_) value -= mean;
    const double step = std::numbers::pi / static_cast<double>(values.size());
    for (std::size_t j = 0; j < frequencies; ++j) {
      log_gains_[j] = std::log(2.0 * std::sin(step * static_cast<double>(j + 1)));
    }
  }

  double objective(double order) const {
    const std::vector<double> whitened = spectrum::difference_fractionally(order, centred_);
    std::vector<std::complex<double>> bins(fft_.bins());
    fft_.forward(whitened, bins);
    double power = 0.0;
    for (std::size_t j = 1; j <= log_gains_.size(); ++j) power += std::norm(bins[j]);
    return std::log(power) - 2.0 * order * mean_of(log_gains_);
  }

  double standard_error() const {
    const double mean = mean_of(log_gains_);
    double squares = 0.0;
    for (const double gain : log_gains_) squares += (gain - mean) * (gain - mean);
    return 0.5 / std::sqrt(squares);
  }

 private:
  static double mean_of(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  }

  std::vector<double> centred_;
  std::vector<double> log_gains_;  // logarithm of 1 - L at each frequency
  spectrum::RealFft fft_;
};

}  // namespace

std::size_t local_whittle_bandwidth(std::size_t samples) {
  return static_cast<std::size_t>(std::pow(static_cast<double>(samples), 0.65));
}

Estimate exact_local_whittle(std::span<const double> values, std::size_t frequencies) {
  const std::size_t size = values.size() < 2 ? 0 : spectrum::fast_length_below(values.size());
  if (frequencies < 2 || frequencies >= size / 2) {
    throw std::invalid_argument("exact_local_whittle: the frequencies do not fit the record");
  }
  const bool constant = std::ranges::adjacent_find(values, std::not_equal_to{}) == values.end();
  const LocalWhittle whittle(values.first(size), frequencies);
  constexpr double kLowest = -0.5;
  constexpr double kHighest = 1.0;
  constexpr int kScanSteps = 6;
  constexpr int kScanBits = 16;  // d to about 1e-5
  const ScalarMinimum best = minimise([&](double order) { return whittle.objective(order); },
                                      kLowest, kHighest, kScanSteps, kScanBits);
  if (constant || !std::isfinite(best.value)) {
    throw recording::DataError("exact_local_whittle: the record is constant or not finite");
  }
  return {best.at, whittle.standard_error()};
}

}  // namespace zerorate::identify
