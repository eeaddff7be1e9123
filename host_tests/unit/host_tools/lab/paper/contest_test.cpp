#include "host_tools/lab/paper/contest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "host_tools/lab/paper/predictors.hpp"
#include "host_tools/lab/paper/table1.hpp"
#include "host_tools/lib/parallel/parallel.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::paper {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Lengths kShort{.calibration = 250, .prediction = 300};

/// The answers to each sample alone are a linear predictor's weights.
MatrixXd weights(const Predictor& predictor) {
  return predictor.predict(MatrixXd::Identity(250, 250)).bias;
}

TEST(ForEachInParallel, DoesEachPieceOnceAndReportsTheWhole) {
  std::vector<std::atomic<int>> calls(100);
  double share = 0.0;
  parallel::for_each(
      calls.size(), 4, [&](std::size_t i) { ++calls[i]; }, [&](double s) { share = s; });
  for (const auto& count : calls) EXPECT_EQ(count, 1);
  EXPECT_EQ(share, 1.0);
}

TEST(ForEachInParallel, PassesAnExceptionOn) {
  EXPECT_THROW(parallel::for_each(10, 2, [](std::size_t) { throw std::runtime_error("one"); }, {}),
               std::runtime_error);
}

TEST(ForEachInParallel, KeepsWorkInsideOfAPieceOnItsThread) {
  std::atomic<int> elsewhere = 0;
  parallel::for_each(4, 2,
                     [&](std::size_t) {
                       const std::thread::id piece = std::this_thread::get_id();
                       parallel::together(std::vector<std::function<void()>>(
                           8, [&] { elsewhere += std::this_thread::get_id() != piece ? 1 : 0; }));
                     },
                     {});
  EXPECT_EQ(elsewhere, 0);
}

TEST(Lazy, IsMadeOnceForAllThreadsAndCopies) {
  const parallel::Lazy<int> value;
  const parallel::Lazy<int> copy = value;
  std::atomic<int> made = 0;
  const auto get = [&](const parallel::Lazy<int>& lazy) {
    EXPECT_EQ(lazy.get([&] { return ++made; }), 1);
  };
  parallel::for_each(100, 4, [&](std::size_t i) { get(i % 2 == 0 ? value : copy); }, {});
  EXPECT_EQ(made, 1);
}

// In fixed memory the node forms the suffix means of eq. 8 from blocks, see core/estimator; as
// predictors they are worth the same.
TEST(MovingAverage, IsAsGoodAsTheSuffixMeansOfEquations8And9) {
  MatrixXd exact = MatrixXd::Zero(300, 250);
  for (Index j = 1; j <= 300; ++j) {
    const Index window = std::min<Index>(j, 250);
    exact.row(j - 1).tail(window).setConstant(1.0 / static_cast<double>(window));
  }
  const MatrixXd node = weights(*make_moving_average("", {}, kShort));
  EXPECT_LT((node.rowwise().sum().array() - 1.0).abs().maxCoeff(), 1e-5);
  EXPECT_LT((node.topRows(64) - exact.topRows(64)).cwiseAbs().maxCoeff(), 1e-6);
  const reference::FractionalNoise noise;
  const Eigen::ArrayXd loss = reference::error_variance(noise, node).array() /
                              reference::error_variance(noise, exact).array();
  EXPECT_LT((loss - 1.0).abs().maxCoeff(), 0.005);
  EXPECT_NEAR(reference::error_covariance(noise, node).sum() /
                  reference::error_covariance(noise, exact).sum(),
              1.0, 0.002);
}

TEST(CalibrationMean, WeighsAllAlike) {
  const MatrixXd all = weights(*make_calibration_mean("", {}, kShort));
  EXPECT_LT((all.array() - 1.0 / 250.0).abs().maxCoeff(), 1e-7);
}

