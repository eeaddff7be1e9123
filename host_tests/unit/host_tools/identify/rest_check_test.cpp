#include "host_tools/lib/identify/rest_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_tools/lib/recording/error.hpp"

namespace zerorate::identify {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kRadPerDeg = 0.017453292519943295;

/// Biases as sensors have them [deg/s].
constexpr std::array kBias_dps{0.5, -0.4, 0.6};

/// Rate about z over 200 s at 100 Hz, beside its bias: a function of time [s] in deg/s; the other
/// axes are bias and noise.
RestSamples samples(const std::function<double(double)>& rate_dps, double noise_dps = 0.05) {
  std::mt19937_64 generator{7};
  std::normal_distribution<double> noise{0.0, noise_dps};
  RestSamples made{.sample_period = core::Duration::milliseconds(10),
                   .mean_period = core::Duration::milliseconds(10)};
  for (int k = 0; k < 20'000; ++k) {
    made.time.push_back(core::Instant::from_ns(k * std::int64_t{10'000'000}));
    const double z = kBias_dps[2] + rate_dps(0.01 * k) + noise(generator);
    const double x = kBias_dps[0] + noise(generator);
    const double y = kBias_dps[1] + noise(generator);
    made.rate_rad_s.push_back({static_cast<float>(x * kRadPerDeg),
                               static_cast<float>(y * kRadPerDeg),
                               static_cast<float>(z * kRadPerDeg)});
  }
  return made;
}

std::vector<std::string> sentences(const RestSamples& rest, bool certain) {
  std::vector<std::string> chosen;
  for (const RestDoubt& doubt : doubts_of_rest(rest)) {
    if (doubt.is_certain == certain) chosen.push_back(doubt.sentence);
  }
  return chosen;
}

/// All names of doubts, as a user types them.
std::string doubt_names_typed() {
  std::string names = doubt_names();
  std::erase(names, ' ');
  return names;
}

/// Remarks on the axes, all of which are wanted.
std::vector<std::string> remarks(const RestSamples& rest, const AcceptedDoubts& accepted = {}) {
  std::vector<std::size_t> axes{0, 1, 2};
  return require_rest(rest, accepted, axes);
}

/// A turn of at most 40 deg/s for four seconds, every twenty.
double turns(double t) {
  const double phase_s = std::fmod(t, 20.0) - 10.0;
  return phase_s > 0.0 && phase_s < 4.0 ? 40.0 * std::sin(phase_s * std::numbers::pi / 4.0) : 0.0;
}

TEST(GyroAtRest, IsBelievedWithWhateverASensorDoes) {
  EXPECT_THAT(doubts_of_rest(samples([](double) { return 12.0; })), IsEmpty());
  EXPECT_THAT(doubts_of_rest(samples([](double t) { return 0.03 * t; })), IsEmpty()) << "a drift";
  EXPECT_THAT(doubts_of_rest(samples([](double t) { return t > 90.0 ? 3.0 : 0.0; })), IsEmpty())
      << "a jump";
  EXPECT_THAT(doubts_of_rest(samples([](double t) { return 2.0 * std::sin(188.0 * t); })),
              IsEmpty())
      << "an engine that idles";
  EXPECT_THAT(doubts_of_rest(samples([](double) { return 0.0; }, 5.0)), IsEmpty())
      << "0.5 deg/s/sqrt(Hz)";
}

TEST(AngleInTheColumnOfARate, IsTold) {
  RestSamples rest = samples([](double) { return 0.3; });
  std::array<float, 3> angle{};
  for (auto& rates : rest.rate_rad_s) {
    for (std::size_t i = 0; i < 3; ++i) rates[i] = angle[i] += 0.01F * rates[i];
  }
  EXPECT_THAT(sentences(rest, true)[0], HasSubstr("angles, not rates?"));
}

/// Takes the mean of the block before off each block of an axis, as software upstream does.
void take_off_means(RestSamples& rest, std::size_t axis, std::size_t block) {
  double bias = kBias_dps[axis] * kRadPerDeg;
  for (std::size_t first = 0; first < rest.rate_rad_s.size(); first += block) {
    const std::size_t end = std::min(first + block, rest.rate_rad_s.size());
    double sum = 0.0;
    for (std::size_t k = first; k < end; ++k) {
      sum += double{rest.rate_rad_s[k][axis]};
      rest.rate_rad_s[k][axis] -= static_cast<float>(bias);
    }
    bias = sum / static_cast<double>(end - first);
  }
}

/// A high-pass of first order, with the time constant in samples.
void high_pass(RestSamples& rest, std::size_t axis, double time_constant) {
  double bias = kBias_dps[axis] * kRadPerDeg;
  for (auto& rates : rest.rate_rad_s) {
    const double rate = double{rates[axis]};
    rates[axis] -= static_cast<float>(bias);
    bias += (rate - bias) / time_constant;
  }
}

// Noise that was made about zero, or a sensor whose mean was taken off the whole recording.
TEST(GyroWithoutABias, IsInNoDoubtWhereItsNoiseIsWhite) {
  for (const double sway_dps : {0.0, 1e-5}) {
    RestSamples rest = samples([&](double t) { return sway_dps * std::sin(0.05 * t); });
    for (auto& rates : rest.rate_rad_s) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        rates[axis] -= static_cast<float>(kBias_dps[axis] * kRadPerDeg);
      }
    }
    EXPECT_THAT(sentences(rest, false), IsEmpty()) << sway_dps;
  }
}

