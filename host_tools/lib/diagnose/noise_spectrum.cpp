#include "host_tools/lib/diagnose/noise_spectrum.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "host_tools/lib/identify/whittle_fit.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kSingleBins = 48;  // coefficients that stand alone, with their exact ratio
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
constexpr int kMostParameters = 10;

using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostParameters, 1>;
using Matrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostParameters, kMostParameters>;

/// dct_power_ratio by interpolation in the order: a table of its integrals.
class RatioTable {
 public:
  static const RatioTable& get() {
    static const RatioTable table;
    return table;
  }
  [[nodiscard]] double operator()(double order, std::size_t index) const {
    if (index == 0 || index > kIndices) return 1.0;
    const double at = std::clamp(order, 0.0, 1.0) * kSteps;
    const std::size_t low = std::min(static_cast<std::size_t>(at), kSteps - 1);
    const double share = at - static_cast<double>(low);
    const auto& row = ratios_[index - 1];
    return (1.0 - share) * row[low] + share * row[low + 1];
  }

 private:
  static constexpr std::size_t kIndices = 16;
  static constexpr std::size_t kSteps = 20;
  RatioTable() {
    for (std::size_t k = 1; k <= kIndices; ++k) {
      for (std::size_t i = 0; i <= kSteps; ++i) {
        const double order = static_cast<double>(i) / static_cast<double>(kSteps);
        ratios_[k - 1][i] = i == kSteps ? 1.0 : identify::dct_power_ratio(order, k);
      }
    }
  }
  std::array<std::array<double, kSteps + 1>, kIndices> ratios_{};
};

/// The same for exp(-a u), a the record in time constants:
/// 2 int_0^1 e^(-a u) [(1-u) cos(p u) - sin(p u)/p] du over its nominal value, p = pi k.
double markov_ratio(double record_in_time_constants, std::size_t index) {
  if (index == 0) return 1.0;
  const double a = record_in_time_constants;
  const double p = std::numbers::pi * static_cast<double>(index);
  const std::complex<double> s{a, -p};
  const std::complex<double> whole = (1.0 - std::exp(-s)) / s;
  const std::complex<double> falling = 1.0 / s - whole / s;
  const double exact = 2.0 * (falling.real() - whole.imag() / p);
  return exact * (a * a + p * p) / (2.0 * a);
}

/// One side of a line, whose density at the distance x from its centre is Poisson's kernel,
/// sinh(k) / (cosh(k) - cos(x)), k = 1 / coherence time: its mean over a band, in closed form.
class LineSide {
 public:
  LineSide(double coherence_samples, double distance, double width)
      : decay_(1.0 / coherence_samples),
        coth_(1.0 / std::tanh(0.5 * decay_)),
        lo_(distance - 0.5 * width),
        hi_(distance + 0.5 * width),
        width_(width) {}

  [[nodiscard]] double mean() const { return (integral(hi_) - integral(lo_)) / width_; }
  [[nodiscard]] double slope_of_distance() const { return (kernel(hi_) - kernel(lo_)) / width_; }
  [[nodiscard]] double slope_of_log_coherence() const {
    return decay_ * 0.5 * (coth_ * coth_ - 1.0) * (slope_of_coth(hi_) - slope_of_coth(lo_)) /
           width_;
  }

 private:
  [[nodiscard]] double integral(double x) const {
    const double turns = std::floor(0.5 * x / std::numbers::pi + 0.5);
    return 2.0 * (std::atan(coth_ * std::tan(0.5 * x)) + turns * std::numbers::pi);
  }
  [[nodiscard]] double kernel(double x) const {
    return std::sinh(decay_) / (std::cosh(decay_) - std::cos(x));
  }
  /// d integral / d coth.
  [[nodiscard]] double slope_of_coth(double x) const {
    const double sine = std::sin(0.5 * x);
    const double cosine = std::cos(0.5 * x);
    return 2.0 * sine * cosine / (cosine * cosine + coth_ * coth_ * sine * sine);
  }

  double decay_;
  double coth_;
  double lo_;
  double hi_;
  double width_;
};

/// The parts of a spectrum at one bin and the derivatives of its logarithm.
class Density {
 public:
  /// @param count of the coefficients in the bin
  Density(const NoiseSpectrum& spectrum, double sine, std::size_t index, std::size_t size,
          double count = 1.0)
      : spectrum_(spectrum),
        sine_(sine),
        angle_(2.0 * std::asin(std::min(0.5 * sine, 1.0))),
        width_(std::numbers::pi * count / static_cast<double>(size)) {
    const double d = spectrum.order;
    white_ = spectrum.white_variance;
    flicker_ = spectrum.flicker_variance * std::exp(-2.0 * d * std::log(sine));
    if (index > 0) flicker_ *= RatioTable::get()(d, index);
    walk_ = spectrum.walk_variance / (sine * sine);
    if (spectrum.markov_variance > 0.0) add_markov(index, size);
    if (spectrum.line_variance > 0.0) line_ = spectrum.line_density(angle_, width_);
    pass_ = spectrum.low_pass_gain(sine);
  }

  [[nodiscard]] double total() const {
    return pass_ * inner() + line_ + spectrum_.rounding_variance;
  }

