#include "host_tools/lib/diagnose/selection/selection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "host_tests/support/simulated_rest.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::diagnose {
namespace {

using ::testing::Contains;
using ::testing::Field;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;
using zerorate::testing::kRadPerDeg;

constexpr std::size_t kSamples = 20'000;

/// Swings of 12 K, once and a half and 2.3 times in the record.
std::vector<double> swinging_temperature() {
  std::vector<double> temperature(kSamples);
  for (std::size_t k = 0; k < kSamples; ++k) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(k) / kSamples;
    temperature[k] = 25.0 + 4.0 * std::sin(1.5 * turn + 0.4) + 2.0 * std::sin(2.3 * turn + 2.0);
  }
  return temperature;
}

EvenSeries simulated(const std::vector<simulate::Effect>& more, std::uint64_t run,
                     double flicker_dps = 0.023) {
  std::vector<simulate::Effect> effects{simulate::WhiteNoise{0.065 * kRadPerDeg},
                                        simulate::FlickerNoise{flicker_dps * kRadPerDeg, 0.5}};
  effects.insert(effects.end(), more.begin(), more.end());
  simulate::Signal signal(kSamples, 1.0);
  signal.temperature_degc = swinging_temperature();
  signal = simulate::simulate(std::move(signal), effects, random::RandomStream(31, run));
  EvenSeries series{.period_s = signal.sample_period_s,
                    .rate_rad_s = std::move(signal.rate_rad_s),
                    .temperature_degc = std::move(signal.temperature_degc)};
  series.lost.resize(kSamples);
  return series;
}

std::vector<std::unique_ptr<Effect>> slow_effects() {
  std::vector<std::unique_ptr<Effect>> effects;
  effects.push_back(make_fractional_order());
  effects.push_back(make_correlated_noise());
  effects.push_back(make_temperature_drift());
  return effects;
}

std::vector<std::string_view> names_of(const Selection& selection) {
  std::vector<std::string_view> names;
  for (const Choice& choice : selection.choices) names.push_back(choice.effect->name());
  return names;
}

TEST(SelectionOfAGaussMarkovProcessWithTemperature, NamesBoth) {
  const EvenSeries series =
      simulated({simulate::CorrelatedNoise{0.043 * kRadPerDeg, 125.0},
                 simulate::TemperatureDrift{.linear_rad_s_per_k = 0.016 * kRadPerDeg}},
                1);
  const FitData data(series, 1);
  const std::vector<std::unique_ptr<Effect>> effects = slow_effects();
  const Hypothesis base(data, {});
  const auto order = make_fractional_order()->examine(base);
  const auto markov = make_correlated_noise()->examine(base);
  const auto drift = make_temperature_drift()->examine(base);
  ASSERT_GT(order->surprisal_nats, std::max(markov->surprisal_nats, drift->surprisal_nats));
  const Hypothesis with_order(data, {order->part}, &base);
  ASSERT_LT(make_correlated_noise()->examine(with_order)->surprisal_nats, kSelectionThreshold_nats);
  ASSERT_LT(make_temperature_drift()->examine(with_order)->surprisal_nats,
            kSelectionThreshold_nats);

  const Selection selection = select_effects(data, effects);

  EXPECT_THAT(names_of(selection), UnorderedElementsAre("correlated_noise", "temperature_drift"));
  // The order alone is nearly as good, and that must not be hidden.
  EXPECT_THAT(selection.choices,
              Contains(Field(&Choice::alternatives,
                             Contains(Field(&Alternative::effect, "fractional_order")))));
}

double surprisal(const std::unique_ptr<Effect>& effect, const Hypothesis& without) {
  const std::optional<Candidate> candidate = effect->examine(without);
  return candidate ? candidate->surprisal_nats : 0.0;
}

TEST(SelectionOfAGaussMarkovProcessWithAJump, NamesBoth) {
  const EvenSeries series = simulated({simulate::CorrelatedNoise{0.015 * kRadPerDeg, 30.0},
                                       simulate::BiasJump{0.03 * kRadPerDeg, 9000.0}},
                                      0, 0.0015);
  const FitData data(series, 1);
  std::vector<std::unique_ptr<Effect>> effects;
  effects.push_back(make_correlated_noise());
  effects.push_back(make_bias_jump());
  const Hypothesis base(data, {});
  ASSERT_LT(surprisal(effects[0], base), kSelectionThreshold_nats);
  ASSERT_LT(surprisal(effects[1], base), kSelectionThreshold_nats);

  const Selection selection = select_effects(data, effects);

  EXPECT_THAT(names_of(selection), UnorderedElementsAre("correlated_noise", "bias_jump"));
  for (const Choice& choice : selection.choices) {
    EXPECT_GT(choice.surprisal_nats, kSelectionThreshold_nats);
  }
}

