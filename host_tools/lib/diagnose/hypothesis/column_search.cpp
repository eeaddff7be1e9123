#include "host_tools/lib/diagnose/hypothesis/column_search.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "host_tools/lib/spectrum/real_fft.hpp"

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

}  // namespace zerorate::diagnose
