#include "host_tools/lib/diagnose/diagnose.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host_tests/support/simulated_rest.hpp"
#include "host_tools/lib/diagnose/forecast_gain/gain.hpp"
#include "host_tools/lib/diagnose/forecast_gain/scores.hpp"
#include "host_tools/lib/diagnose/hypothesis/fit_data.hpp"
#include "host_tools/lib/diagnose/materiality.hpp"
#include "host_tools/lib/diagnose/selection/model_export.hpp"
#include "host_tools/lib/diagnose/selection/selection.hpp"
#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::diagnose {
namespace {

using ::testing::Contains;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;
using zerorate::testing::kRadPerDeg;

constexpr std::size_t kSamples = 20'000;
constexpr double kPeriod = 0.1;
constexpr double kTicks =
    kSamples * kPeriod / 0.5;  // half a second each: the base is fitted to them

Record simulated(std::vector<simulate::Effect> more, std::uint64_t run) {
  std::vector<simulate::Effect> effects{simulate::ConstantBias{0.3 * kRadPerDeg},
                                        simulate::WhiteNoise{0.04 * kRadPerDeg},
                                        simulate::FlickerNoise{25.0 / 3600.0 * kRadPerDeg, 0.5}};
  effects.insert(effects.end(), more.begin(), more.end());
  const simulate::Signal signal = simulate::simulate(simulate::Signal(kSamples, kPeriod), effects,
                                                     random::RandomStream(7, run));
  return record_of(zerorate::testing::rest_samples_of(signal), 0);
}

TEST(DiagnosisOfWhiteAndFlickerNoise, IsConsistent) {
  const Diagnosis diagnosis = diagnose(simulated({}, 1));

  EXPECT_EQ(diagnosis.verdict, Verdict::consistent);
  EXPECT_TRUE(diagnosis.causes.empty());
  // Most of a tick's noise is white: N to 1 / sqrt(2 n) of n ticks, and a little more.
  EXPECT_NEAR(diagnosis.base_model.white.angle_random_walk_rad_per_sqrt_s / kRadPerDeg, 0.04,
              0.04 * 5.0 / std::sqrt(2.0 * kTicks));
  ASSERT_TRUE(diagnosis.base_model.flicker);
}

TEST(DiagnosisOfARecordBeyondTheBound, IsOfItsBeginningAndSaysSo) {
  const Diagnosis diagnosis = diagnose(simulated({}, 1), {.most_samples = 5000});

  EXPECT_EQ(diagnosis.samples, 5000U);
  EXPECT_THAT(diagnosis.remarks, Contains(HasSubstr("Of the 20000 samples the first 5000, 500 s")));
}

TEST(DiagnosisOfAJump, NamesItWithHeightAndTimeInTheirIntervals) {
  const double height = 0.05;
  const Diagnosis diagnosis =
      diagnose(simulated({simulate::BiasJump{height * kRadPerDeg, 700.0}}, 2));

  ASSERT_EQ(diagnosis.causes.size(), 1U);
  const Cause& cause = diagnosis.causes.front();
  EXPECT_EQ(cause.effect, "bias_jump");
  EXPECT_EQ(cause.parameters[0].name, "height_dps");
  // Three standard errors, 1.96 of which make half of the interval.
  EXPECT_THAT(
      cause.parameters[0].value,
      DoubleNear(height, 3.0 / 1.96 * (cause.parameters[0].hi - cause.parameters[0].value)));
  EXPECT_EQ(cause.parameters[1].name, "time_s");
  EXPECT_LE(cause.parameters[1].lo, 700.0);
  EXPECT_GE(cause.parameters[1].hi, 700.0);
}

TEST(DiagnosisOfTheMeansOfARecord, NamesItsSlowCausesOnly) {
  constexpr std::size_t kManySamples = 100'000;
  constexpr std::size_t kSamplesAMean = 10;
  const std::vector<simulate::Effect> effects{
      simulate::WhiteNoise{0.04 * kRadPerDeg},
      simulate::FlickerNoise{12.0 / 3600.0 * kRadPerDeg, 0.5},
      simulate::BiasJump{0.04 * kRadPerDeg, 6200.0},
      simulate::PeriodicDisturbance{0.01 * kRadPerDeg, 2.3, 0.4}};
  const simulate::Signal signal = simulate::simulate(simulate::Signal(kManySamples, kPeriod),
                                                     effects, random::RandomStream(7, 31));
  simulate::Signal means(kManySamples / kSamplesAMean, kPeriod * kSamplesAMean);
  for (std::size_t k = 0; k < kManySamples; ++k) {
    means.rate_rad_s[k / kSamplesAMean] += signal.rate_rad_s[k] / kSamplesAMean;
  }
  const auto diagnosis_of = [](const simulate::Signal& of) {
    return diagnose(record_of(zerorate::testing::rest_samples_of(of), 0));
  };
  const Diagnosis fine = diagnosis_of(signal);
  const Diagnosis coarse = diagnosis_of(means);

  EXPECT_THAT(fine.causes, UnorderedElementsAre(Field(&Cause::effect, "periodic_disturbance"),
                                                Field(&Cause::effect, "bias_jump")));
  ASSERT_THAT(coarse.causes, ElementsAre(Field(&Cause::effect, "bias_jump")));
  const auto jump = std::ranges::find(fine.causes, "bias_jump", &Cause::effect);
  ASSERT_NE(jump, fine.causes.end());
  // The means are those on which the slow causes of the samples are judged.
  EXPECT_NEAR(jump->gain_nats, coarse.causes.front().gain_nats, 0.1);
  EXPECT_NEAR(jump->parameters[0].value, coarse.causes.front().parameters[0].value, 1e-3);
}

TEST(DiagnosisOfALine, NamesItWithItsFrequency) {
  const Diagnosis diagnosis =
      diagnose(simulated({simulate::PeriodicDisturbance{0.01 * kRadPerDeg, 1.2345}}, 3));

  ASSERT_EQ(diagnosis.causes.size(), 1U);
  EXPECT_EQ(diagnosis.causes.front().effect, "periodic_disturbance");
  // A line is known to a small part of 1 / (record length).
  EXPECT_NEAR(diagnosis.causes.front().parameters[1].value, 1.2345, 0.1 / (kSamples * kPeriod));
  const bool in_model = diagnosis.causes.front().in_model;
  EXPECT_EQ(diagnosis.extended_model.harmonic.size(), in_model ? 1U : 0U);
}

TEST(ModelOfADiagnosis, TakesAnExtensionThatPaysOnDataHeldOut) {
  const double slope = 7e-4 * kRadPerDeg;
  const Diagnosis diagnosis = diagnose(simulated({simulate::RateRamp{slope}}, 8));

  ASSERT_EQ(diagnosis.causes.size(), 1U);
  EXPECT_TRUE(diagnosis.causes.front().in_model);
  EXPECT_TRUE(diagnosis.causes.front().left_out_because.empty());
  EXPECT_TRUE(diagnosis.extended_model.rate_ramp);
  EXPECT_LT(diagnosis.gain.heading_drift_ratio.value, 1.0);
}

TEST(ModelOfADiagnosis, LeavesOutAnExtensionWithAReason) {
  // The jump lies in the part held out: a walk that stands for it helps no drive before it.
  const Record record = simulated({simulate::BiasJump{0.05 * kRadPerDeg, 1995.0},
                                   simulate::PeriodicDisturbance{0.01 * kRadPerDeg, 4.4}},
                                  9);
  const Diagnosis diagnosis = diagnose(record);

  ASSERT_FALSE(diagnosis.causes.empty());
  for (const Cause& cause : diagnosis.causes) {
    EXPECT_EQ(cause.in_model, cause.left_out_because.empty()) << cause.effect;
  }
  if (!diagnosis.causes.front().in_model) {
    EXPECT_EQ(diagnosis.extended_model, diagnosis.base_model);
  }
}

TEST(ModelOfADiagnosis, HasTheBaseOfAFitByTheFilter) {
  const Record record = simulated({}, 1);
  const identify::RestSamples samples = samples_of(record);
  const core::Duration tick = identify::identification_tick(samples);
  const std::vector<identify::TickMean> means = identify::average_ticks(samples, tick);
  const identify::InnovationsFit fit = identify::fit_noise({means, samples.mean_period, tick, 0});
  const Diagnosis diagnosis = diagnose(record, {.recording = "rest.csv"});

  EXPECT_EQ(diagnosis.base_model,
            identify::model_of(fit, samples.mean_period, "rest.csv", record.axis));
  EXPECT_EQ(diagnosis.extended_model, diagnosis.base_model);
}

TEST(CertaintyOfACause, IsSharedWithItsRivalsByTheirLikelihood) {
  const std::vector<Alternative> rivals{{"correlated_noise", std::log(3.0)}};
  const std::vector<Explanation> shares = weigh("rate_random_walk", 1000.0, rivals);

  ASSERT_EQ(shares.size(), 3U);
  EXPECT_EQ(shares[0].effect, "rate_random_walk");
  EXPECT_DOUBLE_EQ(shares[0].probability, 0.75);
  EXPECT_DOUBLE_EQ(shares[1].probability, 0.25);
  EXPECT_EQ(shares[2].effect, kByChance);
}

TEST(CertaintyOfACause, IsLessWhereChanceIsNear) {
  const double far = weigh("bias_jump", 30.0, {}).front().probability;
  const double near = weigh("bias_jump", 8.2, {}).front().probability;
  EXPECT_GT(far, 0.9999);
  EXPECT_LT(near, 0.97);
  EXPECT_GT(near, 0.9);
}

TEST(DiagnosisOfASquareWave, NamesNoTelegraphAsProven) {
  Record record = simulated({}, 5);
  for (std::size_t k = 0; k < record.size(); ++k) {
    const bool is_high = k % 2800 < 800;
    record.rate_rad_s[k] += is_high ? 0.05 * kRadPerDeg : 0.0;
  }
  const Diagnosis diagnosis = diagnose(record);

  EXPECT_EQ(diagnosis.verdict, Verdict::unexplained);
  EXPECT_THAT(diagnosis.extended_adequacy.failures, Contains(HasSubstr("even intervals")));
}

TEST(DiagnosisOfASawtooth, NamesNoRelaxationAsProven) {
  constexpr std::size_t kTooth = 3500;
  Record record = simulated({}, 6);
  for (std::size_t k = 0; k < record.size(); ++k) {
    const double turns = static_cast<double>((k + 1000) % kTooth) / kTooth;
    record.rate_rad_s[k] -= 0.08 * kRadPerDeg * turns;
  }
  const Diagnosis diagnosis = diagnose(record);

  EXPECT_EQ(diagnosis.verdict, Verdict::unexplained);
  EXPECT_THAT(diagnosis.extended_adequacy.failures, Contains(HasSubstr("jumps at even intervals")));
}

/// Model of what `simulated` makes without more effects.
model::SensorModel true_model() {
  return {.white = {.angle_random_walk_rad_per_sqrt_s = 0.04 * kRadPerDeg},
          .flicker = model::Flicker{.bias_instability_rad_s = 25.0 / 3600.0 * kRadPerDeg}};
}

TEST(DiagnosisAgainstAGivenModel, AcceptsTheTrueModel) {
  const Diagnosis diagnosis = diagnose(simulated({}, 1), {.base_model = true_model()});

  EXPECT_EQ(diagnosis.verdict, Verdict::consistent);
  EXPECT_EQ(diagnosis.base_model, true_model());
  EXPECT_EQ(diagnosis.extended_model, true_model());
}

TEST(DiagnosisAgainstAGivenModel, RefusesAnotherStrength) {
  model::SensorModel other = true_model();
  other.white.angle_random_walk_rad_per_sqrt_s *= 1.2;
  const Diagnosis diagnosis = diagnose(simulated({}, 1), {.base_model = other});

  EXPECT_EQ(diagnosis.verdict, Verdict::unexplained);
  EXPECT_TRUE(diagnosis.causes.empty());
  EXPECT_FALSE(diagnosis.base_adequacy.holds);
  EXPECT_TRUE(std::ranges::any_of(diagnosis.misfit, &Misfit::is_outside));
  EXPECT_THAT(diagnosis.remarks, Contains(HasSubstr("other strengths")));
  // The extended model is the fit, which a user may take instead.
  EXPECT_NEAR(diagnosis.extended_model.white.angle_random_walk_rad_per_sqrt_s / kRadPerDeg, 0.04,
              0.04 * 5.0 / std::sqrt(2.0 * kTicks));
}

TEST(DiagnosisAgainstAGivenModel, NamesOnlyWhatTheModelLacks) {
  const double walk = 1e-3 * kRadPerDeg;
  const Record record = simulated({simulate::RateRandomWalk{walk}}, 6);
  model::SensorModel with_walk = true_model();
  with_walk.rate_random_walk = model::RateRandomWalk{walk};

  const Diagnosis lacking = diagnose(record, {.base_model = true_model()});
  EXPECT_EQ(lacking.verdict, Verdict::explained);
  ASSERT_FALSE(lacking.causes.empty());
  EXPECT_EQ(lacking.causes.front().effect, "rate_random_walk");
  const Diagnosis complete = diagnose(record, {.base_model = with_walk});
  EXPECT_EQ(complete.verdict, Verdict::consistent);
  EXPECT_TRUE(complete.causes.empty());
}

TEST(DiagnosisAgainstAGivenModel, FitsTheTurnOn) {
  const Record record = simulated(
      {simulate::RateRamp{5e-5 * kRadPerDeg}, simulate::WarmUpTransient{0.1 * kRadPerDeg, 90.0}},
      7);
  model::SensorModel given = true_model();
  given.rate_ramp = model::RateRamp{.slope_sigma_rad_s2 = 1e-4 * kRadPerDeg};
  given.warm_up = model::WarmUp{.amplitude_sigma_rad_s = 0.1 * kRadPerDeg, .time_constant_s = 90.0};
  EXPECT_EQ(diagnose(record, {.base_model = given}).verdict, Verdict::consistent);
}

TEST(DiagnosisOfARecord, IsTheSameTwice) {
  const Record record = simulated({simulate::RateRandomWalk{3e-4 * kRadPerDeg}}, 4);
  const Diagnosis first = diagnose(record);
  const Diagnosis second = diagnose(record);
  ASSERT_EQ(first.causes.size(), second.causes.size());
  for (std::size_t i = 0; i < first.causes.size(); ++i) {
    EXPECT_EQ(first.causes[i].gain_nats, second.causes[i].gain_nats);
  }
  EXPECT_EQ(first.extended_model, second.extended_model);
}

TEST(DiagnosisWithoutATemperature, SaysThatItsDriftWasNotExamined) {
  const Diagnosis diagnosis = diagnose(simulated({}, 1), {.holdout = 0.0});
  const auto drift =
      std::ranges::find(diagnosis.evidence, "temperature_drift", &SelectionEvidence::effect);
  ASSERT_NE(drift, diagnosis.evidence.end());
  EXPECT_EQ(drift->not_examined, "no temperature");
  EXPECT_FALSE(drift->selected);
}

/// Remainder beside the true model.
Materiality remainder_of(const Record& record) {
  const PreparedAxis axis(record, 1);
  const auto materiality = weigh_remainder(hypothesis_of(axis.data(), true_model()), true_model());
  EXPECT_TRUE(materiality);
  return materiality.value_or(Materiality{});
}

TEST(RemainderOfNothing, IsNotMaterial) {
  const Materiality nothing = remainder_of(simulated({}, 11));
  ASSERT_FALSE(nothing.by_drive.empty());
  EXPECT_NE(nothing.is_material(), true);
  for (const HeadingExcess& excess : nothing.by_drive) {
    EXPECT_LE(excess.ratio.lo, 1.0);
    EXPECT_GE(excess.ratio.hi, 1.0);
  }
}

TEST(RemainderThatSwingsFromStopToDrive, IsMaterial) {
  // The heading changes by 3 deg over 60 s, where the white noise sums up to 0.3 deg.
  Record record = simulated({}, 11);
  for (std::size_t k = 0; k < record.size(); ++k) {
    record.rate_rad_s[k] += k % 1300 < 650 ? 0.05 * kRadPerDeg : 0.0;
  }
  const Materiality swings = remainder_of(record);
  EXPECT_EQ(swings.is_material(), true);
  const auto longest = std::ranges::max_element(swings.by_drive, {}, &HeadingExcess::drive_s);
  EXPECT_GT(longest->ratio.value, 1.5);
}

/// Five samples at once every half second: the median interval is far shorter than the mean one.
Record in_bursts(Record record) {
  for (std::size_t k = 0; k < record.size(); ++k) {
    record.time_s[k] = 0.5 * static_cast<double>(k / 5) + 1e-3 * static_cast<double>(k % 5);
  }
  record.sample_period_s = 1e-3;
  record.mean_period_s = kPeriod;
  return record;
}

TEST(BaseOfARecordInBursts, HasTheNoiseOfTheMeanInterval) {
  const Record record = in_bursts(simulated({}, 1));
  const identify::Characterization characterized =
      identify::characterize(samples_of(record), {.axes = {0}, .order = 0.5});

  // N^2 = r T: with the median interval it would be a tenth. One tick holds five samples.
  EXPECT_NEAR(characterized.axes.front().model.white.angle_random_walk_rad_per_sqrt_s / kRadPerDeg,
              0.04, 0.04 * 5.0 / std::sqrt(2.0 * kTicks));
  EXPECT_GE(characterized.tick.ns(), 100'000'000);
}

TEST(GainOnARecordInBursts, IsOfIntervalsThatCover) {
  model::SensorModel white = true_model();
  white.flicker.reset();
  simulate::Signal signal(kSamples, kPeriod);
  const std::vector<simulate::Effect> effects{simulate::WhiteNoise{0.04 * kRadPerDeg}};
  signal = simulate::simulate(std::move(signal), effects, random::RandomStream(7, 12));
  const Record record = in_bursts(record_of(zerorate::testing::rest_samples_of(signal), 0));
  const Gain gain = measure_gain(record, white, white, 0.5, 1);

  // 24 drives: a node that takes ticks for a tenth as noisy covers less than half of them.
  EXPECT_GE(gain.coverage95_base.value, 0.8);
}

TEST(GainOfAModelThatTheNodeCannotRun, IsRefusedByAnErrorOfItsOwn) {
  model::SensorModel loud = true_model();
  loud.gauss_markov = {{.sigma_rad_s = 1e25, .time_constant_s = 1.0}};
  EXPECT_THROW(static_cast<void>(measure_gain(simulated({}, 1), true_model(), loud, 0.3, 1)),
               ModelCannotRun);
}

TEST(DiagnosisOfTooLittle, IsRefused) {
  Record record = simulated({}, 5);
  record.time_s.resize(200);
  record.rate_rad_s.resize(200);
  EXPECT_THROW(static_cast<void>(diagnose(record)), recording::DataError);
  Record constant = simulated({}, 5);
  constant.rate_rad_s.assign(constant.size(), 0.1);
  EXPECT_THROW(static_cast<void>(diagnose(constant)), recording::DataError);
  // A stop in which a coarse sensor shows one level, but for a few samples.
  for (std::size_t k = 0; k < constant.size() / 100; ++k) constant.rate_rad_s[97 * k] += 0.01;
  EXPECT_THROW(static_cast<void>(diagnose(constant)), recording::DataError);
}

TEST(DiagnosisOfSeveralAxes, LeavesOutAnEmptyOneIfAsked) {
  const Record record = simulated({}, 6);
  Record constant = record;
  constant.axis = "y";
  constant.rate_rad_s.assign(constant.size(), 0.1);
  EXPECT_THROW(static_cast<void>(diagnose({record, constant})), recording::DataError);
  std::string left_out;
  DiagnoseOptions options{.holdout = 0.0};
  options.on_left_out = [&](const std::string& axis, const std::string&) { left_out += axis; };
  EXPECT_EQ(diagnose({record, constant}, options).size(), 1U);
  EXPECT_EQ(left_out, "y");
  EXPECT_THROW(static_cast<void>(diagnose({constant}, options)), recording::DataError);
}

}  // namespace
}  // namespace zerorate::diagnose
