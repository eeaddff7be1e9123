#include "host_tools/lib/diagnose/effects/mean_scan.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "host_tools/lib/diagnose/effects/spectral.hpp"
#include "host_tools/lib/spectrum/real_fft.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kDrawnPoints = 1500;

std::vector<double> divided(const std::vector<double>& c, const std::vector<double>& density) {
  std::vector<double> result(c.size());
  for (std::size_t k = 1; k < c.size(); ++k) result[k] = c[k] / density[k];
  return result;
}

/// Sums of all values from each position on.
std::vector<double> tail_sums(const std::vector<double>& values) {
  std::vector<double> sums(values.size());
  double sum = 0.0;
  for (std::size_t j = values.size(); j-- > 0;) sums[j] = sum += values[j];
  return sums;
}

std::vector<double> dense(const Column& column, std::size_t size) {
  std::vector<double> coefficients(size);
  std::ranges::copy(column.coefficients,
                    coefficients.begin() + static_cast<std::ptrdiff_t>(column.first));
  return coefficients;
}

std::vector<double> without_first(std::vector<double> coefficients) {
  coefficients.erase(coefficients.begin());
  return coefficients;
}

/// How many coefficients, from 1 on, a slow function has.
std::size_t slow_coefficients(const Problem& problem) {
  return problem.block() == 1 ? problem.size() - 1 : problem.size() / problem.block() / 2;
}

/// The lower half of the coefficients of one value a block, as those of a record.
std::vector<double> of_blocks(const Problem& problem, std::span<const double> values) {
  std::vector<double> coefficients = without_first(problem.block_transform().forward(values));
  coefficients.resize(slow_coefficients(problem));
  const double scale = std::sqrt(static_cast<double>(problem.block()));
  for (double& c : coefficients) c *= scale;
  return coefficients;
}

}  // namespace

Column column_of(const Problem& problem, std::span<const double> values) {
  if (problem.block() == 1) return {1, without_first(problem.transform().forward(values))};
  const std::size_t block = problem.block();
  const auto width = static_cast<double>(block);
  std::vector<double> means(problem.size() / block);
  for (std::size_t i = 0; i < means.size(); ++i) {
    for (std::size_t k = i * block; k < (i + 1) * block; ++k) means[i] += values[k] / width;
  }
  std::vector<double> coefficients = of_blocks(problem, means);
  // What averaging has taken away.
  for (std::size_t k = 1; k <= coefficients.size(); ++k) {
    const double half =
        0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(problem.size());
    coefficients[k - 1] *= width * std::sin(half) / std::sin(width * half);
  }
  return {1, std::move(coefficients)};
}

Column column_of(const Problem& problem, const std::function<double(double)>& function) {
  const std::size_t block = problem.block();
  const double centre_s = 0.5 * static_cast<double>(block - 1) * problem.period_s();
  std::vector<double> values(problem.size() / block);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = function(problem.time_s(i * block) + centre_s);
  }
  return {1, of_blocks(problem, values)};
}

Column fast_column_of(const Problem& problem, const std::function<double(double)>& function) {
  std::vector<double> values(problem.size());
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = function(problem.time_s(k));
  return {1, without_first(problem.transform().forward(values))};
}

Column step_column(const Problem& problem, std::size_t first) {
  const auto n = static_cast<double>(problem.size());
  const double turn = std::numbers::pi * static_cast<double>(first) / n;
  Column column{1, std::vector<double>(slow_coefficients(problem))};
  for (std::size_t k = 1; k < column.end(); ++k) {
    column.coefficients[k - 1] =
        -std::sqrt(2.0 / n) * std::sin(turn * static_cast<double>(k)) / problem.sines()[k];
  }
  return column;
}

std::pair<Column, Column> tone_columns(const Problem& problem, double cycles) {
  // Geometric series of e^(i w t) cos(theta_k (t + 1/2)): with x = n w / 2 their sum is
  // e^(i w (n-1)/2) (sin x or i cos x) (1 / sin((w + theta) / 2) + 1 / sin((w - theta) / 2)) / 2.
  const auto n = static_cast<double>(problem.size());
  double place = 2.0 * n * cycles;  // of the tone among the coefficients
  constexpr double kLeastDistance = 1e-4;
  if (std::abs(place - std::round(place)) < kLeastDistance) {
    place = std::round(place) + kLeastDistance;
  }
  const double half = 0.5 * std::numbers::pi * place / n;
  const double x = 0.5 * std::numbers::pi * place;
  const std::complex<double> even = std::polar(std::sin(x) / std::sqrt(2.0 * n), half * (n - 1.0));
  const std::complex<double> odd =
      std::polar(std::cos(x) / std::sqrt(2.0 * n), half * (n - 1.0) + 0.5 * std::numbers::pi);
  constexpr std::size_t kReach = 32'768;
  const auto centre = static_cast<std::size_t>(place);
  const std::size_t first = centre > kReach ? centre - kReach : 1;
  const std::size_t end = std::min(problem.size(), centre + kReach);
  Column cosine{first, {}};
  Column sine{first, {}};
  cosine.coefficients.reserve(end - first);
  sine.coefficients.reserve(end - first);
  for (std::size_t k = first; k < end; ++k) {
    const double theta = 0.5 * std::numbers::pi * static_cast<double>(k) / n;
    const double leak = 1.0 / std::sin(half + theta) + 1.0 / std::sin(half - theta);
    const std::complex<double> c = leak * (k % 2 == 0 ? even : odd);
    cosine.coefficients.push_back(c.real());
    sine.coefficients.push_back(c.imag());
  }
  return {std::move(cosine), std::move(sine)};
}

