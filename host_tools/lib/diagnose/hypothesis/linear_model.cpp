#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::diagnose {

namespace {

Eigen::Map<const Eigen::ArrayXd> array(std::span<const double> values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

}  // namespace

double inner(const Column& x, const Column& y, std::span<const double> precision) {
  const std::size_t first = std::max(x.first, y.first);
  const std::size_t end = std::min(x.end(), y.end());
  if (first >= end) return 0.0;
  const auto between = [&](std::span<const double> values, std::size_t offset) {
    return array(values.subspan(first - offset, end - first));
  };
  return (between(x.coefficients, x.first) * between(y.coefficients, y.first) *
          between(precision, 0))
      .sum();
}

double inner(const Column& x, std::span<const double> coefficients,
             std::span<const double> precision) {
  const std::size_t size = x.coefficients.size();
  return (array(x.coefficients) * array(coefficients.subspan(x.first, size)) *
          array(precision.subspan(x.first, size)))
      .sum();
}

double sum_of_squares(std::span<const double> x) {
  return array(x).square().sum();
}

void NormalEquations::add(std::span<const double> products, double own) {
  Row row{.factor = coordinates(products), .own = own};
  const double left = own - sum_of_squares(row.factor);
  row.factor.push_back(left > kLeastShare * own ? std::sqrt(left) : 0.0);
  rows_.push_back(std::move(row));
}

std::vector<double> NormalEquations::coordinates(std::span<const double> products) const {
  std::vector<double> x(products.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::vector<double>& factor = rows_[i].factor;
    if (factor[i] == 0.0) continue;
    double left = products[i];
    for (std::size_t j = 0; j < i; ++j) left -= factor[j] * x[j];
    x[i] = left / factor[i];
  }
  return x;
}

std::vector<double> NormalEquations::amplitudes(std::span<const double> products) const {
  std::vector<double> x = coordinates(products);
  for (std::size_t i = size(); i-- > 0;) {
    if (rows_[i].factor[i] == 0.0) continue;
    for (std::size_t j = i + 1; j < size(); ++j) x[i] -= rows_[j].factor[i] * x[j];
    x[i] /= rows_[i].factor[i];
  }
  return x;
}

std::vector<double> NormalEquations::variances() const {
  std::vector<double> variances(size());
  std::vector<double> unit(size());
  for (std::size_t i = 0; i < size(); ++i) {
    unit[i] = 1.0;
    variances[i] = rows_[i].factor[i] == 0.0 ? 1.0 / (kLeastShare * rows_[i].own)
                                             : sum_of_squares(coordinates(unit));
    unit[i] = 0.0;
  }
  return variances;
}

namespace {

std::vector<double> without_first(std::vector<double> coefficients) {
  coefficients.erase(coefficients.begin());
  return coefficients;
}

/// How many coefficients, from 1 on, a slow function has.
std::size_t slow_coefficients(const FitData& data) {
  return data.block() == 1 ? data.size() - 1 : data.size() / data.block() / 2;
}

/// The lower half of the coefficients of one value a block, as those of a record.
std::vector<double> of_blocks(const FitData& data, std::span<const double> values) {
  std::vector<double> coefficients = without_first(data.block_transform().forward(values));
  coefficients.resize(slow_coefficients(data));
  const double scale = std::sqrt(static_cast<double>(data.block()));
  for (double& c : coefficients) c *= scale;
  return coefficients;
}

}  // namespace

Column column_of(const FitData& data, std::span<const double> values) {
  if (data.block() == 1) return {1, without_first(data.transform().forward(values))};
  const std::size_t block = data.block();
  const auto width = static_cast<double>(block);
  std::vector<double> means(data.size() / block);
  for (std::size_t i = 0; i < means.size(); ++i) {
    for (std::size_t k = i * block; k < (i + 1) * block; ++k) means[i] += values[k] / width;
  }
  std::vector<double> coefficients = of_blocks(data, means);
  // Undo the attenuation by averaging.
  for (std::size_t k = 1; k <= coefficients.size(); ++k) {
    const double half =
        0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(data.size());
    coefficients[k - 1] *= width * std::sin(half) / std::sin(width * half);
  }
  return {1, std::move(coefficients)};
}

Column column_of(const FitData& data, const std::function<double(double)>& function) {
  const std::size_t block = data.block();
  const double centre_s = 0.5 * static_cast<double>(block - 1) * data.period_s();
  std::vector<double> values(data.size() / block);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = function(data.time_s(i * block) + centre_s);
  }
  return {1, of_blocks(data, values)};
}

Column fast_column_of(const FitData& data, const std::function<double(double)>& function) {
  std::vector<double> values(data.size());
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = function(data.time_s(k));
  return {1, without_first(data.transform().forward(values))};
}

Column step_column(const FitData& data, std::size_t first) {
  const auto n = static_cast<double>(data.size());
  const double turn = std::numbers::pi * static_cast<double>(first) / n;
  Column column{1, std::vector<double>(slow_coefficients(data))};
  for (std::size_t k = 1; k < column.end(); ++k) {
    column.coefficients[k - 1] =
        -std::sqrt(2.0 / n) * std::sin(turn * static_cast<double>(k)) / data.sines()[k];
  }
  return column;
}