TEST(SelectionOfAGaussMarkovProcessWithARandomWalk, NamesBoth) {
  const EvenSeries series = simulated({simulate::CorrelatedNoise{0.04 * kRadPerDeg, 30.0},
                                       simulate::RateRandomWalk{0.0015 * kRadPerDeg}},
                                      9);
  const FitData data(series, 1);
  std::vector<std::unique_ptr<Effect>> effects;
  effects.push_back(make_fractional_order());
  effects.push_back(make_correlated_noise());
  effects.push_back(make_rate_random_walk());
  const Hypothesis base(data, {});
  const auto order = effects[0]->examine(base);
  ASSERT_GT(order->surprisal_nats,
            std::max(surprisal(effects[1], base), surprisal(effects[2], base)));
  const Hypothesis with_order(data, {order->part}, &base);
  ASSERT_LT(surprisal(effects[1], with_order), kSelectionThreshold_nats);
  ASSERT_LT(surprisal(effects[2], with_order), kSelectionThreshold_nats);

  const Selection selection = select_effects(data, effects);

  EXPECT_THAT(names_of(selection), UnorderedElementsAre("correlated_noise", "rate_random_walk"));
}

TEST(SelectionOfAGaussMarkovProcessAlone, NamesNoTemperature) {
  const EvenSeries series = simulated({simulate::CorrelatedNoise{0.043 * kRadPerDeg, 125.0}}, 2);
  const FitData data(series, 1);
  const std::vector<std::unique_ptr<Effect>> effects = slow_effects();

  const Selection selection = select_effects(data, effects);

  EXPECT_THAT(names_of(selection), SizeIs(1));
  EXPECT_THAT(names_of(selection), Not(Contains("temperature_drift")));
}

TEST(SelectionBesideThatOfMeans, HasTheStrongerEntryOfAnEffect) {
  const EvenSeries series = simulated(
      {simulate::PeriodicDisturbance{.amplitude_rad_s = 0.02 * kRadPerDeg, .frequency_hz = 0.1}},
      3);
  constexpr std::size_t kValues = 20;
  const EvenSeries of_means = means_of(series, kValues);
  const FitData values(series, 1);
  const FitData means(of_means, 1);
  std::vector<std::unique_ptr<Effect>> effects;
  effects.push_back(make_periodic_disturbance());
  effects.push_back(make_correlated_noise());
  const Scope slow{.pace = Pace::slow, .slow_from_s = 4.0 * kValues};
  const Scope fast{.pace = Pace::fast, .slow_from_s = 4.0 * kValues};

  const Selection weak = select_effects(means, effects, slow);
  const Selection both = select_beside(values, effects, fast, means, weak);

  ASSERT_THAT(weak.evidence, Contains(Field(&SelectionEvidence::effect, "periodic_disturbance")));
  for (const auto& effect : effects) {
    EXPECT_LE(std::ranges::count(both.evidence, effect->name(), &SelectionEvidence::effect), 1);
  }
  const auto line =
      std::ranges::find(both.evidence, "periodic_disturbance", &SelectionEvidence::effect);
  ASSERT_NE(line, both.evidence.end());
  EXPECT_GT(line->gain_nats, 100.0);
  EXPECT_TRUE(line->selected);
}

TEST(Scope, GivesAnEffectOfEitherPaceToTheScaleOnWhichItChanges) {
  const auto markov = make_correlated_noise();
  const auto walk = make_rate_random_walk();
  const Scope slow{.pace = Pace::slow, .slow_from_s = 4.0};
  const Scope fast{.pace = Pace::fast, .slow_from_s = 4.0};
  EXPECT_TRUE(slow.is_searched(*markov) && fast.is_searched(*markov));
  EXPECT_TRUE(slow.is_searched(*walk));
  EXPECT_FALSE(fast.is_searched(*walk));
  EXPECT_TRUE(Scope{}.is_searched(*walk));
  for (const double time_scale_s : {0.5, 100.0}) {
    const Candidate candidate{.time_scale_s = time_scale_s};
    EXPECT_EQ(slow.holds(*markov, candidate), time_scale_s > 4.0);
    EXPECT_EQ(fast.holds(*markov, candidate), time_scale_s < 4.0);
    EXPECT_TRUE(Scope{}.holds(*markov, candidate));
  }
}

}  // namespace
}  // namespace zerorate::diagnose
