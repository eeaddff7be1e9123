/// @file
/// Tail probabilities, order statistics, the bootstrap, and the mean of rounded values.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/statistics/half_width.hpp"

namespace zerorate::statistics {

/// log P of a standard normal beyond |z|, both sides.
[[nodiscard]] double log_normal_tails(double z);
/// P of chi squared above x, which must not be negative.
[[nodiscard]] double chi_squared_tail(double x, double freedom);
/// log P of chi squared above x.
[[nodiscard]] double log_chi_squared_tail(double x, double freedom);
/// log P of chi squared below x.
[[nodiscard]] double log_chi_squared_lower_tail(double x, double freedom);
/// log P of Student's t above t.
[[nodiscard]] double log_student_tail(double t, double freedom);
/// log P of chi squared as far from its middle as x, both sides.
[[nodiscard]] double log_chi_squared_tails(double x, double freedom);
/// log P of a Poisson number of at least `count`.
[[nodiscard]] double log_poisson_tail(double count, double mean);
/// log P of lengths as even as these, were they exponential, as waits for independent events are:
/// the test of [Bartlett 1937] at its lower end.
/// @param groups  lengths, all above 0; each group has a mean of its own
[[nodiscard]] double log_p_of_even_lengths(std::span<const std::vector<double>> groups);
/// P that a group of `own` precedes the `others`, drawn alike, in at most 0, 1, ... pairs, up to
/// half of all: exact at either end (Mann and Whitney 1947). Cost: own * own * others.
[[nodiscard]] std::vector<double> rank_sum_tail(std::size_t own, std::size_t others);
/// The smallest of `places` such probabilities, at least.
[[nodiscard]] double log_of_smallest(double log_p, double places);
/// Chi squared made standard normal (Wilson and Hilferty 1931).
[[nodiscard]] double normal_of_chi_squared(double x, double freedom);

/// A gain by `parameters` free amplitudes, 2 G ~ chi squared (Wilks).
[[nodiscard]] double surprisal_of_free(double gain_nats, double parameters);

/// A gain by one strength that cannot be negative: half of the time 0 (Self and Liang 1987).
[[nodiscard]] double surprisal_of_strength(double gain_nats);

/// The greatest gain over a searched parameter, which crosses a level upwards `crossings` e^(-G)
/// times on average (Davies 1987), beside the probability at a single place.
/// @param parameters of the amplitudes, 1 or 2
[[nodiscard]] double surprisal_of_search(double gain_nats, double parameters, double crossings);

/// Probability of a standard normal above z.
[[nodiscard]] inline double normal_tail(double z) {
  return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

/// Density of a standard normal at z.
[[nodiscard]] inline double normal_density(double z) {
  return std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
}

/// A sum of logarithms, taken of products: one logarithm for some twenty numbers.
class SumOfLogs {
 public:
  /// @param x  positive, between 1e-150 and 1e150
  void add(double x) {
    product_ *= x;
    if (product_ > 1e-150 && product_ < 1e150) return;
    sum_ += std::log(product_);
    product_ = 1.0;
  }
  [[nodiscard]] double value() const { return sum_ + std::log(product_); }

 private:
  double sum_ = 0.0;
  double product_ = 1.0;
};

/// Median; of an even number of values the upper one of the middle two. Linear in their number.
/// @param values  at least one
[[nodiscard]] inline double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Quantile p of values in increasing order, interpolated between neighbours (position p (n - 1)).
/// @param sorted  at least one
/// @param p  from 0 to 1
[[nodiscard]] inline double quantile_of_sorted(std::span<const double> sorted, double p) {
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], place - static_cast<double>(below));
}

/// log(p / (1 - p)), p in (0, 1).
[[nodiscard]] inline double logit(double share) {
  return std::log(share / (1.0 - share));
}

/// Share whose logit is given.
[[nodiscard]] inline double share_of_logit(double logit) {
  return 1.0 / (1.0 + std::exp(-logit));
}

/// Means before rounding to whole numbers, of values with a standard deviation of `sigma` steps:
/// rounding adds sum over k of (-1)^k / (pi k) exp(-2 (pi k sigma)^2) sin(2 pi k x) to a mean x
/// (Widrow and Kollar 2008).
class MeanBeforeRounding {
 public:
  explicit MeanBeforeRounding(double sigma);

  /// The mean before rounding of which `mean` is the mean after it, to 1e-4 steps.
  [[nodiscard]] double operator()(double mean) const;

 private:
  static constexpr std::size_t kMostTerms = 12;
  std::array<double, kMostTerms> factors_{};
  std::size_t terms_ = 0;  ///< none where rounding moves means by less than 3e-4 steps
};

/// A figure and its 95 % interval by the bootstrap; NaN where there was nothing to measure.
struct BootstrapFigure {
  double value = std::numeric_limits<double>::quiet_NaN();
  double lo = std::numeric_limits<double>::quiet_NaN();
  double hi = std::numeric_limits<double>::quiet_NaN();
};

/// Computed from the data with these indices, which may repeat.
using Statistic = std::function<double(const std::vector<std::size_t>& indices)>;

struct BootstrapParams {
  std::size_t draws = 2000;
  /// Neighbours that depend on each other are drawn together, so many at a time, around the end
  /// (Politis and Romano 1992); 1: all are independent.
  std::size_t block = 1;
};

/// The statistic of all indices below `size`, and its interval over draws with replacement: between
/// the order statistics that leave 2.5 % at either end. No figure (NaN) where the statistic is NaN.
[[nodiscard]] BootstrapFigure bootstrap(std::size_t size, const Statistic& statistic,
                                        const random::RandomStream& stream,
                                        const BootstrapParams& params = {});

}  // namespace zerorate::statistics