  void derivatives(const NoiseTerms& terms, Vector& slope) const {
    const double share = pass_ / total();
    Eigen::Index i = 0;
    slope(i++) = white_ * share;
    slope(i++) = flicker_ * share;
    if (terms.free_order) slope(i++) = -2.0 * std::log(sine_) * flicker_ * share;
    if (terms.random_walk) slope(i++) = walk_ * share;
    if (terms.gauss_markov) {
      slope(i++) = markov_ * share;
      slope(i++) = markov_ * markov_slope_ * share;
    }
    if (terms.line) {
      const double a = spectrum_.line_angle;
      const LineSide below = line_side(-a);
      const LineSide above = line_side(a);
      const double unit = 0.5 * spectrum_.line_variance / total();
      slope(i++) = line_ / total();
      slope(i++) = unit * (above.slope_of_distance() - below.slope_of_distance()) * a *
                   (1.0 - a / std::numbers::pi);
      slope(i++) = unit * (above.slope_of_log_coherence() + below.slope_of_log_coherence());
    }
    if (terms.low_pass) slope(i++) = low_pass_slope() * inner() * share;
  }

 private:
  [[nodiscard]] double inner() const { return white_ + flicker_ + walk_ + markov_; }

  [[nodiscard]] LineSide line_side(double from) const {
    return {spectrum_.line_samples, angle_ + from, width_};
  }

  /// d log H / d logit a.
  [[nodiscard]] double low_pass_slope() const {
    const double a = spectrum_.low_pass_share;
    if (spectrum_.low_pass_order > 0) {
      return (1.0 - pass_) * 2.0 * spectrum_.low_pass_order * std::numbers::pi * a * (1.0 - a) /
             std::sin(std::numbers::pi * a);
    }
    const double square = sine_ * sine_;
    if (spectrum_.low_pass_order == NoiseSpectrum::kTwoNeighbours) {
      return 0.25 * square * a * (1.0 - a) / pass_;
    }
    return (1.0 - a) * (2.0 - a * (2.0 * a - square) / (a * a + (1.0 - a) * square));
  }

  void add_markov(std::size_t index, std::size_t size) {
    const double tau = spectrum_.markov_samples;
    const double phi = std::exp(-1.0 / tau);
    const double lost = -std::expm1(-1.0 / tau);
    const double bottom = lost * lost + phi * sine_ * sine_;
    const double top = lost * (1.0 + phi);
    markov_ = spectrum_.markov_variance * top / bottom;
    if (index > 0) markov_ *= markov_ratio(static_cast<double>(size) / tau, index);
    // d log / d phi, times d phi / d log tau = phi / tau.
    markov_slope_ = (-2.0 * phi / top + (2.0 * lost - sine_ * sine_) / bottom) * phi / tau;
  }

  const NoiseSpectrum& spectrum_;
  double sine_;
  double angle_;
  double width_;
  double white_ = 0.0;
  double flicker_ = 0.0;
  double walk_ = 0.0;
  double markov_ = 0.0;
  double markov_slope_ = 0.0;
  double line_ = 0.0;
  double pass_ = 1.0;
};

/// Of a bin that begins at a coefficient, so that it does not blur a line.
std::size_t width_near(std::size_t line, std::size_t first) {
  if (line == 0) return std::numeric_limits<std::size_t>::max() / 2;
  const std::size_t distance = line > first ? line - first : first - line;
  return std::max<std::size_t>(1, distance / 10);
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
    double sum = 0.0;
    double count = 0.0;
    for (const SpectralBin& bin : bins) {
      sum += bin.count * bin.mean_square;
      count += bin.count;
    }
    mean_square_ = sum / count;
  }

  [[nodiscard]] SpectrumFit maximise(const NoiseSpectrum& start) const {
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
    if (terms_.free_order) s.order = theta(i++);
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
    gradient = Vector::Zero(theta.size());
    information = Matrix::Zero(theta.size(), theta.size());
    Vector slope(theta.size());
    double value = 0.0;
    for (const SpectralBin& bin : bins_) {
      const Density density(spectrum, bin.sine, bin.index, size_, bin.count);
      const double total = density.total();
      const double excess = bin.mean_square / total;
      value -= 0.5 * bin.count * (std::log(total) + excess);
      density.derivatives(terms_, slope);
      gradient += 0.5 * bin.count * (excess - 1.0) * slope;
      information += 0.5 * bin.count * slope * slope.transpose();
    }
    return value;
  }

  std::span<const SpectralBin> bins_;
  std::size_t size_;
  NoiseTerms terms_;
  double mean_square_ = 0.0;
};

}  // namespace

double NoiseSpectrum::low_pass_gain(double sine) const {
  const double a = low_pass_share;
  const double square = sine * sine;
  if (a >= 1.0) return 1.0;
  if (low_pass_order == kTwoNeighbours) return 1.0 - 0.25 * (1.0 - a) * square;
  if (low_pass_order == kRecursive) return a * a / (a * a + (1.0 - a) * square);
  const double cut_off = std::tan(0.5 * std::numbers::pi * a);
  const double ratio = square / (std::max(4.0 - square, 1e-300) * cut_off * cut_off);
  return 1.0 / (1.0 + std::pow(ratio, low_pass_order));
}

double NoiseSpectrum::line_density(double angle, double width) const {
  return 0.5 * line_variance *
         (LineSide(line_samples, angle - line_angle, width).mean() +
          LineSide(line_samples, angle + line_angle, width).mean());
}

double NoiseSpectrum::density(double sine, std::size_t index, std::size_t size) const {
  return Density(*this, sine, index <= kSingleBins ? index : 0, size).total();
}

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
    double sum = 0.0;
    for (std::size_t k = first; k < end; ++k) sum += coefficients[k] * coefficients[k];
    const auto count = static_cast<double>(end - first);
    const double centre = 0.5 * static_cast<double>(first + end - 1);
    const double sine = 2.0 * std::sin(0.5 * std::numbers::pi * centre / static_cast<double>(n));
    bins.push_back({sine, sum / count, count, single ? first : 0});
    first = end;
  }
  return bins;
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
