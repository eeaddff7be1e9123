// Samples that are wild, lost, late, too many or unannounced.

#include <gtest/gtest.h>

#include <stdexcept>

#include "host_tests/system/scenario/play.hpp"

namespace zerorate::scenario {
namespace {

TEST(WildStart, IsOverBeforeAnythingIsLearnt) {
  const Played played = play("wild-start");
  EXPECT_LT(played.worst_dps(10.0, 120.0), kWanderDps);
  EXPECT_EQ(played.result.samples_disagreeing, 0U);
}

TEST(Gaps, CostNothingButTheirSamples) {
  const Played played = play("gaps");
  EXPECT_LT(played.worst_dps(60.0, 1'800.0), kWanderDps);
  EXPECT_EQ(played.result.samples_refused, 0U);
  EXPECT_EQ(played.result.samples_disagreeing, 0U);
}

TEST(TimeBackwards, IsPutWhereTheStampsBelong) {
  const Played played = play("time-backwards");
  std::size_t late = 0;
  std::int64_t newest_ns = -1;
  for (const simulate::ScenarioRow& one : played.drive.rows) {
    late += one.row.time_ns <= newest_ns ? 1U : 0U;
    newest_ns = std::max(newest_ns, one.row.time_ns);
  }
  EXPECT_GT(late, 200U);
  EXPECT_EQ(played.result.findings.count(recording::Finding::time_sorted), late);
  EXPECT_EQ(played.result.samples_refused, 0U);
  EXPECT_EQ(played.messages.size(), played.drive.rows.size());
  EXPECT_LT(played.worst_dps(30.0, 480.0), kWanderDps);
}

TEST(SensorThatIsTwoPercentFast, IsNoTrouble) {
  const Played played = play("rate-off");
  EXPECT_LT(played.worst_dps(30.0, 700.0), kWanderDps);
  EXPECT_EQ(played.result.samples_disagreeing, 0U);
  EXPECT_FALSE(played.messages.back().health.model_inconsistent);
}

TEST(NodeWithoutDataReady, ReadsTheGyroAllTheSame) {
  const Played played = play("no-data-ready");
  EXPECT_EQ(played.result.loop.samples, played.messages.size());
  EXPECT_LT(played.worst_dps(30.0, 360.0), kWanderDps);
}

TEST(ScenarioOfAnUnknownName, NamesThoseThatThereAre) {
  try {
    (void)simulate::find_scenario("city ");
    FAIL();
  } catch (const std::invalid_argument& error) {
    for (const auto& scenario : simulate::scenarios()) {
      EXPECT_NE(std::string_view{error.what()}.find(scenario.name), std::string_view::npos);
    }
  }
}

}  // namespace
}  // namespace zerorate::scenario
