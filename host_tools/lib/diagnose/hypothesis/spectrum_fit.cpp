#include "host_tools/lib/diagnose/hypothesis/spectrum_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"
#include "host_tools/lib/diagnose/hypothesis/noise_density.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {
namespace {

using Kind = NoiseParameter::Kind;

constexpr double kWeakest = 1e-12;  // share of the mean square that counts as zero
constexpr int kMostIterations = 60;
constexpr double kConverged = 1e-5;     // nats
constexpr double kBroadestLine = 0.25;  // half its width at half its power, of its frequency
/// Half the width of the narrowest line: what the nodes of density_table() still follow.
constexpr double kNarrowestLine = 1e-3;
/// Longest coherence time, of the record: a line that has lost its phase only a few times is no
/// other than a sweep.
constexpr double kLongestLine = 0.025;

constexpr int kMostParameters = static_cast<int>(kNoiseParameters.size());
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostParameters, 1>;
using Matrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostParameters, kMostParameters>;
/// A figure of each bin.
using Bins = Eigen::ArrayXd;

Eigen::Index index(std::size_t i) {
  return static_cast<Eigen::Index>(i);
}

double to_scale(Kind kind, double value) {
  switch (kind) {
    case Kind::strength:
    case Kind::time:
    case Kind::line_time:
      return std::log(value);
    case Kind::share:
      return statistics::logit(value);
    case Kind::order:
      break;
  }
  return value;
}

double from_scale(Kind kind, double theta) {
  switch (kind) {
    case Kind::strength:
    case Kind::time:
    case Kind::line_time:
      return std::exp(theta);
    case Kind::share:
      return statistics::share_of_logit(theta);
    case Kind::order:
      break;
  }
  return theta;
}

/// Fisher scoring of one set of terms.
class Scoring {
 public:
  Scoring(std::span<const SpectralBin> bins, std::size_t size, const NoiseTerms& terms)
      : half_counts_(index(bins.size())),
        mean_squares_(index(bins.size())),
        size_(size),
        terms_(terms) {
    places_.reserve(bins.size());
    for (std::size_t b = 0; b < bins.size(); ++b) {
      const SpectralBin& bin = bins[b];
      half_counts_(index(b)) = 0.5 * bin.count;
      mean_squares_(index(b)) = bin.mean_square;
      places_.emplace_back(bin.sine, bin.index, size, bin.count, terms.line);
    }
    mean_square_ = (half_counts_ * mean_squares_).sum() / half_counts_.sum();
    for (const NoiseParameter& parameter : kNoiseParameters) {
      if (is_fitted(parameter, terms)) fitted_.push_back(&parameter);
    }
  }

  [[nodiscard]] double log_likelihood(const NoiseSpectrum& spectrum) const {
    const DensityFactors factors(spectrum);
    Bins totals(half_counts_.size());
    for (Eigen::Index b = 0; b < totals.size(); ++b) {
      totals(b) = NoiseDensity(factors, places_[static_cast<std::size_t>(b)]).total();
    }
    return log_likelihood(totals, mean_squares_ / totals);
  }

  [[nodiscard]] SpectrumFit maximise(NoiseSpectrum start) const {
    if (!terms_.free_order) set_order(terms_.given_order.value_or(kOrderOfBase), start);
    Vector theta = pack(start);
    Vector gradient;
    Matrix information;
    double value = evaluate(theta, start, gradient, information);
    double damping = 1e-3;
    bool is_enough = true;  // damping, for the step before
    for (int i = 0; i < kMostIterations; ++i) {
      Matrix damped = information;
      damped.diagonal() *= 1.0 + damping;
      damped.diagonal().array() += 1e-9;
      const Vector step = damped.ldlt().solve(gradient).cwiseMax(-2.0).cwiseMin(2.0);
      Vector trial = bounded(theta + step);
      Vector trial_gradient;
      Matrix trial_information;
      const double reached = evaluate(trial, start, trial_gradient, trial_information);
      if (reached > value) {
        const bool converged = reached - value < kConverged;
        theta = trial;
        value = reached;
        gradient = trial_gradient;
        information = trial_information;
        if (is_enough) damping = std::max(1e-9, damping * 0.1);
        is_enough = true;
        if (converged) break;
      } else {
        damping = std::max(damping * 10.0, 1e-3);
        is_enough = false;
        if (damping > 1e6) break;
      }
    }
    SpectrumFit fit{.spectrum = unpack(theta, start), .log_likelihood = value};
    information.diagonal().array() += 1e-9;
    const Vector errors = information.inverse().diagonal().cwiseMax(0.0).cwiseSqrt();
    for (std::size_t i = 0; i < fitted_.size(); ++i) {
      fit.errors[static_cast<std::size_t>(fitted_[i]->id)] = errors(index(i));
    }
    return fit;
  }

