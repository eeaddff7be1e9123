#include "host_tools/lab/paper/contest.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host_tools/lab/reference/fractional_noise.hpp"

namespace zerorate::paper {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kSetsInBlock = 20;

/// The share of errors within two sigma; `sigma` has a column for this run, one for all, or none.
double covered(const VectorXd& error, const MatrixXd& sigma, Index run) {
  if (sigma.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  const auto own = sigma.col(sigma.cols() == 1 ? 0 : run);
  return (error.array().abs() <= 2.0 * own.array()).cast<double>().mean();
}

void score_block(const Predictor& predictor, const MatrixXd& calibration, const MatrixXd& measured,
                 std::span<Score> scores) {
  const Forecasts forecasts = predictor.predict(calibration);
  for (Index run = 0; run < measured.cols(); ++run) {
    const VectorXd error = measured.col(run) - forecasts.bias.col(run);
    const auto i = static_cast<std::size_t>(run);
    scores[i] = {
        .integrated_error = error.sum(),
        .rsse = error.norm(),
        .covered = covered(error, forecasts.sigma, run),
        .covered_by_own = covered(error, forecasts.own_sigma, run),
        .nis = forecasts.nis.empty() ? std::numeric_limits<double>::quiet_NaN() : forecasts.nis[i]};
  }
}

template <class Member>
VectorXd collect(std::span<const Score> scores, Member member) {
  VectorXd values(static_cast<Index>(scores.size()));
  std::ranges::transform(scores, values.begin(), [member](const Score& s) { return s.*member; });
  return values;
}

double standard_deviation(const VectorXd& values) {
  return std::sqrt((values.array() - values.mean()).square().sum() /
                   static_cast<double>(values.size() - 1));
}

Figure mean(const VectorXd& values) {
  return {values.mean(),
          standard_deviation(values) / std::sqrt(static_cast<double>(values.size()))};
}

/// The error by the variance of the squared deviations: s is half of it relative to s^2.
Figure deviation(const VectorXd& values) {
  const double s = standard_deviation(values);
  const VectorXd squares = (values.array() - values.mean()).square();
  return {s, mean(squares).error / (2.0 * s)};
}

/// mean(a) / mean(b), pairs.
Figure ratio(const VectorXd& a, const VectorXd& b) {
  const double value = a.mean() / b.mean();
  return {value, mean(a - value * b).error / std::abs(b.mean())};
}

/// The ratio of the standard deviations: the root of a ratio of means.
Figure deviation_ratio(const VectorXd& a, const VectorXd& b) {
  const VectorXd a_squares = (a.array() - a.mean()).square();
  const VectorXd b_squares = (b.array() - b.mean()).square();
  const Figure squares = ratio(a_squares, b_squares);
  const double root = std::sqrt(squares.value);
  return {root, squares.error / (2.0 * root)};
}

}  // namespace

Scores run_contest(const Predictors& predictors, const Lengths& lengths, std::size_t sets,
                   const SetSource& source, unsigned threads, const parallel::Progress& progress) {
  Scores scores(predictors.size(), std::vector<Score>(sets));
  const auto calibration = static_cast<Index>(lengths.calibration);
  const auto prediction = static_cast<Index>(lengths.prediction);
  const auto work = [&](std::size_t index) {
    const std::size_t first = index * kSetsInBlock;
    const std::size_t count = std::min(kSetsInBlock, sets - first);
    MatrixXd block(calibration + prediction, static_cast<Index>(count));
    source(first, block);
    const MatrixXd calibrations = block.topRows(calibration);
    const MatrixXd measured = block.bottomRows(prediction);
    for (std::size_t p = 0; p < predictors.size(); ++p) {
      score_block(*predictors[p], calibrations, measured,
                  std::span{scores[p]}.subspan(first, count));
    }
  };
  parallel::for_each((sets + kSetsInBlock - 1) / kSetsInBlock, threads, work, progress);
  return scores;
}

Standing make_standing(std::string name, std::span<const Score> scores,
                       std::span<const Score> yardstick) {
  const VectorXd ie = collect(scores, &Score::integrated_error);
  const VectorXd rsse = collect(scores, &Score::rsse);
  return {.name = std::move(name),
          .mean_ie = mean(ie),
          .std_ie = deviation(ie),
          .mean_rsse = mean(rsse),
          .std_rsse = deviation(rsse),
          .ie_ratio = deviation_ratio(ie, collect(yardstick, &Score::integrated_error)),
          .rsse_ratio = ratio(rsse, collect(yardstick, &Score::rsse)),
          .coverage = mean(collect(scores, &Score::covered)),
          .own_coverage = mean(collect(scores, &Score::covered_by_own)),
          .nis = mean(collect(scores, &Score::nis))};
}

Figure controlled_rsse_ratio(std::span<const Score> scores, std::optional<double> mean_square,
                             std::span<const Score> yardstick, double yardstick_mean_square) {
  const VectorXd a = collect(scores, &Score::rsse);
  const VectorXd b = collect(yardstick, &Score::rsse);
  // Rows (1, controls): the fit's first coefficient is the mean where every control is as expected.
  MatrixXd controls = MatrixXd::Ones(a.size(), mean_square ? 3 : 2);
  controls.col(1) = b.array().square() - yardstick_mean_square;
  if (mean_square) controls.col(2) = a.array().square() - *mean_square;
  const Eigen::ColPivHouseholderQR<MatrixXd> regression(controls);
  const double mean_b = regression.solve(b)(0);
  const double value = regression.solve(a)(0) / mean_b;
  const VectorXd difference = a - value * b;
  return {value, mean(difference - controls * regression.solve(difference)).error / mean_b};
}

using Eigen::Index;
using Eigen::MatrixXd;

Expectation expect(const Predictor& predictor, const reference::FractionalNoise& noise,
                   const Lengths& lengths) {
  // The answers of a linear predictor to each sample alone are its weights.
  const auto n = static_cast<Index>(lengths.calibration);
  const Forecasts answers = predictor.predict(MatrixXd::Identity(n, n));
  const MatrixXd covariance = reference::error_covariance(noise, answers.bias);
  const reference::NormMoments rsse = reference::gaussian_norm(covariance);
  const Eigen::ArrayXd stated_over_true =
      answers.sigma.col(0).array() / covariance.diagonal().array().sqrt();
  const auto within_two = [](double ratio) { return std::erf(std::numbers::sqrt2 * ratio); };
  return {.std_ie = std::sqrt(covariance.sum()),
          .mean_rsse = rsse.mean,
          .std_rsse = rsse.standard_deviation,
          .coverage = stated_over_true.unaryExpr(within_two).mean()};
}

}  // namespace zerorate::paper
