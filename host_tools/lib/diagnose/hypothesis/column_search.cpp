#include "host_tools/lib/diagnose/hypothesis/column_search.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::diagnose {
namespace {

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

}  // namespace

ColumnSearch::ColumnSearch(const Hypothesis& hypothesis)
    : ColumnSearch(hypothesis, hypothesis.parts().size()) {}

ColumnSearch::ColumnSearch(const Hypothesis& hypothesis, std::size_t part)
    : hypothesis_(&hypothesis) {
  std::size_t amplitude = 0;
  for (std::size_t i = 0; i < hypothesis.parts().size(); ++i) {
    for (const Column& column : hypothesis.parts()[i].columns) {
      const double size = hypothesis.amplitudes()[amplitude++];
      if (i != part) {
        others_.push_back(&column);
        continue;
      }
      if (!is_changed_) residual_ = hypothesis.residual();
      is_changed_ = true;
      for (std::size_t k = column.first; k < column.end(); ++k) {
        residual_[k] += size * column.coefficients[k - column.first];
      }
    }
  }
  for (const Column* other : others_) {
    equations_.add(products_with_others(*other), inner(*other, *other, density()));
    others_products_.push_back(inner(*other, residual(), density()));
  }
}

const std::vector<double>& ColumnSearch::precision_weighted_residual() const {
  if (!is_changed_) return hypothesis_->precision_weighted_residual();
  if (precision_weighted_residual_.empty())
    precision_weighted_residual_ = data().transform().inverse(divided(residual_, density()));
  return precision_weighted_residual_;
}

std::vector<double> ColumnSearch::products_with_others(const Column& column) const {
  std::vector<double> products;
  for (std::size_t i = 0; i < equations_.size(); ++i) {
    products.push_back(inner(*others_[i], column, density()));
  }
  return products;
}

double ColumnSearch::information(const Column& column) const {
  const std::vector<double> others = equations_.coordinates(products_with_others(column));
  return inner(column, column, density()) - sum_of_squares(others);
}

double ColumnSearch::gain(std::span<const Column> columns) const {
  NormalEquations equations = equations_;
  std::vector<double> with_residual = others_products_;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    std::vector<double> products = products_with_others(columns[i]);
    for (std::size_t j = 0; j < i; ++j) {
      products.push_back(inner(columns[i], columns[j], density()));
    }
    equations.add(products, inner(columns[i], columns[i], density()));
    with_residual.push_back(inner(columns[i], residual(), density()));
  }
  const std::vector<double> coordinates = equations.coordinates(with_residual);
  return 0.5 * sum_of_squares(std::span(coordinates).subspan(others_.size()));
}

const std::vector<double>& ColumnSearch::step_information() const {
  if (!step_information_.empty()) return step_information_;
  // A step before value j has the coefficients -sqrt(2/n) sin(pi k j / n) / s_k.
  const std::size_t n = data().size();
  const std::vector<double>& density = this->density();
  std::vector<double> strength(n);
  double total = 0.0;
  for (std::size_t k = 1; k < n; ++k) {
    const double sine = data().sines()[k];
    strength[k] = 1.0 / (static_cast<double>(n) * sine * sine * density[k]);
    total += strength[k];
  }
  const spectrum::RealFft& fft = data().transform().fourier();
  std::vector<std::complex<double>> bins(fft.bins());
  fft.forward(strength, bins);
  step_information_.resize(n);
  for (std::size_t j = 0; j < n; ++j) {
    step_information_[j] = total - bins[std::min(j, n - j)].real();
  }
  return step_information_;
}

std::vector<double> ColumnSearch::step_gains() const {
  const std::size_t n = data().size();
  const std::vector<double>& information = step_information();
  const std::vector<double> sums = tail_sums(precision_weighted_residual());
  std::vector<std::vector<double>> beside;
  beside.reserve(others_.size());
  for (const Column* other : others_) {
    beside.push_back(tail_sums(data().transform().inverse(divided(dense(*other, n), density()))));
  }
  std::vector<double> gains(n);
  constexpr std::size_t kEdge = 8;
  std::vector<double> products(others_.size());
  for (std::size_t j = kEdge; j + kEdge < n; ++j) {
    for (std::size_t i = 0; i < others_.size(); ++i) products[i] = beside[i][j];
    const double left = information[j] - sum_of_squares(equations_.coordinates(products));
    if (left > 1e-3 * information[j]) gains[j] = 0.5 * sums[j] * sums[j] / left;
  }
  return gains;
}

double ColumnSearch::step_crossings() const {
  const std::vector<double>& information = step_information();
  double sum = 0.0;
  for (std::size_t j = 2; j + 2 < information.size(); ++j) {
    const double a = information[j];
    const double b = information[j + 1];
    const double correlation = 0.5 * (a + b - hypothesis_->mean_precision()) / std::sqrt(a * b);
    sum += std::sqrt(std::max(0.0, 2.0 * (1.0 - correlation)));
  }
  return sum / std::numbers::pi;
}

std::optional<MeanFit> fit_mean(const Hypothesis& without, const MeanSearch& search) {
  std::optional<MeanFit> best;
  std::optional<Part> part = search(ColumnSearch(without));
  for (int round = 0; part && round < 2; ++round) {
    const Hypothesis with = without.with(*part);
    const double gain = with.log_likelihood() - without.log_likelihood();
    if (!best || gain > best->gain_nats) best = {std::move(*part), gain, with};
    if (round == 0) part = search(ColumnSearch(with, without.parts().size()));
  }
  return best;
}

}  // namespace zerorate::diagnose
