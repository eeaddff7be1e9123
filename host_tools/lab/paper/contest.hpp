/// @file
/// Predictors side by side on the same sets: what they were worth, and what is expected of them.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host_tools/lab/paper/predictors.hpp"
#include "host_tools/lab/reference/fractional_noise.hpp"
#include "host_tools/lib/parallel/parallel.hpp"

namespace zerorate::paper {

/// One predictor on one set; error = measured - predicted (the paper's section V).
struct Score {
  double integrated_error = 0.0;  ///< IE: sum of the errors
  double rsse = 0.0;              ///< root of the sum of the squared errors
  double covered = 0.0;           ///< share of the errors within two sigma
  double covered_by_own = 0.0;    ///< within two of the method's own sigma; NaN if it is the same
  double nis = 0.0;               ///< mean over the calibration; not a number if there is none
};

using Predictors = std::vector<std::unique_ptr<Predictor>>;
/// One vector a predictor, one score a set.
using Scores = std::vector<std::vector<Score>>;

/// Puts set first, first + 1, ... into the columns of the block (Lengths::total() rows). Is called
/// by several threads at once.
using SetSource = std::function<void(std::size_t first, Eigen::MatrixXd& block)>;

/// Every predictor on the sets 0 .. sets-1, in blocks of a fixed size: the scores do not depend on
/// the number of threads.
[[nodiscard]] Scores run_contest(const Predictors& predictors, const Lengths& lengths,
                                 std::size_t sets, const SetSource& source, unsigned threads,
                                 const parallel::Progress& progress);

/// A figure and its standard error.
struct Figure {
  double value = 0.0;
  double error = 0.0;
};

/// The paper's Table I of one predictor, and what belongs to it.
struct Standing {
  std::string name;
  Figure mean_ie;
  Figure std_ie;
  Figure mean_rsse;
  Figure std_rsse;
  /// Ratios to the yardstick on the same sets. Their errors are those of paired ratios (delta
  /// method), far smaller than those of the figures themselves.
  Figure ie_ratio;
  Figure rsse_ratio;
  Figure coverage;      ///< coverage of two sigma; 0.9545 if the sigma is right
  Figure own_coverage;  ///< coverage of two of the method's own sigma; NaN without one
  Figure nis;           ///< not a number if the predictor has no innovations
};

/// Needs at least two sets.
[[nodiscard]] Standing make_standing(std::string name, std::span<const Score> scores,
                                     std::span<const Score> yardstick);

/// The ratio of mean RSSE to the yardstick's with less chance: the mean of RSSE^2 is known from the
/// covariance of the noise (trace of error_covariance()), and what a run's RSSE^2 is above it tells
/// nearly all of its luck (control variates, by regression over the sets).
/// @param mean_square expected RSSE^2; nothing for predictors that are not linear, which leaves the
///        yardstick's as the only control
[[nodiscard]] Figure controlled_rsse_ratio(std::span<const Score> scores,
                                           std::optional<double> mean_square,
                                           std::span<const Score> yardstick,
                                           double yardstick_mean_square);

/// From the predictor's weights and the exact covariance of the noise: what the figures of a
/// Standing tend to with ever more sets.
struct Expectation {
  double std_ie = 0.0;
  double mean_rsse = 0.0;
  double std_rsse = 0.0;
  double coverage = 0.0;  ///< coverage of two stated sigma

  [[nodiscard]] double mean_squared_rsse() const {
    return mean_rsse * mean_rsse + std_rsse * std_rsse;
  }
};

/// Time O(length^3); about a second for 1000 + 1000 samples.
/// @param predictor linear, with one sigma for all sets
[[nodiscard]] Expectation expect(const Predictor& predictor,
                                 const reference::FractionalNoise& noise, const Lengths& lengths);

}  // namespace zerorate::paper