// Within a two-hundredth of the recording, so that slow noise is missing.
TEST(GyroWhoseBiasWasTakenOut, IsTold) {
  for (const std::size_t block : {25U, 50U, 100U}) {
    RestSamples rest = samples([](double t) { return 0.01 * std::sin(0.05 * t); });
    for (std::size_t axis = 0; axis < 3; ++axis) take_off_means(rest, axis, block);
    EXPECT_THAT(sentences(rest, true), IsEmpty());
    EXPECT_THAT(sentences(rest, false), ElementsAre(HasSubstr("every axis is near zero"))) << block;
    EXPECT_THAT(remarks(rest), ElementsAre(HasSubstr("--accept bias")));
    EXPECT_THAT(remarks(rest, AcceptedDoubts{"bias"}), IsEmpty());
  }
}

TEST(GyroWithAHighPass, IsToldWithItsAxis) {
  for (const double time_constant : {20.0, 40.0, 80.0}) {
    RestSamples rest = samples([](double) { return 0.0; });
    high_pass(rest, 1, time_constant);
    EXPECT_THAT(sentences(rest, false), ElementsAre(HasSubstr("the mean of axis y is")))
        << time_constant;
    std::vector<std::size_t> others{0, 2};
    EXPECT_THAT(require_rest(rest, {}, others), IsEmpty()) << "nobody asked for y";
  }
}

TEST(AcceptedDoubt, IsNone) {
  RestSamples rest = samples([](double) { return 0.3; });
  for (auto& rates : rest.rate_rad_s) rates[2] = static_cast<float>(rates[2] > 0.0F);
  try {
    std::vector<std::size_t> axes{2};
    static_cast<void>(require_rest(rest, {}, axes));
    FAIL();
  } catch (const recording::DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--accept "));
  }
  EXPECT_THAT(remarks(rest, AcceptedDoubts{doubt_names_typed()}), IsEmpty());
  EXPECT_THROW(AcceptedDoubts{"count"}, std::invalid_argument);
}