 private:
  /// Another order, the flicker noise as strong as before where it usually meets the white noise.
  static void set_order(double order, NoiseSpectrum& spectrum) {
    constexpr double kPivot = 0.05;  // a sine
    spectrum.flicker_variance *= std::pow(kPivot, 2.0 * (order - spectrum.flicker_order));
    spectrum.flicker_order = order;
  }

  [[nodiscard]] double weakest() const { return kWeakest * mean_square_; }

  /// The fitted parameters of a spectrum, each on its scale.
  [[nodiscard]] Vector pack(const NoiseSpectrum& spectrum) const {
    Vector theta(index(fitted_.size()));
    for (std::size_t i = 0; i < fitted_.size(); ++i) {
      const NoiseParameter& parameter = *fitted_[i];
      const double unit = parameter.kind == Kind::strength ? weakest() : 1.0;
      const double value =
          std::clamp(spectrum.*parameter.value / parameter.unit, parameter.lowest_start * unit,
                     parameter.highest_start * unit);
      theta(index(i)) = to_scale(parameter.kind, value);
    }
    return bounded(theta);
  }

  /// @param start  for what is not fitted
  [[nodiscard]] NoiseSpectrum unpack(const Vector& theta, const NoiseSpectrum& start) const {
    NoiseSpectrum spectrum{.flicker_order = start.flicker_order,
                           .rounding_variance = start.rounding_variance};
    if (terms_.low_pass) spectrum.filter_order = start.filter_order;
    for (std::size_t i = 0; i < fitted_.size(); ++i) {
      const NoiseParameter& parameter = *fitted_[i];
      spectrum.*parameter.value = parameter.unit * from_scale(parameter.kind, theta(index(i)));
    }
    return spectrum;
  }

  [[nodiscard]] Vector bounded(Vector theta) const {
    double line_angle = 0.0;  // it comes before the time of the line
    for (std::size_t i = 0; i < fitted_.size(); ++i) {
      const NoiseParameter& parameter = *fitted_[i];
      double& value = theta(index(i));
      const auto [lowest, highest] = limits(parameter, line_angle);
      value = std::clamp(value, lowest, highest);
      if (parameter.id == NoiseParameterId::line_angle) {
        line_angle = parameter.unit * from_scale(parameter.kind, value);
      }
    }
    return theta;
  }

  struct Limits {
    double lowest;
    double highest;
  };
  /// Limits of a parameter on its scale.
  [[nodiscard]] Limits limits(const NoiseParameter& parameter, double line_angle) const {
    const auto size = static_cast<double>(size_);
    switch (parameter.kind) {
      case Kind::strength:
        return {std::log(weakest()) + parameter.lowest, parameter.highest};
      case Kind::time:
        return {std::log(parameter.lowest), std::log(parameter.highest * size)};
      case Kind::line_time: {
        const double shortest = 1.0 / (kBroadestLine * line_angle);
        const double longest = std::min(1.0 / (kNarrowestLine * line_angle), kLongestLine * size);
        return {std::log(std::min(shortest, longest)), std::log(longest)};
      }
      case Kind::share:
      case Kind::order:
        break;
    }
    return {parameter.lowest, parameter.highest};
  }

  /// Whittle's, of densities.
  /// @param excess  mean squares over the densities
  [[nodiscard]] double log_likelihood(const Bins& totals, const Bins& excess) const {
    return -(half_counts_ * (totals.log() + excess)).sum();
  }

  /// The log likelihood, its gradient and the expected information.
  double evaluate(const Vector& theta, const NoiseSpectrum& start, Vector& gradient,
                  Matrix& information) const {
    const NoiseSpectrum spectrum = unpack(theta, start);
    const DensityFactors factors(spectrum);
    Bins totals(half_counts_.size());
    Eigen::MatrixXd slopes(totals.size(), theta.size());
    NoiseSlopes all_slopes{};
    for (Eigen::Index b = 0; b < totals.size(); ++b) {
      const NoiseDensity density(factors, places_[static_cast<std::size_t>(b)]);
      totals(b) = density.total();
      density.derivatives(terms_, all_slopes);
      for (std::size_t i = 0; i < fitted_.size(); ++i) {
        slopes(b, index(i)) = all_slopes[static_cast<std::size_t>(fitted_[i]->id)];
      }
    }
    const Bins excess = mean_squares_ / totals;
    gradient = slopes.transpose() * (half_counts_ * (excess - 1.0)).matrix();
    const Eigen::MatrixXd weighted = half_counts_.matrix().asDiagonal() * slopes;
    information = slopes.transpose().lazyProduct(weighted);  // few columns
    return log_likelihood(totals, excess);
  }

