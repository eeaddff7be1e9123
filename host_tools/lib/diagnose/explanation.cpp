#include "host_tools/lib/diagnose/explanation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "host_tools/lib/simulate/random_stream.hpp"
#include "host_tools/lib/spectrum/real_fft.hpp"

namespace zerorate::diagnose {
namespace {

constexpr int kMostRounds = 8;
constexpr double kConverged = 0.02;  // nats

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Standard deviation of white noise from the differences of good neighbours.
double rough_sigma(const std::vector<double>& values, const std::vector<bool>& bad) {
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t k = 1; k < values.size(); ++k) {
    if (bad[k] || bad[k - 1]) continue;
    const double step = values[k] - values[k - 1];
    squares += step * step;
    count += 1.0;
  }
  return std::sqrt(0.5 * squares / std::max(count, 1.0));
}

/// The straight line across a hole [first, end) between the good values on both sides.
class Bridge {
 public:
  Bridge(const std::vector<double>& values, const std::vector<bool>& bad, std::size_t first,
         std::size_t end)
      : first_(first), width_(static_cast<double>(end - first + 1)) {
    for (std::size_t k = first; k-- > 0 && before_.count < kReach;) before_.add(values[k], bad[k]);
    for (std::size_t k = end; k < values.size() && after_.count < kReach; ++k) {
      after_.add(values[k], bad[k]);
    }
  }

  [[nodiscard]] double at(std::size_t k) const {
    if (before_.count == 0) return after_.mean();
    if (after_.count == 0) return before_.mean();
    const double share = static_cast<double>(k - first_ + 1) / width_;
    return (1.0 - share) * before_.mean() + share * after_.mean();
  }

 private:
  static constexpr std::size_t kReach = 8;
  struct Side {
    double sum = 0.0;
    std::size_t count = 0;
    void add(double value, bool bad) {
      if (bad) return;
      sum += value;
      ++count;
    }
    [[nodiscard]] double mean() const {
      return count == 0 ? 0.0 : sum / static_cast<double>(count);
    }
  };

  std::size_t first_;
  double width_;
  Side before_;
  Side after_;
};

double normal_share_below(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// A normal number; beyond the end of the range where the measured value lies at that end.
double draw_beyond(const Range& range, double measured, double mean, double sigma, double uniform) {
  double lo = 0.0;
  double hi = 1.0;
  if (measured >= range.hi) lo = normal_share_below((range.hi - mean) / sigma);
  if (measured <= range.lo) hi = normal_share_below((range.lo - mean) / sigma);
  const double share = std::clamp(lo + uniform * (hi - lo), 1e-15, 1.0 - 1e-15);
  return mean + sigma * simulate::normal_quantile(share);
}

double overlap(const Column& a, const Column& b, const std::vector<double>& density) {
  double sum = 0.0;
  const std::size_t end = std::min(a.end(), b.end());
  for (std::size_t k = std::max(a.first, b.first); k < end; ++k) {
    sum += a.coefficients[k - a.first] * b.coefficients[k - b.first] / density[k];
  }
  return sum;
}

double overlap(const Column& a, const std::vector<double>& c, const std::vector<double>& density) {
  double sum = 0.0;
  for (std::size_t k = a.first; k < a.end(); ++k) {
    sum += a.coefficients[k - a.first] * c[k] / density[k];
  }
  return sum;
}

}  // namespace

Problem::Problem(const EvenSeries& series, std::uint64_t seed)
    : series_(&series),
      transform_(spectrum::fast_length_below(series.size())),
      sines_(transform_.length()),
      seed_(seed) {
  const std::size_t n = transform_.length();
  rate_.assign(series.rate_rad_s.begin(),
               series.rate_rad_s.begin() + static_cast<std::ptrdiff_t>(n));
  median_ = median_of(rate_);
  for (double& rate : rate_) rate -= median_;
  for (std::size_t k = 0; k < n; ++k) {
    sines_[k] =
        2.0 * std::sin(0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
  }
}

std::vector<double> Problem::measured() const {
  std::vector<double> values;
  for (std::size_t k = 0; k < size(); ++k) {
    if (!series_->lost[k]) values.push_back(rate_[k]);
  }
  return values;
}

Explanation::Explanation(const Problem& problem, std::vector<Part> parts, const Explanation* before)
    : problem_(&problem), parts_(std::move(parts)) {
  for (const Part& part : parts_) terms_ = terms_ | part.terms;
  replace_values();
  fit(before);
}

std::size_t Explanation::first_amplitude(std::size_t part) const {
  std::size_t first = 0;
  for (std::size_t i = 0; i < part; ++i) first += parts_[i].columns.size();
  return first;
}

/// What is lost or disturbed becomes what its neighbours let expect, with noise of their size, so
/// that the spectrum of the whole stays what it was.
void Explanation::replace_values() {
  const std::size_t n = problem_->size();
  const std::vector<double>& rate = problem_->rate_rad_s();
  clean_ = rate;
  mark_replaced();
  if (std::ranges::find(is_replaced_, true) == is_replaced_.end()) return;
  Range clipped;
  for (const Part& part : parts_) {
    clipped = {std::max(clipped.lo, part.clipped.lo), std::min(clipped.hi, part.clipped.hi)};
  }
  const double sigma = rough_sigma(rate, is_replaced_);
  const simulate::RandomStream noise =
      simulate::RandomStream(problem_->seed()).substream("replaced values");
  for (std::size_t first = 0; first < n; ++first) {
    if (!is_replaced_[first]) continue;
    const auto end = static_cast<std::size_t>(
        std::find(is_replaced_.begin() + static_cast<std::ptrdiff_t>(first), is_replaced_.end(),
                  false) -
        is_replaced_.begin());
    const Bridge bridge(rate, is_replaced_, first, end);
    for (std::size_t k = first; k < end; ++k) {
      const double uniform = noise.uniform(static_cast<std::int64_t>(k));
      clean_[k] = draw_beyond(clipped, rate[k], bridge.at(k), sigma, uniform);
    }
    first = end;
  }
}

void Explanation::mark_replaced() {
  const std::size_t n = problem_->size();
  const std::vector<bool>& lost = problem_->series().lost;
  is_replaced_.assign(lost.begin(), lost.begin() + static_cast<std::ptrdiff_t>(n));
  for (const Part& part : parts_) {
    for (const Run& run : part.replaced) {
      for (std::size_t k = run.first; k < std::min(run.end, n); ++k) is_replaced_[k] = true;
    }
  }
}

void Explanation::fit(const Explanation* before) {
  std::vector<double> coefficients = problem_->transform().forward(clean_);
  coefficients[0] = 0.0;
  residual_ = coefficients;
  std::vector<SpectralBin> bins = bin_coefficients(residual_);
  std::vector<NoiseSpectrum> starts;
  if (before != nullptr) starts.push_back(before->noise().spectrum);
  const NoiseSpectrum rough = rough_spectrum(bins);
  for (const double factor : {1.0, 1e-2}) {
    starts.push_back(rough);
    starts.back().flicker_variance *= factor;
  }
  for (const Part& part : parts_)
    starts.insert(starts.end(), part.starts.begin(), part.starts.end());

  const bool has_columns =
      std::ranges::any_of(parts_, [](const Part& p) { return !p.columns.empty(); });
  if (has_columns && before != nullptr) {
    noise_ = before->noise();
  } else {
    noise_ = fit_spectrum(bins, problem_->size(), terms_, starts);
  }
  update_density();
  if (!has_columns) return;
  double reached = -std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMostRounds; ++round) {
    fit_amplitudes(coefficients);
    bins = bin_coefficients(residual_);
    if (round > 0) starts = {noise_.spectrum};
    noise_ = fit_spectrum(bins, problem_->size(), terms_, starts);
    update_density();
    if (noise_.log_likelihood - reached < kConverged) break;
    reached = noise_.log_likelihood;
  }
}

void Explanation::fit_amplitudes(const std::vector<double>& coefficients) {
  std::vector<const Column*> columns;
  for (const Part& part : parts_) {
    for (const Column& column : part.columns) columns.push_back(&column);
  }
  const auto count = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd normal(count, count);
  Eigen::VectorXd right(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Column& column = *columns[static_cast<std::size_t>(i)];
    right(i) = overlap(column, coefficients, density_);
    for (Eigen::Index j = 0; j <= i; ++j) {
      normal(i, j) = normal(j, i) =
          overlap(column, *columns[static_cast<std::size_t>(j)], density_);
    }
  }
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  scaled.diagonal().array() += 1e-10;
  covariance_ = scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
  amplitudes_ = covariance_ * right;
  residual_ = coefficients;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const Column& column = *columns[i];
    const double amplitude = amplitudes_(static_cast<Eigen::Index>(i));
    for (std::size_t k = column.first; k < column.end(); ++k) {
      residual_[k] -= amplitude * column.coefficients[k - column.first];
    }
  }
}

