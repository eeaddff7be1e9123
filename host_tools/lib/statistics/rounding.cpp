#include "host_tools/lib/statistics/rounding.hpp"

#include <cmath>
#include <numbers>

namespace zerorate::statistics {

double mean_before_rounding(double mean, double sigma) {
  using std::numbers::pi;
  constexpr double kSmooth = 0.6;  // rounding moves means by less than 3e-4 steps
  if (sigma > kSmooth) return mean;
  const auto after = [sigma](double x) {
    double sum = x;
    double sign = -1.0;
    for (int k = 1; k <= 12; ++k) {
      const double ratio = pi * k * sigma;
      sum += sign / (pi * k) * std::exp(-2.0 * ratio * ratio) * std::sin(2.0 * pi * k * x);
      sign = -sign;
    }
    return sum;
  };
  double lo = mean - 0.5;
  double hi = mean + 0.5;
  constexpr int kBits = 12;
  for (int i = 0; i < kBits; ++i) {
    const double middle = 0.5 * (lo + hi);
    (after(middle) < mean ? lo : hi) = middle;
  }
  return 0.5 * (lo + hi);
}

}  // namespace zerorate::statistics
