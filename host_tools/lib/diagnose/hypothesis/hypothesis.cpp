#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "host_tools/lib/diagnose/hypothesis/noise_density.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/spectrum/real_fft.hpp"

namespace zerorate::diagnose {
namespace {

constexpr int kMostRounds = 8;
constexpr double kConverged = 0.02;  // nats
constexpr std::size_t kFewestBlocks = 65'536;
constexpr std::size_t kDensityNodes = 2048;  // in each octave

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
  return mean + sigma * random::normal_quantile(share);
}

/// The greatest divisor of a length that leaves enough blocks, an even number of them.
std::size_t block_of(std::size_t size) {
  std::size_t block = std::max<std::size_t>(1, size / kFewestBlocks);
  while (size % (2 * block) != 0) --block;
  return block;
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
      block_(block_of(transform_.length())),
      sines_(transform_.length()),
      seed_(seed) {
  const std::size_t n = transform_.length();
  rate_.assign(series.rate_rad_s.begin(),
               series.rate_rad_s.begin() + static_cast<std::ptrdiff_t>(n));
  lost_ = std::make_shared<const std::vector<bool>>(
      series.lost.begin(), series.lost.begin() + static_cast<std::ptrdiff_t>(n));
  median_ = median_of(rate_);
  for (double& rate : rate_) rate -= median_;
  for (std::size_t k = 0; k < n; ++k) {
    sines_[k] =
        2.0 * std::sin(0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
  }
  if (block_ > 1) block_transform_.emplace(n / block_);
  if (!series.is_ticks) lattice_ = find_lattice(measured());
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
  mark_replaced();
  const bool is_as_before =
      before != nullptr && clipped() == before->clipped() &&
      (is_replaced_ == before->is_replaced_ || is_replaced() == before->is_replaced());
  if (is_as_before) {
    clean_ = before->clean_;
    coefficients_ = before->coefficients_;
  } else {
    transform_clean();
  }
  fit(before);
}

Explanation::Explanation(const Problem& problem, std::vector<Part> parts,
                         std::vector<double> density)
    : problem_(&problem), parts_(std::move(parts)) {
  density[0] = std::numeric_limits<double>::infinity();
  density_ = std::make_shared<const std::vector<double>>(std::move(density));
  mark_replaced();
  transform_clean();
  residual_ = coefficients_;
  if (!columns().empty()) {
    fit_amplitudes();
    const auto residual = std::make_shared<std::vector<double>>(*coefficients_);
    subtract_means(*residual);
    residual_ = residual;
  }
  noise_.log_likelihood = log_likelihood_of_coefficients();
}

void Explanation::transform_clean() {
  clean_ = std::make_shared<const std::vector<double>>(replace_values());
  std::vector<double> coefficients = problem_->transform().forward(*clean_);
  coefficients[0] = 0.0;
  coefficients_ = std::make_shared<const std::vector<double>>(std::move(coefficients));
}

double Explanation::log_likelihood_of_coefficients() const {
  double sum = 0.0;
  for (std::size_t k = 1; k < residual().size(); ++k) {
    sum += std::log(density()[k]) + residual()[k] * residual()[k] / density()[k];
  }
  return -0.5 * sum;
}

std::size_t Explanation::first_amplitude(std::size_t part) const {
  std::size_t first = 0;
  for (std::size_t i = 0; i < part; ++i) first += parts_[i].columns.size();
  return first;
}

Range Explanation::clipped() const {
  Range range;
  for (const Part& part : parts_) {
    range = {std::max(range.lo, part.clipped.lo), std::min(range.hi, part.clipped.hi)};
  }
  return range;
}

/// What is lost or disturbed becomes what its neighbours let expect, with noise of their size, so
/// that the spectrum of the whole stays what it was.
std::vector<double> Explanation::replace_values() const {
  const std::size_t n = problem_->size();
  const std::vector<double>& rate = problem_->rate_rad_s();
  std::vector<double> clean = rate;
  const std::vector<bool>& is_replaced = this->is_replaced();
  if (std::ranges::find(is_replaced, true) == is_replaced.end()) return clean;
  const Range range = clipped();
  const double sigma = rough_sigma(rate, is_replaced);
  const random::RandomStream noise =
      random::RandomStream(problem_->seed()).substream("replaced values");
  for (std::size_t first = 0; first < n; ++first) {
    if (!is_replaced[first]) continue;
    const auto end =
        static_cast<std::size_t>(std::find(is_replaced.begin() + static_cast<std::ptrdiff_t>(first),
                                           is_replaced.end(), false) -
                                 is_replaced.begin());
    const Bridge bridge(rate, is_replaced, first, end);
    for (std::size_t k = first; k < end; ++k) {
      const double uniform = noise.uniform(static_cast<std::int64_t>(k));
      clean[k] = draw_beyond(range, rate[k], bridge.at(k), sigma, uniform);
    }
    first = end;
  }
  return clean;
}

void Explanation::mark_replaced() {
  is_replaced_ = problem_->lost();
  if (std::ranges::all_of(parts_, [](const Part& part) { return part.replaced.empty(); })) return;
  std::vector<bool> is_replaced = *is_replaced_;
  for (const Part& part : parts_) {
    for (const Run& run : part.replaced) {
      for (std::size_t k = run.first; k < std::min(run.end, is_replaced.size()); ++k) {
        is_replaced[k] = true;
      }
    }
  }
  is_replaced_ = std::make_shared<const std::vector<bool>>(std::move(is_replaced));
}

void Explanation::fit(const Explanation* before) {
  residual_ = coefficients_;
  std::vector<SpectralBin> bins = this->bins();
  std::vector<NoiseSpectrum> starts;
  if (before != nullptr) starts.push_back(before->noise().spectrum);
  const NoiseSpectrum rough = rough_spectrum(bins);
  for (const double factor : {1.0, 1e-2}) {
    starts.push_back(rough);
    starts.back().flicker_variance *= factor;
  }
  for (const Part& part : parts_)
    starts.insert(starts.end(), part.starts.begin(), part.starts.end());

  const bool has_columns = !columns().empty();
  if (has_columns && before != nullptr) {
    noise_ = before->noise();
  } else {
    noise_ = fit_spectrum(bins, problem_->size(), terms_, starts);
  }
  if (!has_columns) return;
  const auto residual = std::make_shared<std::vector<double>>(*coefficients_);
  residual_ = residual;
  double reached = -std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMostRounds; ++round) {
    fit_amplitudes();
    subtract_means(*residual);
    update_bins(bins, *residual, end_of_columns());
    if (round > 0) starts = {noise_.spectrum};
    noise_ = fit_spectrum(bins, problem_->size(), terms_, starts);
    if (noise_.log_likelihood - reached < kConverged) break;
    reached = noise_.log_likelihood;
  }
}

/// Fine around the line that a part looks for.
std::vector<SpectralBin> Explanation::bins() const {
  std::size_t line = 0;
  for (const Part& part : parts_) {
    if (!part.terms.line) continue;
    line = static_cast<std::size_t>(part.starts.front().line_angle / std::numbers::pi *
                                    static_cast<double>(problem_->size()));
  }
  return bin_coefficients(*residual_, line);
}

std::vector<const Column*> Explanation::columns() const {
  std::vector<const Column*> columns;
  for (const Part& part : parts_) {
    for (const Column& column : part.columns) columns.push_back(&column);
  }
  return columns;
}

std::size_t Explanation::end_of_columns() const {
  std::size_t end = 0;
  for (const Column* column : columns()) end = std::max(end, column->end());
  return end;
}

void Explanation::fit_amplitudes() {
  const std::vector<const Column*> columns = this->columns();
  const std::vector<double> density = density_below(end_of_columns());
  const auto count = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd normal(count, count);
  Eigen::VectorXd right(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Column& column = *columns[static_cast<std::size_t>(i)];
    right(i) = overlap(column, *coefficients_, density);
    for (Eigen::Index j = 0; j <= i; ++j) {
      normal(i, j) = normal(j, i) = overlap(column, *columns[static_cast<std::size_t>(j)], density);
    }
  }
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  scaled.diagonal().array() += 1e-10;
  covariance_ = scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
  amplitudes_ = covariance_ * right;
}

/// @param residual  above the end of the columns: the coefficients
void Explanation::subtract_means(std::vector<double>& residual) const {
  std::copy_n(coefficients_->begin(), end_of_columns(), residual.begin());
  const std::vector<const Column*> columns = this->columns();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const Column& column = *columns[i];
    const double amplitude = amplitudes_(static_cast<Eigen::Index>(i));
    for (std::size_t k = column.first; k < column.end(); ++k) {
      residual[k] -= amplitude * column.coefficients[k - column.first];
    }
  }
}

/// Above the lowest frequencies the density is so smooth that it is a straight line from one node
/// to the next, to seven digits.
std::vector<double> Explanation::density_below(std::size_t end) const {
  if (density_) return {density_->begin(), density_->begin() + static_cast<std::ptrdiff_t>(end)};
  const std::vector<double>& sines = problem_->sines();
  const std::size_t n = sines.size();
  const DensityFactors factors(noise_.spectrum);
  const auto at = [&](std::size_t k) { return factors.density(sines[k], k, n); };
  std::vector<double> density(end);
  if (end == 0) return density;
  density[0] = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < std::min(end, 2 * kDensityNodes); ++k) density[k] = at(k);
  for (std::size_t first = 2 * kDensityNodes; first < end;) {
    const std::size_t next = std::min(first + first / kDensityNodes, n - 1);
    const double start = at(first);
    const double rise = next > first ? (at(next) - start) / static_cast<double>(next - first) : 0.0;
    const std::size_t last = std::min(next > first ? next : first + 1, end);
    for (std::size_t k = first; k < last; ++k) {
      density[k] = start + rise * static_cast<double>(k - first);
    }
    first = last;
  }
  return density;
}

