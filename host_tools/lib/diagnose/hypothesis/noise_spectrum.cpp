#include "host_tools/lib/diagnose/hypothesis/noise_spectrum.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host_tools/lib/diagnose/hypothesis/noise_density.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kBinGrowth = 1.03;
constexpr double kShareOfEnd = 0.1;  // of the coefficients up to the last one, in a bin
constexpr std::size_t kFewestInEnd = 8;
constexpr double kLowestOrder = 0.05;
constexpr double kHighestOrder = 0.97;
constexpr double kShortestMarkov = 0.5;  // samples
constexpr double kLongestMarkov = 0.25;  // of the record
constexpr double kWeakest = 1e-12;       // of the mean square: as good as nothing
constexpr int kMostIterations = 60;
constexpr double kConverged = 1e-5;     // nats
constexpr double kBroadestLine = 0.25;  // half its width at half its power, of its frequency
/// The same of the narrowest: what the nodes of Explanation::density() still follow.
constexpr double kNarrowestLine = 1e-3;
/// Of the record. A line that has lost its phase only a few times is no other than a sweep.
constexpr double kLongestLine = 0.025;

using Vector = SpectrumSlope;
using Matrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostParameters, kMostParameters>;

/// Of a bin that begins at a coefficient, so that it does not blur a line.
std::size_t width_near(std::size_t line, std::size_t first) {
  if (line == 0) return std::numeric_limits<std::size_t>::max() / 2;
  const std::size_t distance = line > first ? line - first : first - line;
  return std::max<std::size_t>(1, distance / 10);
}

double sum_of_squares(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return sum;
}

double logit(double share) {
  return std::log(share / (1.0 - share));
}
double share_of(double logit) {
  return 1.0 / (1.0 + std::exp(-logit));
}

class Scoring {
 public:
  Scoring(std::span<const SpectralBin> bins, std::size_t size, const NoiseTerms& terms)
      : bins_(bins), size_(size), terms_(terms) {
    places_.reserve(bins.size());
    double sum = 0.0;
    double count = 0.0;
    for (const SpectralBin& bin : bins) {
      sum += bin.count * bin.mean_square;
      count += bin.count;
      places_.emplace_back(bin.sine, bin.index, size, bin.count, terms.line);
    }
    mean_square_ = sum / count;
  }

