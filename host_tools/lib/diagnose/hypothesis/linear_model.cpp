#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"

#include <algorithm>
#include <cmath>

namespace zerorate::diagnose {

double inner(const Column& x, const Column& y, std::span<const double> density) {
  double sum = 0.0;
  const std::size_t end = std::min(x.end(), y.end());
  for (std::size_t k = std::max(x.first, y.first); k < end; ++k) {
    sum += x.coefficients[k - x.first] * y.coefficients[k - y.first] / density[k];
  }
  return sum;
}

double inner(const Column& x, std::span<const double> coefficients,
             std::span<const double> density) {
  double sum = 0.0;
  for (std::size_t k = x.first; k < x.end(); ++k) {
    sum += x.coefficients[k - x.first] * coefficients[k] / density[k];
  }
  return sum;
}

double sum_of_squares(std::span<const double> x) {
  double sum = 0.0;
  for (const double value : x) sum += value * value;
  return sum;
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

}  // namespace zerorate::diagnose