const std::vector<double>& Explanation::density() const {
  if (!density_) {
    density_ = std::make_shared<const std::vector<double>>(density_below(problem_->size()));
  }
  return *density_;
}

double Explanation::information() const {
  if (!information_) {
    double sum = 0.0;
    for (std::size_t k = 1; k < problem_->size(); ++k) sum += 1.0 / density()[k];
    information_ = sum / static_cast<double>(problem_->size());
  }
  return *information_;
}

const std::vector<double>& Explanation::whitened() const {
  if (!whitened_) {
    std::vector<double> flat(residual().size());
    for (std::size_t k = 1; k < flat.size(); ++k) flat[k] = residual()[k] / std::sqrt(density()[k]);
    whitened_ = std::make_shared<const std::vector<double>>(problem_->transform().inverse(flat));
  }
  return *whitened_;
}

const std::vector<double>& Explanation::weighted() const {
  if (!weighted_) {
    std::vector<double> divided(residual().size());
    for (std::size_t k = 1; k < divided.size(); ++k) divided[k] = residual()[k] / density()[k];
    weighted_ = std::make_shared<const std::vector<double>>(problem_->transform().inverse(divided));
  }
  return *weighted_;
}

bool Explanation::is_coarse() const {
  if (!problem_->lattice()) return false;
  const double step = problem_->lattice()->step * std::sqrt(information());
  // Rounding adds -step^4 / 120 to the fourth cumulant of values of unit variance. From 1.75 sigma
  // on the variance also depends on where between two levels the bias lies.
  constexpr double kChance = 1.2;  // standard deviations
  constexpr double kMost = 1.75;
  const double chance = std::sqrt(24.0 / static_cast<double>(problem_->size()));
  return step > kMost || std::pow(step, 4.0) / 120.0 > kChance * chance;
}

Explanation::FastResidual Explanation::fast_residual() const {
  const NoiseSpectrum& noise = noise_.spectrum;
  std::vector<double> flat(residual().size());
  double kept = 0.0;
  for (std::size_t k = 1; k < flat.size(); ++k) {
    const double white =
        noise.low_pass_gain(problem_->sines()[k]) * noise.white_variance + noise.rounding_variance;
    if (white < 0.5 * density()[k]) continue;
    flat[k] = residual()[k] / std::sqrt(density()[k]);
    kept += 1.0;
  }
  const double share = kept / static_cast<double>(flat.size());
  constexpr double kTooLittle = 0.1;
  if (share < kTooLittle) return {whitened(), 1.0};
  FastResidual fast{problem_->transform().inverse(flat), share};
  for (double& value : fast.values) value /= std::sqrt(share);
  return fast;
}

}  // namespace zerorate::diagnose