TEST(NodePredictors, StateTheBandOfTheExactCovariance) {
  // The exact band of eq. 9 under the fractional noise itself; the node's is that of its lags.
  const reference::FractionalNoise noise{.order = 0.5, .innovation_variance = 6.25};
  const auto predictor = make_calibration_mean("", {.noise = noise}, kShort);
  const Eigen::VectorXd exact =
      reference::error_variance(noise, MatrixXd::Constant(300, 250, 1.0 / 250.0)).cwiseSqrt();
  const MatrixXd stated = predictor->predict(MatrixXd::Zero(250, 1)).sigma;
  EXPECT_LT((stated.array() / exact.array() - 1.0).abs().maxCoeff(), 0.03);
}

TEST(Contest, DoesNotDependOnTheNumberOfThreads) {
  const SimulationOptions options{.lengths = kShort, .seed = 5};
  const Predictors predictors = simulated_predictors(options);
  const SetSource sets = simulated_sets(options.noise, options.seed);
  const Scores one = run_contest(predictors, kShort, 50, sets, 1, {});
  const Scores three = run_contest(predictors, kShort, 50, sets, 3, {});
  for (std::size_t p = 0; p < predictors.size(); ++p) {
    for (std::size_t i = 0; i < 50; ++i) {
      EXPECT_EQ(one[p][i].integrated_error, three[p][i].integrated_error);
      EXPECT_EQ(one[p][i].rsse, three[p][i].rsse);
      EXPECT_EQ(one[p][i].covered, three[p][i].covered);
    }
  }
}

TEST(Standing, OfFourScoresIsWorkedOutByHand) {
  const std::vector<Score> scores{{.integrated_error = 1.0, .rsse = 2.0, .covered = 1.0},
                                  {.integrated_error = -1.0, .rsse = 4.0, .covered = 0.8},
                                  {.integrated_error = 3.0, .rsse = 2.0, .covered = 1.0},
                                  {.integrated_error = 1.0, .rsse = 4.0, .covered = 1.0}};
  std::vector<Score> yardstick = scores;
  for (Score& score : yardstick) {
    score.integrated_error *= -2.0;
    score.rsse *= 4.0;
  }
  const Standing s = make_standing("a", scores, yardstick);
  EXPECT_DOUBLE_EQ(s.mean_ie.value, 1.0);
  EXPECT_DOUBLE_EQ(s.std_ie.value, std::sqrt(8.0 / 3.0));
  EXPECT_DOUBLE_EQ(s.mean_rsse.value, 3.0);
  EXPECT_DOUBLE_EQ(s.mean_rsse.error, std::sqrt(4.0 / 3.0) / 2.0);
  EXPECT_DOUBLE_EQ(s.coverage.value, 0.95);
  // Proportional scores have a ratio without error: that is what pairing is for.
  EXPECT_DOUBLE_EQ(s.rsse_ratio.value, 0.25);
  EXPECT_NEAR(s.rsse_ratio.error, 0.0, 1e-15);
  EXPECT_DOUBLE_EQ(s.ie_ratio.value, 0.5);
  EXPECT_NEAR(s.ie_ratio.error, 0.0, 1e-15);
}

// The squares of a score that is nearly known tell most of its luck: what is left of the ratio's
// error is far smaller, and covers the truth.
TEST(ControlledRatio, IsSharperThanTheRatioAndHoldsTheTruth) {
  constexpr std::size_t kSets = 2000;
  constexpr double kTrueRatio = 0.8;
  std::vector<double> normal(2 * kSets);
  random::RandomStream{1}.fill_normal(0, normal);
  std::vector<Score> scores(kSets);
  std::vector<Score> yardstick(kSets);
  for (std::size_t i = 0; i < kSets; ++i) {
    yardstick[i].rsse = 10.0 + normal[2 * i];
    scores[i].rsse = kTrueRatio * (10.0 + 0.5 * normal[2 * i] + 0.5 * normal[2 * i + 1]);
  }
  const Figure plain = make_standing("", scores, yardstick).rsse_ratio;
  const Figure controlled =
      controlled_rsse_ratio(scores, kTrueRatio * kTrueRatio * 100.5, yardstick, 101.0);
  EXPECT_LT(controlled.error, 0.1 * plain.error);
  EXPECT_NEAR(controlled.value, kTrueRatio, 4.0 * controlled.error);
}

}  // namespace
}  // namespace zerorate::paper
