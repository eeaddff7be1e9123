#include "host_tools/lib/diagnose/hypothesis/column_search.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::diagnose {
namespace {

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
    equations_.add(products_with_others(*other), inner(*other, *other, precision()));
    others_products_.push_back(inner(*other, residual(), precision()));
  }
}

const std::vector<double>& ColumnSearch::precision_weighted_residual() const {
  if (!is_changed_) return hypothesis_->precision_weighted_residual();
  if (precision_weighted_residual_.empty()) {
    precision_weighted_residual_ = hypothesis_->precision_weighted(residual_);
  }
  return precision_weighted_residual_;
}

std::vector<double> ColumnSearch::products_with_others(const Column& column) const {
  std::vector<double> products;
  for (std::size_t i = 0; i < equations_.size(); ++i) {
    products.push_back(inner(*others_[i], column, precision()));
  }
  return products;
}

double ColumnSearch::information(const Column& column) const {
  const std::vector<double> others = equations_.coordinates(products_with_others(column));
  return inner(column, column, precision()) - sum_of_squares(others);
}

double ColumnSearch::gain(std::span<const Column> columns) const {
  NormalEquations equations = equations_;
  std::vector<double> with_residual = others_products_;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    std::vector<double> products = products_with_others(columns[i]);
    for (std::size_t j = 0; j < i; ++j) {
      products.push_back(inner(columns[i], columns[j], precision()));
    }
    equations.add(products, inner(columns[i], columns[i], precision()));
    with_residual.push_back(inner(columns[i], residual(), precision()));
  }
  const std::vector<double> coordinates = equations.coordinates(with_residual);
  return 0.5 * sum_of_squares(std::span(coordinates).subspan(others_.size()));
}

const std::vector<double>& ColumnSearch::step_information() const {
  if (!step_information_.empty()) return step_information_;
  // A step before value j has the coefficients -sqrt(2/n) sin(pi k j / n) / s_k.
  const std::size_t n = data().size();
  const std::vector<double>& precision = this->precision();
  std::vector<double> strength(n);
  double total = 0.0;
  for (std::size_t k = 1; k < n; ++k) {
    const double sine = data().sines()[k];
    strength[k] = precision[k] / (static_cast<double>(n) * sine * sine);
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
    beside.push_back(tail_sums(hypothesis_->precision_weighted(dense(*other, n))));
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

ColumnPursuit::ColumnPursuit(const ColumnSearch& search, std::vector<Column> candidates)
    : search_(&search), equations_(search.equations_), with_residual_(search.others_products_) {
  candidates_.reserve(candidates.size());
  for (Column& column : candidates) {
    candidates_.push_back({.products = search.products_with_others(column),
                           .own = inner(column, column, search.precision()),
                           .with_residual = inner(column, search.residual(), search.precision())});
    candidates_.back().column = std::move(column);
  }
}

double ColumnPursuit::gain(const Candidate& candidate) const {
  NormalEquations with = equations_;
  with.add(candidate.products, candidate.own);
  std::vector<double> with_residual = with_residual_;
  with_residual.push_back(candidate.with_residual);
  const double coordinate = with.coordinates(with_residual).back();
  return 0.5 * coordinate * coordinate;
}

ColumnPursuit::Best ColumnPursuit::best() const {
  Best best;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (candidates_[i].is_chosen) continue;
    const double gain = this->gain(candidates_[i]);
    if (gain > best.gain) best = {i, gain};
  }
  return best;
}

void ColumnPursuit::choose(std::size_t candidate) {
  Candidate& chosen = candidates_[candidate];
  chosen.is_chosen = true;
  equations_.add(chosen.products, chosen.own);
  with_residual_.push_back(chosen.with_residual);
  for (Candidate& other : candidates_) {
    if (other.is_chosen) continue;
    other.products.push_back(inner(chosen.column, other.column, search_->precision()));
  }
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
