#include "core/standstill/calm_judge.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "core/base/units.hpp"

namespace zerorate::core {
namespace {

using Judge = CalmJudge<3>;
using Rates = Judge::Rates;

constexpr Duration kTick = Duration::milliseconds(500);
constexpr Duration kBend = Duration::seconds(5);

/// A stop, sample by sample; rates and noise in deg/s.
struct Stop {
  explicit Stop(int samples_per_tick, float model_sigma_dps = 0.1F,
                StandstillSource source = StandstillSource::odometer)
      : samples(samples_per_tick),
        judge(source, kBend, kTick),
        white(model_sigma_dps * model_sigma_dps * kRadPerDeg * kRadPerDeg, {}, kTick, true) {}

  /// A tick with these rates, and the verdict.
  Calm tick(const std::function<double(double seconds)>& rate_dps,
            const Rates* predicted_rad_s = nullptr, float variance = 0.0F) {
    TickMean<3> mean{.tick = next++, .samples = static_cast<std::uint32_t>(samples)};
    std::array<double, 3> sum{};
    for (int k = 0; k < samples; ++k) {
      const double seconds = (static_cast<double>(mean.tick) + (k + 0.5) / samples) * 0.5;
      Rates sample{};
      for (std::size_t i = 0; i < 3; ++i) {
        const double rate = rate_dps(seconds) + sigma_dps * normal(random);
        sample[i] = static_cast<float>(rate) * kRadPerDeg;
        sum[i] += double{sample[i]};
      }
      judge.add(sample);
    }
    for (std::size_t i = 0; i < 3; ++i) mean.rate_rad_s[i] = static_cast<float>(sum[i] / samples);
    means.push_back(mean.rate_rad_s);
    const Calm verdict = judge.judge(mean, {}, predicted_rad_s, variance, white);
    if (verdict == Calm::calm) white.observe(mean);
    return verdict;
  }
  int calm_of(
      int ticks, const std::function<double(double)>& rate_dps = [](double) { return 0.0; }) {
    int calm = 0;
    for (int k = 0; k < ticks; ++k) calm += tick(rate_dps) == Calm::calm ? 1 : 0;
    return calm;
  }
  [[nodiscard]] double white_sigma_dps() const {
    return std::sqrt(double{white.shown_rad2_s2()}) / double{kRadPerDeg};
  }

