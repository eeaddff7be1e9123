// Samples that are cut toward zero: found by the levels at rest and on the move, of simulated
// sensors and of real ones, and not found in rounded samples.

#include "host_tools/lib/diagnose/record/truncation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <string_view>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/diagnose/record/cell_of_zero.hpp"
#include "host_tools/lib/diagnose/truncation_cause.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kStep = 1e-3;  ///< rad/s
constexpr int kSamples = 20'000;

enum class Steps : std::uint8_t { rounded, cut, finer };

struct Sensor {
  Steps steps = Steps::rounded;
  double noise_in_steps = 1.5;
  double bias_in_steps = 1.0;      ///< bias of x; y and z have others
  double motion_in_steps = 300.0;  ///< deviation of the rate on the move; 0: always at rest
};

float read(const Sensor& sensor, double in_steps) {
  if (sensor.steps == Steps::finer) return static_cast<float>(kStep * in_steps);
  const double counts = sensor.steps == Steps::cut ? std::trunc(in_steps) : std::round(in_steps);
  return static_cast<float>(kStep * counts);
}

/// A rest, and a motion of the same length whose rate wanders over half a second.
identify::RestSamples samples_of(const Sensor& sensor, std::uint64_t seed) {
  constexpr auto kPeriod = core::Duration::milliseconds(10);
  identify::RestSamples samples{.sample_period = kPeriod, .mean_period = kPeriod};
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal;
  std::array<double, 3> wander{};
  for (int k = 0; k < kSamples; ++k) {
    samples.time.push_back(core::Instant::from_ns(k * kPeriod.ns()));
    std::array<float, recording::kMaxAxes> rates{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double bias = sensor.bias_in_steps * (1.0 - 2.0 * static_cast<double>(axis));
      rates[axis] = read(sensor, bias + sensor.noise_in_steps * normal(random));
      if (sensor.motion_in_steps == 0.0) continue;
      wander[axis] = 0.98 * wander[axis] + 0.2 * sensor.motion_in_steps * normal(random);
      samples.levels_on_the_move[axis].take(
          read(sensor, bias + wander[axis] + sensor.noise_in_steps * normal(random)));
    }
    samples.rate_rad_s.push_back(rates);
  }
  return samples;
}

TEST(LevelsNearZero, CountThoseNearestCompletely) {
  identify::LevelsNearZero levels;
  for (int round = 0; round < 3; ++round) {
    for (int value = -100; value <= 100; ++value) levels.take(static_cast<float>(value));
  }
  ASSERT_EQ(levels.counts().size(), identify::LevelsNearZero::kMost);
  EXPECT_EQ(levels.counts().begin()->first, -32.0F);
  for (const auto& [value, count] : levels.counts()) EXPECT_EQ(count, 3U) << value;
}

TEST(StepOfValues, IsThatOfLevelsWithZeroAmongThem) {
  EXPECT_NEAR(step_of({{-0.061F, 1}, {0.0F, 1}, {0.1221F, 4}, {0.1831F, 2}}).value(), 0.061, 1e-4);
  EXPECT_FALSE(step_of({{-0.5F, 1}, {0.5F, 1}, {1.5F, 4}, {2.5F, 2}}));
  EXPECT_FALSE(step_of({{-0.061F, 1}, {0.0F, 1}, {0.1F, 4}, {0.1831F, 2}}));
}

TEST(SamplesCutTowardZero, AreFoundAtRestAndOnTheMove) {
  for (const Sensor& sensor : {Sensor{Steps::cut}, Sensor{Steps::cut, 1.5, 1.0, 0.0},
                               Sensor{Steps::cut, 1.0, 40.0}, Sensor{Steps::cut, 3.0, 4.0}}) {
    const TruncationEvidence evidence = find_truncation(samples_of(sensor, 1));
    ASSERT_TRUE(evidence.found) << sensor.noise_in_steps << " " << sensor.bias_in_steps;
    EXPECT_NEAR(evidence.found->step_rad_s, kStep, 1e-3 * kStep);
    EXPECT_LT(evidence.found->width_lo, 2.0);
    EXPECT_GT(evidence.found->width_hi, 2.0);
  }
}

TEST(SamplesThatDoNotReachZero, ShowNothing) {
  EXPECT_FALSE(find_truncation(samples_of({Steps::cut, 1.0, 40.0, 0.0}, 1)).is_examined);
  EXPECT_FALSE(find_truncation(samples_of({Steps::finer}, 1)).is_examined);
}

