/// @file
/// One round of the blind campaign, and the whole chain. What so few recordings can show is
/// asserted: that a bar of the campaign is missed by more than chance does once in a thousand
/// times.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "firmware/model/catalogue.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tools/lab/campaign/answer.hpp"
#include "host_tools/lab/campaign/blind_recording.hpp"
#include "host_tools/lab/campaign/tally.hpp"
#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/recording/writer.hpp"
#include "host_tools/lib/simulate/sizing/sized_effect.hpp"

namespace zerorate::campaign {
namespace {

using sizing::BaseNoise;
using sizing::Draws;
using sizing::EffectEntry;
using sizing::Part;
using sizing::RecordingSetting;
using sizing::SizedEffect;

TEST(RoundOfTheBlindCampaign, MissesNoBarByMoreThanChance) {
  const testing::ScratchFolder folder;
  const auto recording = folder.path() / "recording.csv";
  const BlindOptions options{.seed = 2026, .nats = 40.0};
  Tally tally{options};
  for (std::size_t run = 0; run < Round::kRuns; ++run) {
    const BlindRecording blind = draw_blind_recording(options, run);
    write_recording(blind, recording);
    tally.add(run, blind, diagnose(ZERORATE_PROGRAM, recording));
  }
  for (const Bar& bar : tally.bars()) {
    const bool missed =
        bar.at_least ? is_surely_below(bar.rate, bar.bar) : is_surely_above(bar.rate, bar.bar);
    EXPECT_FALSE(missed) << bar.what << ": " << bar.rate.hits << " of " << bar.rate.runs;
  }
  if (!HasFailure()) return;
  for (const std::string& miss : tally.misses()) ADD_FAILURE() << miss;
}

// The whole chain: the effect is hidden in the physical rate, which the simulated chip converts,
// the driver reads and the node records; what the node recorded at standstill is diagnosed.

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr std::size_t kSamples = 20'000;
constexpr std::size_t kYaw = 2;

/// A sensor like the LSM6DSO, sampled at 10 Hz: its LSB, 8.75 mdps, is a third of the noise.
RecordingSetting chip_setting() {
  const double white = 0.03 * kRadPerDeg;
  const double flicker = white / 6.0;
  const random::RandomStream stream(31);
  RecordingSetting setting{.samples = kSamples,
                           .period_s = 0.1,
                           .noise = BaseNoise(kSamples, white, flicker),
                           .flicker_sigma_rad_s = flicker,
                           .bias_rad_s = 0.4 * kRadPerDeg,
                           .temperature_degc = std::vector<double>(kSamples, 25.0),
                           .stream = stream};
  setting.slow_rad_s = alone(setting, flicker_noise_of(setting));
  return setting;
}

/// The vehicle arrives, with a turn, and stands for the rest of 2000 s.
bool is_driving(std::size_t k) {
  return k < 600;
}

/// Rates that the sensor is exposed to: noise, effect and, while the vehicle drives, the vehicle.
void write_physical(const RecordingSetting& setting, const Part& effect,
                    const std::filesystem::path& path) {
  simulate::Signal signal(kSamples, setting.period_s);
  white_noise_of(setting)(signal);
  effect(signal);
  recording::Writer writer{path, {.still = true}};
  for (std::size_t k = 0; k < kSamples; ++k) {
    const double turn = is_driving(k) ? 0.2 * std::sin(0.01 * static_cast<double>(k)) : 0.0;
    const double rest = signal.rate_rad_s[k] + setting.slow_rad_s[k] + setting.bias_rad_s;
    const auto rate = static_cast<float>(rest + turn);
    writer.write({.time_ns = static_cast<std::int64_t>(k) * 100'000'000,
                  .rate_rad_s = {rate, rate, rate},  // an axis without noise counts as frozen
                  .still = !is_driving(k)});
  }
  writer.finish();
}

/// Sends a recording through chip, driver and node, and keeps what the node measured.
void record_through_the_node(const std::filesystem::path& physical,
                             const std::filesystem::path& recorded) {
  recording::Writer writer{recorded, {.axis_count = 1, .still = true}};
  recording::Reader reader{physical};
  const evaluate::ReplayResult result = evaluate::replay(
      reader, {.model = model::find_model("lsm6dso"), .through = evaluate::Through::chip},
      {.on_sample = [&](const evaluate::ReplayedSample& sample) {
        if (!sample.message.has_rate()) return;
        writer.write({.time_ns = sample.time_ns,
                      .rate_rad_s = {sample.message.axes[kYaw].measured.in(core::rad_per_s)},
                      .still = sample.message.motion == core::Motion::still});
      }});
  writer.finish();
  ASSERT_EQ(result.rows, kSamples);
}

class EffectBehindTheChip : public ::testing::TestWithParam<EffectEntry> {};

TEST_P(EffectBehindTheChip, IsFoundInWhatTheNodeRecordedAtStandstill) {
  const RecordingSetting setting = chip_setting();
  Draws draws{setting.stream.substream("effects")};
  const SizedEffect effect = GetParam().draw(setting, draws);
  const double size = sizing::size_for(effect, 150.0).value();
  const testing::ScratchFolder folder;
  const auto recorded = folder.path() / "recorded.csv";
  write_physical(setting, effect.at(size), folder.path() / "physical.csv");
  record_through_the_node(folder.path() / "physical.csv", recorded);

  const Answer answer = diagnose(ZERORATE_PROGRAM, recorded);

  const std::string hidden(GetParam().name);
  EXPECT_THAT(answer.causes, ::testing::Contains(hidden)) << answer.verdict;
  // The chip rounds to its LSB, which is no less true.
  EXPECT_THAT(answer.causes, ::testing::Each(::testing::AnyOf(hidden, "quantization")));
}

INSTANTIATE_TEST_SUITE_P(Some, EffectBehindTheChip,
                         ::testing::Values(EffectEntry{"rate_ramp", sizing::draw_rate_ramp},
                                           EffectEntry{"periodic_disturbance",
                                                       sizing::draw_periodic_disturbance},
                                           EffectEntry{"outliers", sizing::draw_outliers}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace zerorate::campaign