void Explanation::update_density() {
  const std::vector<double>& sines = problem_->sines();
  const std::size_t n = sines.size();
  density_.resize(n);
  density_[0] = std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (std::size_t k = 1; k < n; ++k) {
    density_[k] = noise_.spectrum.density(sines[k], k, n);
    sum += 1.0 / density_[k];
  }
  information_ = sum / static_cast<double>(n);
  whitened_.clear();
  weighted_.clear();
}

const std::vector<double>& Explanation::whitened() const {
  if (whitened_.empty()) {
    std::vector<double> flat(residual_.size());
    for (std::size_t k = 1; k < flat.size(); ++k) flat[k] = residual_[k] / std::sqrt(density_[k]);
    whitened_ = problem_->transform().inverse(flat);
  }
  return whitened_;
}

Explanation::FastResidual Explanation::fast_residual() const {
  const NoiseSpectrum& all = noise_.spectrum;
  const NoiseSpectrum white{.white_variance = all.white_variance,
                            .low_pass_share = all.low_pass_share};
  std::vector<double> flat(residual_.size());
  double kept = 0.0;
  for (std::size_t k = 1; k < flat.size(); ++k) {
    if (white.density(problem_->sines()[k], 0, flat.size()) < 0.5 * density_[k]) continue;
    flat[k] = residual_[k] / std::sqrt(density_[k]);
    kept += 1.0;
  }
  const double share = kept / static_cast<double>(flat.size());
  constexpr double kTooLittle = 0.1;
  if (share < kTooLittle) return {whitened(), 1.0};
  FastResidual fast{problem_->transform().inverse(flat), share};
  for (double& value : fast.values) value /= std::sqrt(share);
  return fast;
}

const std::vector<double>& Explanation::weighted() const {
  if (weighted_.empty()) {
    std::vector<double> divided(residual_.size());
    for (std::size_t k = 1; k < divided.size(); ++k) divided[k] = residual_[k] / density_[k];
    weighted_ = problem_->transform().inverse(divided);
  }
  return weighted_;
}

}  // namespace zerorate::diagnose