Column decay_column(const Problem& problem, double tau_s) {
  // A geometric series.
  const auto n = static_cast<double>(problem.size());
  const double samples = tau_s / problem.period_s();
  const double lost = -std::expm1(-1.0 / samples);
  const double end = std::exp(-n / samples);
  Column column{1, std::vector<double>(slow_coefficients(problem))};
  for (std::size_t k = 1; k < column.end(); ++k) {
    const double square = problem.sines()[k] * problem.sines()[k];
    const double ends = k % 2 == 0 ? 1.0 - end : 1.0 + end;
    column.coefficients[k - 1] = std::sqrt(2.0 / n) * ends * lost * std::sqrt(1.0 - 0.25 * square) /
                                 (lost * lost + (1.0 - lost) * square);
  }
  return column;
}

MeanScan::MeanScan(const Explanation& explanation)
    : MeanScan(explanation, explanation.parts().size()) {}

MeanScan::MeanScan(const Explanation& explanation, std::size_t part) : explanation_(&explanation) {
  Eigen::Index amplitude = 0;
  for (std::size_t i = 0; i < explanation.parts().size(); ++i) {
    for (const Column& column : explanation.parts()[i].columns) {
      const double size = explanation.amplitudes()(amplitude++);
      if (i != part) {
        others_.push_back(&column);
        continue;
      }
      if (!is_changed_) residual_ = explanation.residual();
      is_changed_ = true;
      for (std::size_t k = column.first; k < column.end(); ++k) {
        residual_[k] += size * column.coefficients[k - column.first];
      }
    }
  }
  const auto count = static_cast<Eigen::Index>(others_.size());
  Eigen::MatrixXd normal(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      normal(i, j) = normal(j, i) =
          product(*others_[static_cast<std::size_t>(i)], *others_[static_cast<std::size_t>(j)]);
    }
  }
  others_covariance_ =
      count > 0 ? Eigen::MatrixXd(normal.completeOrthogonalDecomposition().pseudoInverse())
                : normal;
  others_products_.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    others_products_(i) = product_with_residual(*others_[static_cast<std::size_t>(i)]);
  }
}

const std::vector<double>& MeanScan::weighted() const {
  if (!is_changed_) return explanation_->weighted();
  if (weighted_.empty()) weighted_ = problem().transform().inverse(divided(residual_, density()));
  return weighted_;
}

double MeanScan::product(const Column& a, const Column& b) const {
  double sum = 0.0;
  const std::size_t end = std::min(a.end(), b.end());
  for (std::size_t k = std::max(a.first, b.first); k < end; ++k) {
    sum += a.coefficients[k - a.first] * b.coefficients[k - b.first] / density()[k];
  }
  return sum;
}

double MeanScan::product_with_residual(const Column& column) const {
  const std::vector<double>& residual = this->residual();
  double sum = 0.0;
  for (std::size_t k = column.first; k < column.end(); ++k) {
    sum += column.coefficients[k - column.first] * residual[k] / density()[k];
  }
  return sum;
}

Eigen::VectorXd MeanScan::beside(const Column& column) const {
  Eigen::VectorXd products(static_cast<Eigen::Index>(others_.size()));
  for (std::size_t i = 0; i < others_.size(); ++i) {
    products(static_cast<Eigen::Index>(i)) = product(*others_[i], column);
  }
  return products;
}

double MeanScan::information(const Column& column) const {
  const Eigen::VectorXd b = beside(column);
  return product(column, column) - b.dot(others_covariance_ * b);
}

double MeanScan::gain(std::span<const Column> columns) const {
  const auto count = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd normal(count, count);
  Eigen::VectorXd right(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Column& column = columns[static_cast<std::size_t>(i)];
    const Eigen::VectorXd projected = others_covariance_ * beside(column);
    right(i) = product_with_residual(column);
    for (Eigen::Index o = 0; o < projected.size(); ++o) {
      right(i) -= projected(o) * others_products_(o);
    }
    for (Eigen::Index j = 0; j <= i; ++j) {
      const Column& second = columns[static_cast<std::size_t>(j)];
      normal(i, j) = normal(j, i) = product(column, second) - projected.dot(beside(second));
    }
  }
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  scaled.diagonal().array() += 1e-9;
  const Eigen::VectorXd normalised = scale.cwiseProduct(right);
  return 0.5 * normalised.dot(scaled.ldlt().solve(normalised));
}