  [[nodiscard]] SpectrumFit maximise(NoiseSpectrum start) const {
    if (!terms_.free_order) set_order(terms_.given_order.value_or(kOrderOfBase), start);
    Vector theta = pack(start);
    Vector gradient;
    Matrix information;
    double value = evaluate(theta, start, gradient, information);
    double damping = 1e-3;
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
        damping = std::max(1e-9, damping * 0.1);
        if (converged) break;
      } else {
        damping = std::max(damping * 10.0, 1e-3);
        if (damping > 1e6) break;
      }
    }
    SpectrumFit fit{.spectrum = unpack(theta, start), .log_likelihood = value};
    information.diagonal().array() += 1e-9;
    fit.errors =
        name_errors(information.inverse().diagonal().cwiseMax(0.0).cwiseSqrt(), fit.spectrum);
    return fit;
  }

 private:
  /// Another order, the flicker noise as strong as before where it usually meets the white noise.
  static void set_order(double order, NoiseSpectrum& spectrum) {
    constexpr double kPivot = 0.05;  // a sine
    spectrum.flicker_variance *= std::pow(kPivot, 2.0 * (order - spectrum.order));
    spectrum.order = order;
  }

  [[nodiscard]] double weakest() const { return kWeakest * mean_square_; }

  [[nodiscard]] Vector pack(const NoiseSpectrum& s) const {
    Vector theta(kMostParameters);
    Eigen::Index i = 0;
    theta(i++) = std::log(std::max(s.white_variance, weakest()));
    theta(i++) = std::log(std::max(s.flicker_variance, weakest()));
    if (terms_.free_order) theta(i++) = s.order;
    if (terms_.random_walk) theta(i++) = std::log(std::max(s.walk_variance, weakest() * 1e-6));
    if (terms_.gauss_markov) {
      theta(i++) = std::log(std::max(s.markov_variance, weakest()));
      theta(i++) = std::log(s.markov_samples);
    }
    if (terms_.line) {
      theta(i++) = std::log(std::max(s.line_variance, weakest()));
      theta(i++) = logit(std::clamp(s.line_angle / std::numbers::pi, 1e-6, 1.0 - 1e-6));
      theta(i++) = std::log(s.line_samples);
    }
    if (terms_.low_pass) theta(i++) = logit(std::clamp(s.low_pass_share, 1e-3, 0.999));
    theta.conservativeResize(i);
    return bounded(theta);
  }

  /// @param start  for what is not fitted
  [[nodiscard]] NoiseSpectrum unpack(const Vector& theta, const NoiseSpectrum& start) const {
    NoiseSpectrum s{.rounding_variance = start.rounding_variance};
    Eigen::Index i = 0;
    s.white_variance = std::exp(theta(i++));
    s.flicker_variance = std::exp(theta(i++));
    s.order = terms_.free_order ? theta(i++) : start.order;
    if (terms_.random_walk) s.walk_variance = std::exp(theta(i++));
    if (terms_.gauss_markov) {
      s.markov_variance = std::exp(theta(i++));
      s.markov_samples = std::exp(theta(i++));
    }
    if (terms_.line) {
      s.line_variance = std::exp(theta(i++));
      s.line_angle = std::numbers::pi * share_of(theta(i++));
      s.line_samples = std::exp(theta(i++));
    }
    if (terms_.low_pass) {
      s.low_pass_share = share_of(theta(i++));
      s.low_pass_order = start.low_pass_order;
    }
    return s;
  }

  [[nodiscard]] NoiseErrors name_errors(const Vector& errors, const NoiseSpectrum& spectrum) const {
    NoiseErrors named;
    Eigen::Index i = 0;
    named.log_white_variance = errors(i++);
    named.log_flicker_variance = errors(i++);
    if (terms_.free_order) named.order = errors(i++);
    if (terms_.random_walk) named.log_walk_variance = errors(i++);
    if (terms_.gauss_markov) {
      named.log_markov_variance = errors(i++);
      named.log_markov_samples = errors(i++);
    }
    if (terms_.line) {
      const double share = spectrum.line_angle / std::numbers::pi;
      named.log_line_variance = errors(i++);
      named.line_angle = errors(i++) * spectrum.line_angle * (1.0 - share);
      named.log_line_samples = errors(i++);
    }
    if (terms_.low_pass) named.logit_low_pass_share = errors(i++);
    return named;
  }

  [[nodiscard]] Vector bounded(Vector theta) const {
    const double floor = std::log(weakest());
    Eigen::Index i = 0;
    theta(0) = std::max(theta(0), floor);
    theta(1) = std::max(theta(1), floor);
    i = 2;
    if (terms_.free_order) {
      theta(i) = std::clamp(theta(i), kLowestOrder, kHighestOrder);
      ++i;
    }
    if (terms_.random_walk) {
      theta(i) = std::max(theta(i), floor - 14.0);
      ++i;
    }
    if (terms_.gauss_markov) {
      theta(i) = std::max(theta(i), floor);
      theta(i + 1) = std::clamp(theta(i + 1), std::log(kShortestMarkov),
                                std::log(kLongestMarkov * static_cast<double>(size_)));
      i += 2;
    }
    if (terms_.line) {
      theta(i) = std::max(theta(i), floor);
      theta(i + 1) = std::clamp(theta(i + 1), -14.0, 14.0);
      const double angle = std::numbers::pi * share_of(theta(i + 1));
      const double shortest = 1.0 / (kBroadestLine * angle);
      const double longest =
          std::min(1.0 / (kNarrowestLine * angle), kLongestLine * static_cast<double>(size_));
      theta(i + 2) =
          std::clamp(theta(i + 2), std::log(std::min(shortest, longest)), std::log(longest));
      i += 3;
    }
    if (terms_.low_pass) theta(i) = std::clamp(theta(i), -8.0, 8.0);
    return theta;
  }

  /// The log likelihood, its gradient and the expected information.
  double evaluate(const Vector& theta, const NoiseSpectrum& start, Vector& gradient,
                  Matrix& information) const {
    const NoiseSpectrum spectrum = unpack(theta, start);
    const DensityFactors factors(spectrum);
    gradient = Vector::Zero(theta.size());
    information = Matrix::Zero(theta.size(), theta.size());
    Vector slope(theta.size());
    double value = 0.0;
    for (std::size_t b = 0; b < bins_.size(); ++b) {
      const SpectralBin& bin = bins_[b];
      const NoiseDensity density(factors, places_[b]);
      const double total = density.total();
      const double excess = bin.mean_square / total;
      value -= 0.5 * bin.count * (std::log(total) + excess);
      density.derivatives(terms_, slope);
      gradient += 0.5 * bin.count * (excess - 1.0) * slope;
      information.noalias() += 0.5 * bin.count * slope * slope.transpose();
    }
    return value;
  }

  std::span<const SpectralBin> bins_;
  std::vector<SpectralPlace> places_;  ///< of the bins
  std::size_t size_;
  NoiseTerms terms_;
  double mean_square_ = 0.0;
};

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

}  // namespace zerorate::diagnose
