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
constexpr std::size_t kReach = 8;    // values on each side that a hole is filled from

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Standard deviation of white noise from the differences of neighbours, most of which are good.
double rough_sigma(const std::vector<double>& values) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < values.size(); ++k) {
    steps.push_back(std::abs(values[k] - values[k - 1]));
  }
  return median_of(std::move(steps)) / (0.6745 * std::numbers::sqrt2);
}

/// The mean of the good values next to a hole; `step` is +1 or -1.
std::pair<double, double> level_beside(const std::vector<double>& values,
                                       const std::vector<bool>& bad, std::size_t from, bool after) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < 8 * kReach && count < static_cast<double>(kReach); ++i) {
    if (after ? from + i >= values.size() : i >= from) break;
    const std::size_t k = after ? from + i : from - 1 - i;
    if (bad[k]) continue;
    sum += values[k];
    count += 1.0;
  }
  return {count > 0.0 ? sum / count : 0.0, count};
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
  clean_ = problem_->rate_rad_s();
  is_replaced_.assign(problem_->series().lost.begin(),
                      problem_->series().lost.begin() + static_cast<std::ptrdiff_t>(n));
  bool any = problem_->series().lost_count > 0;
  for (const Part& part : parts_) {
    for (const Run& run : part.replaced) {
      any = true;
      for (std::size_t k = run.first; k < std::min(run.end, n); ++k) is_replaced_[k] = true;
    }
  }
  if (!any) return;
  const double sigma = rough_sigma(problem_->rate_rad_s());
  const simulate::RandomStream noise =
      simulate::RandomStream(problem_->seed()).substream("replaced values");
  for (std::size_t k = 0; k < n; ++k) {
    if (!is_replaced_[k]) continue;
    std::size_t end = k;
    while (end < n && is_replaced_[end]) ++end;
    const auto [before, count_before] =
        level_beside(problem_->rate_rad_s(), is_replaced_, k, false);
    const auto [after, count_after] = level_beside(problem_->rate_rad_s(), is_replaced_, end, true);
    for (std::size_t i = k; i < end; ++i) {
      const double share = static_cast<double>(i - k + 1) / static_cast<double>(end - k + 1);
      const double weight_before = count_before > 0.0 ? 1.0 - share : 0.0;
      const double weight_after = count_after > 0.0 ? share : 0.0;
      const double weight = std::max(weight_before + weight_after, 1e-9);
      clean_[i] = (weight_before * before + weight_after * after) / weight +
                  sigma * noise.normal(static_cast<std::int64_t>(i));
    }
    k = end;
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

const std::vector<double>& Explanation::weighted() const {
  if (weighted_.empty()) {
    std::vector<double> divided(residual_.size());
    for (std::size_t k = 1; k < divided.size(); ++k) divided[k] = residual_[k] / density_[k];
    weighted_ = problem_->transform().inverse(divided);
  }
  return weighted_;
}

}  // namespace zerorate::diagnose