// With a threshold of 8.1 nats one of 3300 is expected by chance.
TEST(RoundedSamples, AreNotTakenForCutOnes) {
  double most = 0.0;
  int found = 0;
  int examined = 0;
  std::mt19937_64 random{7};
  std::uniform_real_distribution<double> uniform;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const Sensor sensor{Steps::rounded, 0.3 + 4.0 * uniform(random), 6.0 * uniform(random),
                        seed % 4 == 0 ? 0.0 : 10.0 + 400.0 * uniform(random)};
    const TruncationEvidence evidence = find_truncation(samples_of(sensor, seed));
    examined += evidence.is_examined ? 1 : 0;
    found += evidence.found ? 1 : 0;
    most = std::max(most, evidence.surprisal_nats);
  }
  std::printf("%d of %d rounded recordings taken for cut ones, %.1f nats at most\n", found,
              examined, most);
  EXPECT_EQ(found, 0);
  EXPECT_GT(examined, 300);
}

TEST(SamplesWithTheCutUndone, HaveCellsOfOneWidthAndTheSameMean) {
  const identify::RestSamples cut = samples_of({Steps::cut, 1.5, 1.0, 0.0}, 3);
  const auto undone = without_truncation(cut, find_truncation(cut).found.value());
  double sum = 0.0;
  std::map<float, std::size_t> counts;
  for (const auto& rate : undone.rate_rad_s) {
    sum += double{rate[0]} / kStep;
    ++counts[rate[0]];
  }
  // The cell of zero leaves 0.05 steps at most with a noise of 1.5; the draws leave 0.011.
  EXPECT_NEAR(sum / kSamples, 1.0, 0.05 + 3.0 * 0.011);
  // Half a normal cell beside the other, by its density at 1.5 / 1.5 and 0.5 / 1.5 deviations.
  const double below = static_cast<double>(counts.at(static_cast<float>(-0.5 * kStep)));
  const double above = static_cast<double>(counts.at(static_cast<float>(0.5 * kStep)));
  EXPECT_NEAR(below / above, std::exp(-0.5 * (1.0 - 1.0 / 9.0)), 0.04);
}

TEST(DiagnosisOfACutSensor, NamesItAndExtendsTheModel) {
  const identify::RestSamples samples = samples_of({Steps::cut}, 5);
  for (const Steps steps : {Steps::cut, Steps::rounded}) {
    const auto diagnosed = diagnose(record_of(samples_of({steps}, 5), 0));
    const auto cause = std::ranges::find(diagnosed.causes, "truncation", &Cause::effect);
    ASSERT_EQ(cause != diagnosed.causes.end(), steps == Steps::cut);
    const auto& quantization = diagnosed.extended_model.quantization;
    ASSERT_TRUE(quantization);
    EXPECT_EQ(quantization->method == model::QuantizationMethod::truncation, steps == Steps::cut);
    EXPECT_EQ(diagnosed.verdict, Verdict::explained);
    if (steps == Steps::rounded) continue;
    EXPECT_EQ(cause->axes, 3U);
    EXPECT_TRUE(cause->stands_alone());
    const auto given = diagnose(record_of(samples, 0), {.base_model = diagnosed.extended_model});
    EXPECT_EQ(std::ranges::count(given.causes, "truncation", &Cause::effect), 0);
  }
}

TEST(RealSensorMovedByHand, IsNamed) {
  const auto folder = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
  if (!folder) GTEST_SKIP() << "skipped: no recordings";
  recording::Reader reader{*folder / "broad_hand" /
                           "broad_14_undisturbed_slow_translation_with_breaks_B.csv.gz"};
  const TruncationEvidence evidence = find_truncation(identify::read_rest_samples(reader));
  ASSERT_TRUE(evidence.found);
  std::printf("%.1f nats, the cell of zero is %.2f (%.2f to %.2f) steps wide\n",
              evidence.surprisal_nats, evidence.found->width, evidence.found->width_lo,
              evidence.found->width_hi);
  EXPECT_LT(evidence.found->width_lo, 2.0);
  EXPECT_GT(evidence.found->width_hi, 2.0);
  recording::Reader rounded{*folder / "adis16405_static/run1_100hz_raw.csv.gz"};
  EXPECT_FALSE(find_truncation(identify::read_rest_samples(rounded)).found);
}

TEST(SamplesThatAreCut, AreDoubtedWhereTheyStandAsTheyAre) {
  const auto remarks = [](Steps steps, std::string_view accepted) {
    return remarks_on_truncation(samples_of({.steps = steps}, 3),
                                 identify::AcceptedDoubts{accepted});
  };
  ASSERT_EQ(remarks(Steps::cut, "").size(), 1U);
  EXPECT_NE(remarks(Steps::cut, "")[0].find("truncated, not rounded"), std::string::npos);
  EXPECT_NE(remarks(Steps::cut, "")[0].find("--accept truncation"), std::string::npos);
  EXPECT_TRUE(remarks(Steps::cut, "truncation").empty());
  EXPECT_TRUE(remarks(Steps::rounded, "").empty());
}

}  // namespace
}  // namespace zerorate::diagnose