  Bins half_counts_;
  Bins mean_squares_;
  std::vector<SpectralPlace> places_;  ///< places of the bins
  std::size_t size_;
  NoiseTerms terms_;
  std::vector<const NoiseParameter*> fitted_;
  double mean_square_ = 0.0;
};

}  // namespace

SpectrumFit fit_spectrum(std::span<const SpectralBin> bins, std::size_t size,
                         const NoiseTerms& terms, std::span<const NoiseSpectrum> starts) {
  const Scoring scoring(bins, size, terms);
  SpectrumFit best;
  bool any = false;
  for (const NoiseSpectrum& start : starts) {
    const SpectrumFit fit = scoring.maximise(start);
    if (!any || fit.log_likelihood > best.log_likelihood) best = fit;
    any = true;
  }
  return best;
}

NoiseSpectrum likeliest_of(std::span<const NoiseSpectrum> spectra,
                           std::span<const SpectralBin> bins, std::size_t size) {
  const bool any_line = std::ranges::any_of(
      spectra, [](const NoiseSpectrum& spectrum) { return spectrum.line_variance > 0.0; });
  const Scoring scoring(bins, size, {.line = any_line});
  std::vector<double> log_likelihoods;
  log_likelihoods.reserve(spectra.size());
  for (const NoiseSpectrum& spectrum : spectra) {
    log_likelihoods.push_back(scoring.log_likelihood(spectrum));
  }
  const auto most = std::ranges::max_element(log_likelihoods) - log_likelihoods.begin();
  return spectra[static_cast<std::size_t>(most)];
}

NoiseSpectrum rough_spectrum(std::span<const SpectralBin> bins) {
  const SpectralBin& highest = bins.back();
  double slow = 0.0;
  double weights = 0.0;
  for (const SpectralBin& bin : bins.first(std::min<std::size_t>(bins.size(), 12))) {
    slow += bin.mean_square * bin.sine;
    weights += 1.0;
  }
  return {.white_variance = 0.7 * highest.mean_square, .flicker_variance = slow / weights};
}

namespace {

constexpr double kBinGrowth = 1.03;
constexpr double kShareOfEnd = 0.1;  // bin width over the coefficients up to the last one in it
constexpr std::size_t kFewestInEnd = 8;

/// Width of a bin that begins at a coefficient, so that it does not blur a line.
std::size_t width_near(std::size_t line, std::size_t first) {
  if (line == 0) return std::numeric_limits<std::size_t>::max() / 2;
  const std::size_t distance = line > first ? line - first : first - line;
  return std::max<std::size_t>(1, distance / 10);
}

}  // namespace

std::vector<SpectralBin> bin_coefficients(std::span<const double> coefficients, std::size_t line) {
  const std::size_t n = coefficients.size();
  std::vector<SpectralBin> bins;
  for (std::size_t first = 1; first < n;) {
    const auto grown = static_cast<std::size_t>(static_cast<double>(first) * kBinGrowth);
    const bool single = first <= kSingleBins;
    const auto end_width = std::max(
        kFewestInEnd, static_cast<std::size_t>(kShareOfEnd * static_cast<double>(n - first)));
    const std::size_t end = single ? first + 1
                                   : std::min({std::max(grown, first + 1), first + end_width,
                                               first + width_near(line, first), n});
    const double sum = sum_of_squares(coefficients.subspan(first, end - first));
    const auto count = static_cast<double>(end - first);
    const double centre = 0.5 * static_cast<double>(first + end - 1);
    const double sine = 2.0 * std::sin(0.5 * std::numbers::pi * centre / static_cast<double>(n));
    bins.push_back({sine, sum / count, count, single ? first : 0});
    first = end;
  }
  return bins;
}

void update_bins(std::span<SpectralBin> bins, std::span<const double> coefficients,
                 std::size_t end) {
  std::size_t first = 1;
  for (SpectralBin& bin : bins) {
    if (first >= end) return;
    const auto count = static_cast<std::size_t>(bin.count);
    bin.mean_square = sum_of_squares(coefficients.subspan(first, count)) / bin.count;
    first += count;
  }
}

}  // namespace zerorate::diagnose