std::pair<Column, Column> tone_columns(const FitData& data, double cycles) {
  // Geometric series of e^(i w t) cos(theta_k (t + 1/2)): with x = n w / 2 their sum is
  // e^(i w (n-1)/2) (sin x or i cos x) (1 / sin((w + theta) / 2) + 1 / sin((w - theta) / 2)) / 2.
  const auto n = static_cast<double>(data.size());
  double place = 2.0 * n * cycles;  // place of the tone among the coefficients
  constexpr double kLeastDistance = 1e-4;
  if (std::abs(place - std::round(place)) < kLeastDistance) {
    place = std::round(place) + kLeastDistance;
  }
  const double half = 0.5 * std::numbers::pi * place / n;
  const double x = 0.5 * std::numbers::pi * place;
  const double root = std::sqrt(2.0 * n);
  const std::complex<double> even = std::sin(x) / root * std::polar(1.0, half * (n - 1.0));
  const std::complex<double> odd =
      std::cos(x) / root * std::polar(1.0, half * (n - 1.0) + 0.5 * std::numbers::pi);
  constexpr std::size_t kReach = 32'768;
  const auto centre = static_cast<std::size_t>(place);
  const std::size_t first = centre > kReach ? centre - kReach : 1;
  const std::size_t end = std::min(data.size(), centre + kReach);
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

namespace {

/// Coefficients 1 .. count of the decay from value `first` on: a geometric series. With the angle w
/// of a coefficient and r = e^(-1 / tau), the sum of r^t cos(w (first + t + 1/2)) over the values
/// that are left is (1 - r) cos(w (first - 1/2)) - 2 sin(w / 2) sin(w first), less what the decay
/// would have beyond the record, over |1 - r e^(iw)|^2.
Column decay_from(const FitData& data, double tau_s, std::size_t first, std::size_t count) {
  const auto n = static_cast<double>(data.size());
  const double samples = tau_s / data.period_s();
  const double lost = -std::expm1(-1.0 / samples);
  const double end = std::exp(-static_cast<double>(data.size() - first) / samples);
  const auto sines = array(data.sines()).segment(1, static_cast<Eigen::Index>(count));
  const Eigen::ArrayXd cosines = (1.0 - 0.25 * sines.square()).sqrt();  // cosines of w / 2
  Column column{1, std::vector<double>(count)};
  Eigen::Map<Eigen::ArrayXd> sums(column.coefficients.data(), cosines.size());
  if (first == 0) {
    sums = lost * cosines;
  } else {
    const std::complex<double> turn =
        std::polar(1.0, std::numbers::pi * static_cast<double>(first) / n);
    std::complex<double> at_first = turn;  // e^(i w first)
    for (Eigen::Index k = 0; k < sums.size(); ++k) {
      const double before = at_first.real() * cosines(k) + 0.5 * at_first.imag() * sines(k);
      sums(k) = lost * before - sines(k) * at_first.imag();
      at_first = spectrum::product(at_first, turn);
    }
  }
  double beyond = -end * lost;
  for (Eigen::Index k = 0; k < sums.size(); ++k, beyond = -beyond) sums(k) -= beyond * cosines(k);
  sums *= std::sqrt(2.0 / n) / (lost * lost + (1.0 - lost) * sines.square());
  return column;
}

}  // namespace

Column decay_column(const FitData& data, double tau_s) {
  return decay_from(data, tau_s, 0, slow_coefficients(data));
}

Column fast_decay_column(const FitData& data, double tau_s, std::size_t first) {
  return decay_from(data, tau_s, first, data.size() - 1);
}

Column column_of_values(const FitData& values, const FitData& means,
                        const Column& column_of_means) {
  std::vector<double> coefficients(means.size());
  std::ranges::copy(column_of_means.coefficients,
                    coefficients.begin() + static_cast<std::ptrdiff_t>(column_of_means.first));
  const std::vector<double> middles = means.transform().inverse(coefficients);
  const double count = means.period_s() / values.period_s();
  std::vector<double> function(values.size());
  for (std::size_t k = 0; k < function.size(); ++k) {
    // On the straight line through the neighbouring means, also beyond the first and the last.
    const double place = (static_cast<double>(k) + 0.5) / count - 0.5;
    const auto last = static_cast<double>(middles.size() - 2);
    const auto low = static_cast<std::size_t>(std::clamp(std::floor(place), 0.0, last));
    const double share = place - static_cast<double>(low);
    function[k] = (1.0 - share) * middles[low] + share * middles[low + 1];
  }
  return column_of(values, function);
}

std::vector<double> mean_coefficients(const Hypothesis& hypothesis) {
  std::vector<double> mean(hypothesis.data().size());
  std::size_t amplitude = 0;
  for (const Part& part : hypothesis.parts()) {
    for (const Column& column : part.columns) {
      const double size = hypothesis.amplitudes()[amplitude++];
      for (std::size_t k = column.first; k < column.end(); ++k) {
        mean[k] += size * column.coefficients[k - column.first];
      }
    }
  }
  return mean;
}

}  // namespace zerorate::diagnose
