/// @file
/// One round of the blind campaign. What so few recordings can show is asserted: that a bar of the
/// campaign is missed by more than chance does once in a thousand times.

#include <gtest/gtest.h>

#include "host_tests/support/scratch_folder.hpp"
#include "host_tools/lib/campaign/answer.hpp"
#include "host_tools/lib/campaign/scenario.hpp"
#include "host_tools/lib/campaign/tally.hpp"

namespace zerorate::campaign {
namespace {

TEST(RoundOfTheBlindCampaign, MissesNoBarByMoreThanChance) {
  const testing::ScratchFolder folder;
  const auto recording = folder.path() / "recording.csv";
  const ScenarioOptions options{.seed = 2026, .nats = 40.0};
  Tally tally{options};
  for (std::size_t run = 0; run < kRunsOfARound; ++run) {
    const Scenario scenario = draw_scenario(options, run);
    write_recording(scenario, recording);
    tally.add(run, scenario, diagnose(ZERORATE_PROGRAM, recording));
  }
  for (const Bar& bar : tally.bars()) {
    const bool missed =
        bar.at_least ? is_surely_below(bar.rate, bar.bar) : is_surely_above(bar.rate, bar.bar);
    EXPECT_FALSE(missed) << bar.what << ": " << bar.rate.hits << " of " << bar.rate.runs;
  }
  if (!HasFailure()) return;
  for (const std::string& miss : tally.misses()) ADD_FAILURE() << miss;
}

}  // namespace
}  // namespace zerorate::campaign