  int samples;
  Judge judge;
  WhiteLevel<3> white;
  double sigma_dps = 0.05;
  std::uint32_t next = 0;
  std::mt19937 random{1};
  std::normal_distribution<double> normal{};
  std::vector<Rates> means{};
};

TEST(CalmJudgeOfWhiteNoise, FindsNoMotion) {
  for (const int samples : {1, 2, 5, 52}) {
    Stop stop{samples};
    // The three windows of a verdict exceed the limit by chance less than once in 10^5.
    EXPECT_GE(stop.calm_of(2000), 1995) << samples;
    EXPECT_GE(stop.judge.share().percent(), 99) << samples;
  }
}

// A mean of 64 spreads, which overlap: some 64 x 3 x 2 x 0.64 degrees of freedom, so that sigma is
// known within 1 / sqrt(2 x 245), 4.5 %; allowed are four of these.
/// Verifies SR-LEARN-16.
TEST(CalmJudgeOfWhiteNoise, LearnsItsStrengthWhateverTheModelSays) {
  for (const float model_sigma_dps : {0.005F, 0.05F, 0.5F}) {
    Stop stop{5, model_sigma_dps};
    stop.calm_of(400);
    EXPECT_NEAR(stop.white_sigma_dps(), stop.sigma_dps, 0.18 * stop.sigma_dps) << model_sigma_dps;
  }
}

// The oracle takes the sample variance of three means by its definition, in double precision.
TEST(CalmJudgeWithThreeWindows, EstimatesTheWhiteVariance) {
  Stop stop{5};
  stop.calm_of(3);
  double expected = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double mean =
        (double{stop.means[0][i]} + double{stop.means[1][i]} + double{stop.means[2][i]}) / 3.0;
    for (const Rates& one : stop.means) expected += std::pow(double{one[i]} - mean, 2) / 2.0;
  }
  expected *= 5.0 / 3.0;  // variance of a sample, mean of three axes
  EXPECT_NEAR(double{stop.white.shown_rad2_s2()}, expected, 1e-5 * expected);
}

/// Verifies SR-STILL-10.
TEST(CalmJudgeOfARotation, SpoilsTheWindowsAtItsBeginAndEnd) {
  Stop stop{5};
  stop.calm_of(40);
  const auto turn = [](double seconds) { return seconds >= 20.0 && seconds < 25.0 ? 1.0 : 0.0; };
  std::vector<Calm> verdicts;
  for (int k = 0; k < 20; ++k) verdicts.push_back(stop.tick(turn));
  // The turn is in the ticks 0 to 9: its begin is seen by 0 and 1, its end by 10 and 11.
  for (const std::size_t k : {0U, 1U, 10U, 11U}) EXPECT_EQ(verdicts[k], Calm::moved) << k;
  for (const std::size_t k : {3U, 8U, 13U, 19U}) EXPECT_EQ(verdicts[k], Calm::calm) << k;
}

// The rate of a turn lies elsewhere within a step of the samples, and shows another noise.
TEST(CalmJudgeOfATurn, TeachesNothingOfRounding) {
  Stop stop{52};
  stop.calm_of(10);
  constexpr Rates kPredicted{};
  const auto shown = [&] { return stop.white.rounding().state().shown_rad2_s2; };
  const auto turn = [](double) { return 9.0; };
  for (int k = 0; k < 3; ++k) (void)stop.tick(turn, &kPredicted, 1e-9F);  // the turn begins
  const Rates at_rest = shown();
  for (int k = 0; k < 4; ++k) EXPECT_EQ(stop.tick(turn, &kPredicted, 1e-9F), Calm::far);
  EXPECT_EQ(shown(), at_rest);
}

/// Verifies SR-STILL-10.
TEST(CalmJudgeOfARotationOnOneAxisOnly, SeesItToo) {
  Stop stop{5};
  stop.sigma_dps = 0.0;
  std::mt19937 random{3};
  std::normal_distribution<float> normal{0.0F, 0.02F * kRadPerDeg};
  Calm last = Calm::calm;
  for (std::uint32_t k = 0; k < 60; ++k) {
    TickMean<3> mean{.tick = k, .samples = 5};
    for (float& rate : mean.rate_rad_s) rate = normal(random);
    if (k == 59) mean.rate_rad_s[1] += 0.5F * kRadPerDeg;
    last = stop.judge.judge(mean, {}, nullptr, 0.0F, stop.white);
    if (k < 59) {
      EXPECT_EQ(last, Calm::calm) << k;
    }
  }
  EXPECT_EQ(last, Calm::moved);
}

// The vehicle creeps and steers in half of the time of every stop, ten seconds on, ten off.
TEST(CalmJudgeWhereHalfOfAStopIsMotion, LearnsFromTheOtherHalf) {
  Stop stop{5};
  int calm_at_rest = 0;
  int calm_in_motion = 0;
  for (int k = 0; k < 2000; ++k) {
    const bool rests = k / 20 % 2 == 0;
    const Calm verdict = stop.tick([&](double seconds) {
      return rests ? 0.0 : 3.0 * std::sin(2.0 * std::numbers::pi * 0.31 * seconds);
    });
    (rests ? calm_at_rest : calm_in_motion) += verdict == Calm::calm ? 1 : 0;
  }
  // Two of the 20 ticks of a rest see the motion before it.
  EXPECT_GE(calm_at_rest, 1000 * 17 / 20);
  EXPECT_LE(calm_in_motion, 10);
}

TEST(CalmJudgeOfAnEngineThatStarts, LearnsOnFromFastSamples) {
  Stop stop{52};
  stop.sigma_dps = 0.02;
  stop.calm_of(60);
  const auto idle = [](double seconds) {
    return 2.0 * std::numbers::sqrt2 * std::sin(2.0 * std::numbers::pi * 22.5 * seconds);
  };
  EXPECT_GE(stop.calm_of(20, idle), 16);
  EXPECT_GE(stop.calm_of(200), 195);
}

// With one sample a tick there are no neighbours within it: the level rises by 3 % a tick, and a
// noise ten times as strong is calm again within ln(100) / 0.03 ticks, of which the noise that is
// below the limit by chance needs fewer.
TEST(CalmJudgeOfANoiseThatRises, AcceptsItWithinBoundedTime) {
  Stop stop{1};
  stop.sigma_dps = 0.01;
  stop.calm_of(200);
  stop.sigma_dps = 0.1;
  stop.calm_of(154);
  EXPECT_GE(stop.calm_of(100), 95);
  stop.sigma_dps = 0.01;
  EXPECT_GE(stop.calm_of(100), 97);
}

/// Verifies SR-LEARN-15.
TEST(CalmJudgeOfASteadyRateFarFromThePrediction, AcceptsItInTime) {
  Stop stop{5};
  const Rates predicted{};
  std::vector<Calm> verdicts;
  for (int k = 0; k < 20; ++k) {
    verdicts.push_back(stop.tick([](double) { return 1.0; }, &predicted, 1e-10F));
  }
  for (std::size_t k = 0; k < 9; ++k) EXPECT_EQ(verdicts[k], Calm::far) << k;
  for (std::size_t k = 10; k < 20; ++k) EXPECT_EQ(verdicts[k], Calm::calm) << k;
}

TEST(CalmJudgeOfAReadingThatNeverChanges, KeepsAPositiveVariance) {
  Stop stop{5};
  stop.sigma_dps = 0.0;
  EXPECT_EQ(stop.calm_of(500), 500);
  EXPECT_GT(stop.white.shown_rad2_s2(), 0.0F);
  EXPECT_GT(stop.white_sigma_dps(), 0.005 * 0.1);
}

TEST(CalmJudgeOfTicksThatDoNotFollowEachOther, RestartsWindows) {
  Stop stop{5};
  stop.calm_of(40);
  stop.next += 100;
  // Another rate after the gap is no rotation that anybody saw.
  EXPECT_EQ(stop.calm_of(10, [](double) { return 5.0; }), 10);
}

/// Verifies SR-HEALTH-20.
TEST(CalmJudgeOfStops, ReportsADeadBandAfterThreeWithMotion) {
  Stop stop{5};
  stop.calm_of(40);
  const auto rolls = [&](double seconds) { return std::fmod(seconds, 1.0) < 0.5 ? 1.0 : 0.0; };
  for (int k = 0; k < 3; ++k) {
    EXPECT_FALSE(stop.judge.share().has_dead_band());
    stop.judge.end_stop();
    stop.calm_of(4, rolls);
    stop.calm_of(40);
    EXPECT_LT(stop.judge.share().percent(), 100);
    EXPECT_GT(stop.judge.share().percent(), 80);
  }
  stop.judge.end_stop();
  EXPECT_TRUE(stop.judge.share().has_dead_band());
  for (int k = 0; k < 3; ++k) {
    stop.judge.end_stop();
    stop.calm_of(40);
  }
  stop.judge.end_stop();
  EXPECT_FALSE(stop.judge.share().has_dead_band());
  EXPECT_EQ(stop.judge.share().percent(), 100);
}

TEST(CalmJudgeBeforeThreeWindows, HasNoShare) {
  Stop stop{5};
  stop.calm_of(2);
  EXPECT_EQ(stop.judge.share().percent(), CalmShare::kNoPercent);
}

TEST(CalmJudgeRestored, GoesOnBitForBit) {
  Stop one{5};
  one.calm_of(33);
  Stop other{5};
  other.judge.restore(one.judge.state());
  other.random = one.random;
  other.normal = one.normal;
  other.next = one.next;
  one.calm_of(50);
  other.calm_of(50);
  EXPECT_EQ(one.judge.state(), other.judge.state());
}

// Without an odometer nine tenths of the time may be motion.
/// Verifies SR-STILL-11.
TEST(CalmJudgeAlone, FindsTheStopsOfADrive) {
  Stop stop{5, 0.1F, StandstillSource::gyro};
  stop.sigma_dps = 0.02;
  stop.calm_of(60);
  int calm_at_rest = 0;
  int calm_in_motion = 0;
  for (int k = 0; k < 4000; ++k) {
    const bool rests = k % 400 >= 360;
    const Calm verdict = stop.tick([&](double seconds) {
      return rests ? 0.0 : 2.0 * std::sin(1.1 * seconds) + 0.7 * std::sin(4.3 * seconds);
    });
    (rests ? calm_at_rest : calm_in_motion) += verdict == Calm::calm ? 1 : 0;
  }
  EXPECT_GE(calm_at_rest, 400 * 9 / 10);
  EXPECT_LE(calm_in_motion, 36);
}

}  // namespace
}  // namespace zerorate::core