const std::vector<double>& MeanScan::step_information() const {
  if (!step_information_.empty()) return step_information_;
  // A step before value j has the coefficients -sqrt(2/n) sin(pi k j / n) / s_k.
  const std::size_t n = problem().size();
  std::vector<double> strength(n);
  double total = 0.0;
  for (std::size_t k = 1; k < n; ++k) {
    const double sine = problem().sines()[k];
    strength[k] = 1.0 / (static_cast<double>(n) * sine * sine * density()[k]);
    total += strength[k];
  }
  const spectrum::RealFft& fft = problem().transform().fourier();
  std::vector<std::complex<double>> bins(fft.bins());
  fft.forward(strength, bins);
  step_information_.resize(n);
  for (std::size_t j = 0; j < n; ++j) {
    step_information_[j] = total - bins[std::min(j, n - j)].real();
  }
  return step_information_;
}

std::vector<double> MeanScan::step_gains() const {
  const std::size_t n = problem().size();
  const std::vector<double>& information = step_information();
  const std::vector<double> sums = tail_sums(weighted());
  std::vector<std::vector<double>> beside;
  beside.reserve(others_.size());
  for (const Column* other : others_) {
    beside.push_back(
        tail_sums(problem().transform().inverse(divided(dense(*other, n), density()))));
  }
  std::vector<double> gains(n);
  constexpr std::size_t kEdge = 8;
  Eigen::VectorXd b(static_cast<Eigen::Index>(others_.size()));
  for (std::size_t j = kEdge; j + kEdge < n; ++j) {
    for (std::size_t i = 0; i < others_.size(); ++i) b(static_cast<Eigen::Index>(i)) = beside[i][j];
    const double left = information[j] - (others_.empty() ? 0.0 : b.dot(others_covariance_ * b));
    if (left > 1e-3 * information[j]) gains[j] = 0.5 * sums[j] * sums[j] / left;
  }
  return gains;
}

double MeanScan::step_crossings() const {
  const std::vector<double>& information = step_information();
  double sum = 0.0;
  for (std::size_t j = 2; j + 2 < information.size(); ++j) {
    const double a = information[j];
    const double b = information[j + 1];
    const double correlation = 0.5 * (a + b - explanation_->information()) / std::sqrt(a * b);
    sum += std::sqrt(std::max(0.0, 2.0 * (1.0 - correlation)));
  }
  return sum / std::numbers::pi;
}

std::optional<Offer> offer_of_mean(const Explanation& without, const MeanSearch& search) {
  std::optional<FittedOffer> fitted = fitted_offer_of_mean(without, search);
  if (!fitted) return std::nullopt;
  return std::move(fitted->offer);
}

std::optional<FittedOffer> fitted_offer_of_mean(const Explanation& without,
                                                const MeanSearch& search) {
  std::optional<FittedOffer> best;
  std::optional<Part> part = search(MeanScan(without));
  for (int round = 0; part && round < 2; ++round) {
    std::vector<Part> parts = without.parts();
    parts.push_back(*part);
    const std::size_t last = parts.size() - 1;
    const Explanation with(without.problem(), std::move(parts), &without);
    const double gain = with.log_likelihood() - without.log_likelihood();
    if (!best || gain > best->offer.gain_nats) best = {Offer{std::move(*part), gain, 0.0}, with};
    if (round == 0) part = search(MeanScan(with, last));
  }
  return best;
}

double shape_error(const Found& found, const Column& derivative) {
  const double information = MeanScan(found.all).information(derivative);
  return 1.0 / std::sqrt(std::max(information, 1e-300));
}

Drawing drawing_of(const Found& found) {
  const Problem& problem = found.all.problem();
  std::vector<double> coefficients(problem.size());
  for (std::size_t i = 0; i < found.part().columns.size(); ++i) {
    const Column& column = found.part().columns[i];
    for (std::size_t k = column.first; k < column.end(); ++k) {
      coefficients[k] += found.amplitude(i) * column.coefficients[k - column.first];
    }
  }
  const std::vector<double> mean = problem.transform().inverse(coefficients);
  const std::vector<double>& rate = problem.rate_rad_s();
  const double level = problem.median_rad_s() + std::accumulate(rate.begin(), rate.end(), 0.0) /
                                                    static_cast<double>(rate.size());
  Drawing drawing{.effect = std::string(found.part().effect)};
  const std::size_t step = std::max<std::size_t>(1, mean.size() / kDrawnPoints);
  for (std::size_t k = 0; k < mean.size(); k += step) {
    drawing.curve.push_back({problem.series().time_s(k), level + mean[k]});
  }
  return drawing;
}

}  // namespace zerorate::diagnose
