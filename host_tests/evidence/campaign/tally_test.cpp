#include "host_tools/lab/campaign/tally.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host_tools/lab/campaign/blind_recording.hpp"
#include "host_tools/lab/campaign/gain_summary.hpp"

namespace zerorate::campaign {
namespace {

BlindRecording hidden(Kind kind, std::vector<std::string> truth) {
  return {.kind = kind, .truth = std::move(truth), .signal = simulate::Signal(0, 1.0)};
}

TEST(Score, CountsARightNameFirstAndAlone) {
  const BlindRecording ramp = hidden(Kind::single, {"rate_ramp"});
  const Score right = score(ramp, {"explained", {"rate_ramp"}, {"rate_random_walk"}});
  EXPECT_TRUE(right.named && right.first && right.alone && !right.wrong);
  const Score beside = score(ramp, {"explained", {"outliers", "rate_ramp"}, {}});
  EXPECT_TRUE(beside.named && !beside.first && !beside.alone && beside.wrong);
}

TEST(Score, CallsAnotherNameWrongEvenBesideTheTruth) {
  const BlindRecording ramp = hidden(Kind::single, {"rate_ramp"});
  const Score rival = score(ramp, {"explained", {"rate_random_walk"}, {"rate_ramp"}});
  EXPECT_TRUE(!rival.named && rival.alternative && rival.wrong);
  EXPECT_FALSE(score(ramp, {"unexplained", {"rate_random_walk"}, {}}).wrong);
}

TEST(Score, WantsBothOfTwoEffects) {
  const BlindRecording both = hidden(Kind::pair, {"rate_ramp", "outliers"});
  EXPECT_FALSE(score(both, {"explained", {"outliers"}, {}}).named);
  EXPECT_TRUE(score(both, {"explained", {"outliers", "rate_ramp"}, {}}).alone);
}

TEST(Score, FindsNothingNamedInACleanRecording) {
  const Score clean = score(hidden(Kind::clean, {}), {"consistent", {}, {}});
  EXPECT_TRUE(!clean.named && !clean.first && !clean.wrong);
  EXPECT_TRUE(score(hidden(Kind::clean, {}), {"explained", {"outliers"}, {}}).wrong);
}

TEST(RateInterval, IsThatOfClopperAndPearson) {
  // Textbook figures: 8 of 10; none of 10 is up to 1 - 0.025^(1/10).
  const Rate eight{8, 10};
  EXPECT_NEAR(eight.lo95(), 0.4439, 1e-4);
  EXPECT_NEAR(eight.hi95(), 0.9748, 1e-4);
  const Rate none{0, 10};
  EXPECT_EQ(none.lo95(), 0.0);
  EXPECT_NEAR(none.hi95(), 1.0 - std::pow(0.025, 0.1), 1e-6);
}

TEST(RateComparison, AssertsOnlyWhatFewRunsCanShow) {
  EXPECT_FALSE(is_surely_below({13, 16}, 0.95));
  EXPECT_TRUE(is_surely_below({9, 16}, 0.95));
  EXPECT_FALSE(is_surely_above({1, 8}, 0.02));
  EXPECT_TRUE(is_surely_above({4, 8}, 0.02));
}

TEST(Tally, FillsBarsAndMatrix) {
  Tally tally{BlindOptions{}};
  tally.add(0, hidden(Kind::single, {"rate_ramp"}), {"explained", {"rate_ramp"}, {}});
  tally.add(1, hidden(Kind::single, {"rate_ramp"}), {"explained", {"outliers"}, {}});
  tally.add(2, hidden(Kind::clean, {}), {"consistent", {}, {}});
  EXPECT_EQ(tally.misses().size(), 1U);
  EXPECT_DOUBLE_EQ(tally.bars().front().rate.share(), 0.5);
  EXPECT_NE(tally.markdown().find("| 5 rate_ramp | 2 | 1 | 1 | 0 |"), std::string::npos);
  EXPECT_NE(tally.json().find("\"outliers\": 1"), std::string::npos);
}

TEST(GainSummary, HoldsMediansAndMeansAgainstTheBars) {
  GainSummary tally{"rate_ramp", 1};
  for (const double off : {-0.02, 0.0, 0.5}) {
    tally.add({.rsse_ratio = 1.0 + off,
               .heading_drift_ratio = 0.8,
               .coverage95_base = 0.8,
               .coverage95_extended = 0.95 + 0.1 * off,
               .log_score_gain_nats_per_sample = 2e-3 + off * off},
              off > 0.0);
  }
  EXPECT_DOUBLE_EQ(tally.median(&Gain::rsse_ratio).value, 1.0);
  EXPECT_DOUBLE_EQ(tally.mean(&Gain::coverage95_extended).value, 0.95 + 0.016);
  EXPECT_TRUE(tally.scores_better() && tally.errs_no_more() && tally.covers());
  EXPECT_NE(tally.row().find("| rate_ramp | 3 | 1 | 2.4 ("), std::string::npos);
  EXPECT_NE(tally.row().find("| pay |"), std::string::npos);
  tally.add({.rsse_ratio = 1.1,
             .heading_drift_ratio = 0.8,
             .coverage95_base = 0.8,
             .coverage95_extended = 0.7,
             .log_score_gain_nats_per_sample = -1.0},
            true);
  EXPECT_FALSE(tally.errs_no_more() || tally.covers() || tally.scores_better());
  EXPECT_FALSE(tally.scores_worse());
  EXPECT_NE(tally.row().find("| harm: error coverage |"), std::string::npos);
}

TEST(ScenarioOfAnAwkwardLength, HasThatLengthAndRate) {
  for (const std::size_t samples : {5'003U, 7'001U}) {
    const BlindOptions options{.seed = 3, .samples = samples, .rate_hz = 104.0};
    for (const std::size_t run : {1U, 3U, 8U, 20U}) {
      const BlindRecording blind = draw_blind_recording(options, run);
      EXPECT_EQ(blind.signal.size(), samples);
      EXPECT_DOUBLE_EQ(blind.signal.sample_period_s, 1.0 / 104.0);
    }
  }
}

}  // namespace
}  // namespace zerorate::campaign