TEST(GyroWithAFrozenAxis, IsToldWithItsAxis) {
  RestSamples rest = samples([](double) { return 0.3; });
  for (std::size_t k = 15'000; k < rest.rate_rad_s.size(); ++k) rest.rate_rad_s[k][2] = 0.0F;
  EXPECT_THAT(sentences(rest, true), ElementsAre(HasSubstr("axis z no longer measures: 4")));
  std::vector<std::size_t> axes{2};
  EXPECT_THROW(static_cast<void>(require_rest(rest, {}, axes)), recording::DataError);
}

TEST(GyroWithAFrozenAxis, KeepsItsOtherAxes) {
  RestSamples rest = samples([](double) { return 0.3; });
  for (auto& rates : rest.rate_rad_s) rates[2] = 34.9F;
  std::vector<std::size_t> all{0, 1, 2};
  EXPECT_THAT(require_rest(rest, {}, all), ElementsAre(HasSubstr("axis z no longer measures")));
  EXPECT_THAT(all, ElementsAre(0, 1));
  std::vector<std::size_t> one{0};
  EXPECT_THAT(require_rest(rest, {}, one), IsEmpty()) << "nobody asked for z";
  EXPECT_THAT(one, ElementsAre(0));
}

TEST(GyroWithFrozenAxesAlone, IsRefused) {
  RestSamples rest = samples([](double) { return 0.3; });
  for (std::size_t k = 10'000; k < rest.rate_rad_s.size(); ++k) {
    rest.rate_rad_s[k] = rest.rate_rad_s[9'999];
  }
  EXPECT_THROW(static_cast<void>(remarks(rest)), recording::DataError);
}

TEST(CoarseGyroAtRest, IsNotTakenForAFrozenOne) {
  constexpr double kStep_rad_s = 0.1 * kRadPerDeg;
  for (const double noise_in_steps : {0.05, 0.2, 0.3}) {
    RestSamples rest = samples([](double t) { return 0.0005 * t; }, 0.1 * noise_in_steps);
    for (auto& rates : rest.rate_rad_s) {
      for (float& rate : rates) {
        rate = static_cast<float>(std::round(double{rate} / kStep_rad_s) * kStep_rad_s);
      }
    }
    EXPECT_THAT(sentences(rest, true), IsEmpty()) << noise_in_steps;
  }
}

TEST(GyroThatWasTurned, IsToldWithShareAndRate) {
  const auto certain = sentences(samples(turns), true);
  ASSERT_EQ(certain.size(), 1);
  EXPECT_THAT(certain[0], HasSubstr("axis z moved in 2"));  // 20 % and the ticks beside the turns
  // The mean over the half second before the crest: 40 cos(3 pi / 8) / (pi / 8) = 38.98.
  EXPECT_THAT(certain[0], HasSubstr("39 deg/s"));
  EXPECT_THAT(certain[0], HasSubstr("--still-from gyro"));
  EXPECT_THROW(static_cast<void>(remarks(samples(turns))), recording::DataError);
  RestSamples separated = samples(turns);
  separated.moving = 100;
  EXPECT_THAT(sentences(separated, true), ElementsAre(HasSubstr("cut the recording to its rest")));
}

TEST(GyroThatWasTurnedOnce, IsTold) {
  const auto rest = samples([](double t) { return t > 50.0 && t < 53.0 ? 20.0 : 0.0; });
  EXPECT_THAT(sentences(rest, true), IsEmpty());
  EXPECT_THAT(sentences(rest, false), ElementsAre(HasSubstr("by up to 20 deg/s")));
  EXPECT_EQ(remarks(rest).size(), 1);
}

TEST(GyroThatWasTurned, IsSeparatedByItsOwnCalm) {
  RestSamples rest = samples(turns);
  leave_out_motion(rest, find_motion(rest, core::StandstillSource::gyro));
  EXPECT_THAT(doubts_of_rest(rest), IsEmpty());
  // The judge leaves out some seconds of the 160 s at rest around each of ten turns.
  EXPECT_GT(rest.time.size(), 9'000);
}

TEST(RawCounts, AreTold) {
  RestSamples rest = samples([](double) { return 7.0; }, 3.0);
  for (auto& rates : rest.rate_rad_s) {
    for (float& rate : rates) {
      rate = static_cast<float>(std::round(double{rate} / kRadPerDeg) * kRadPerDeg);
    }
  }
  EXPECT_THAT(sentences(rest, true), ElementsAre(HasSubstr("raw counts")));
}

TEST(DegreesNamedRadians, AreNoisierThanAnyGyro) {
  const auto rest = samples([](double) { return 0.0; }, 0.5 / kRadPerDeg);
  EXPECT_THAT(sentences(rest, true), ElementsAre(HasSubstr("degrees named radians")));
}

TEST(RadiansNamedDegrees, AreQuieterThanAnyMemsGyro) {
  const auto rest = samples([](double) { return 0.0; }, 0.05 * kRadPerDeg);
  EXPECT_THAT(sentences(rest, true), IsEmpty());
  EXPECT_THAT(sentences(rest, false), ElementsAre(HasSubstr("radians named degrees")));
}

constexpr double kSigma_rad_s = 1e-3;
constexpr int kStops = 20;
constexpr int kSamplesOfStop = 150;  // at 10 Hz
constexpr int kSamplesOfCreep = 15;  // at the end of each stop

RestSamples stops(double creep_rad_s) {
  std::mt19937_64 random{17};
  std::normal_distribution<float> noise{0.0F, static_cast<float>(kSigma_rad_s)};
  RestSamples samples;
  samples.sample_period = core::Duration::milliseconds(100);
  std::int64_t ms = 0;
  for (int stop = 0; stop < kStops; ++stop) {
    if (stop > 0) samples.after_drives.push_back(samples.time.size());
    ms += 60'000;
    for (int k = 0; k < kSamplesOfStop; ++k, ms += 100) {
      const double turning = k >= kSamplesOfStop - kSamplesOfCreep ? creep_rad_s : 0.0;
      samples.time.push_back(core::Instant::from_ns(ms * 1'000'000));
      samples.rate_rad_s.push_back(
          {noise(random), noise(random), static_cast<float>(turning) + noise(random)});
    }
  }
  return samples;
}

TEST(MotionAtRest, IsNotFoundInNoise) {
  const MotionAtRest motion = find_motion(stops(0.0));
  EXPECT_EQ(motion.stops, std::size_t{kStops});
  EXPECT_EQ(motion.stops_with_motion, 0U);
  EXPECT_EQ(motion.share(), 0.0);
  EXPECT_FALSE(motion.is_usual());
}

TEST(MotionAtRest, IsFoundWhereTheVehicleCreepsAndLeftOut) {
  RestSamples samples = stops(20.0 * kSigma_rad_s);
  const MotionAtRest motion = find_motion(samples);
  EXPECT_EQ(motion.stops_with_motion, std::size_t{kStops});
  EXPECT_TRUE(motion.is_usual());
  // The creep, and at most the three windows of half a second that the judgement reaches.
  EXPECT_GE(motion.share(), 0.9 * kSamplesOfCreep / kSamplesOfStop);
  EXPECT_LE(motion.share(), (kSamplesOfCreep + 15.0) / kSamplesOfStop);
  EXPECT_NEAR(motion.turning_rad_s.back(), 20.0 * kSigma_rad_s, 3.0 * kSigma_rad_s);

  leave_out_motion(samples, motion);
  EXPECT_EQ(samples.after_drives.size(), std::size_t{kStops} - 1);
  for (const auto& rate : samples.rate_rad_s) EXPECT_LT(double{rate[2]}, 10.0 * kSigma_rad_s);
  EXPECT_EQ(samples.time.size() + samples.moving, std::size_t{kStops} * kSamplesOfStop);
}

}  // namespace
}  // namespace zerorate::identify
