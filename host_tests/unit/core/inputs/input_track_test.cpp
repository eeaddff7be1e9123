#include "core/inputs/input_track.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace zerorate::core {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr TemperatureDrift kDrift{.reference_degc = 25.0F, .slope_sigma_rad_s_per_k = 1.0F};
constexpr ModelShape kShape{.decaying = 1, .inputs = 2};
constexpr InputTerms<2> kTerms = kDrift.terms();
constexpr Duration kTick = Duration::milliseconds(500);
using Track = InputTrack<kShape>;
using Span = TransitionWithInputs<kShape>;

constexpr Instant at_ms(std::int64_t ms) {
  return Instant::from_ns(ms * 1'000'000);
}

/// A sample every 100 ms, ticks of 500 ms, from `from_ms` up to `to_ms`.
template <class Temperature>
void run(Track& track, std::int64_t from_ms, std::int64_t to_ms, Temperature degc_at) {
  for (std::int64_t ms = from_ms; ms < to_ms; ms += 100) {
    track.take(at_ms(ms), ms % 500 == 0, degc_at(ms));
  }
}

TEST(UnknownInput, WandersFromTheMomentItWasMeasured) {
  EXPECT_EQ(unknown_change(Input::temperature, 0.0F, 0.0F), 0.0F);
  EXPECT_NEAR(unknown_change(Input::temperature, 0.0F, 0.25F), 0.05F, 1e-6F);
  EXPECT_NEAR(unknown_change(Input::temperature, 0.0F, 3600.0F), 6.0F, 1e-5F);
  EXPECT_NEAR(unknown_change(Input::temperature_squared, 3.0F, 0.25F), 0.3F, 1e-6F);
}

TEST(InputTrack, HasTheMeanOfTheTickBefore) {
  Track track{kTerms, kTick};
  run(track, 0, 1'100, [](std::int64_t ms) { return 25.0F + static_cast<float>(ms) * 1e-3F; });
  EXPECT_TRUE(track.tick().is_known(InputSource::thermometer));
  EXPECT_NEAR(track.tick().weights[0], 0.7F, 1e-5F);  // 0.5 to 0.9 K
  EXPECT_NEAR(track.tick().weights[1], 0.49F, 1e-5F);
}

TEST(InputTrackAtTheFirstSample, HasItsReading) {
  Track track{kTerms, kTick};
  track.take(at_ms(0), true, 27.0F);
  EXPECT_FALSE(track.misses_temperature(at_ms(0)));
  track.take(at_ms(500), true, 27.0F);
  EXPECT_EQ(track.tick().weights[0], 2.0F);
}

TEST(InputTrackOfALaggingElement, FollowsItsStepResponse) {
  TemperatureDrift drift = kDrift;
  drift.lag_s = 20.0F;
  const InputTerms<2> terms = drift.terms();
  Track track{terms, kTick};
  run(track, 0, 40'600, [](std::int64_t ms) { return ms < 500 ? 25.0F : 35.0F; });
  // Two time constants, at the beginning of the tick of 40.5 s.
  EXPECT_NEAR(double{track.tick().weights[0]}, 10.0 * (1.0 - std::exp(-2.0)), 1e-4);
}

/// Verifies SR-INT-07.
TEST(InputTrackWithoutReadings, KeepsTheLastFor5Seconds) {
  Track track{kTerms, kTick};
  const auto lost = [](std::int64_t ms) { return ms < 2'000 ? 30.0F : kNan; };
  run(track, 0, 2'100, lost);
  Span span{};
  track.measure(track.tick(), 5, span);
  run(track, 2'100, 6'600, lost);
  EXPECT_FALSE(track.misses_temperature(at_ms(6'900)));
  EXPECT_TRUE(track.tick().is_known(InputSource::thermometer));
  run(track, 6'600, 22'000, lost);
  EXPECT_TRUE(track.misses_temperature(at_ms(22'000)));
  EXPECT_EQ(track.tick().weights[0], 5.0F);
  track.lead_over(39, span);
  EXPECT_EQ(span.inputs.change[0], 0.0F);
  // Since 1.9 s, at 21.5 s: 0.01 K2/s.
  EXPECT_NEAR(span.inputs.unknown[0], std::sqrt(0.196F), 1e-5F);
  EXPECT_NEAR(span.inputs.unknown[1], 10.0F * std::sqrt(0.196F), 1e-4F);

  // Back again: what was measured before the loss is compared with what is known now.
  run(track, 22'000, 23'100, [](std::int64_t) { return 33.0F; });
  track.lead_over(42, span);
  EXPECT_TRUE(span.inputs.is_known());
  EXPECT_NEAR(span.inputs.change[0], 3.0F, 1e-5F);
}

TEST(InputTrackThatMeasuredWithoutReadings, HasNoChange) {
  Track track{kTerms, kTick};
  run(track, 0, 10'100, [](std::int64_t ms) { return ms < 1'000 ? 30.0F : kNan; });
  Span span{};
  track.measure(track.tick(), 21, span);
  run(track, 10'100, 14'600, [](std::int64_t) { return 40.0F; });
  track.measure(track.tick(), 9, span);
  EXPECT_EQ(span.inputs.change[0], 0.0F);
  EXPECT_NEAR(span.inputs.unknown[0], std::sqrt(0.045F), 1e-5F);  // 10 to 14.5 s
}

TEST(InputTrackGivenNonsense, TakesItForNoReading) {
  Track track{kTerms, kTick};
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const float nonsense : {kNan, kInf, -kInf, 1e6F, -273.0F}) {
    track.take(at_ms(0), true, nonsense);
    EXPECT_TRUE(track.misses_temperature(at_ms(0))) << nonsense;
  }
}

TEST(InputTrackOverADrive, SumsTheChangesTickByTick) {
  Track track{kTerms, kTick};
  const auto rising = [](std::int64_t ms) { return 25.0F + static_cast<float>(ms / 500); };
  run(track, 0, 1'000, rising);
  Span lead{};
  track.measure(track.tick(), 2, lead);  // at 500 ms, of the tick before: 0 K
  for (std::uint32_t ticks = 1; ticks <= 10; ++ticks) {
    const std::int64_t ms = 500 + 500 * std::int64_t{ticks};
    run(track, ms, ms + 500, rising);
    track.lead_over(ticks, lead);
  }
  EXPECT_NEAR(lead.inputs.change[0], 10.0F, 1e-5F);
  EXPECT_NEAR(lead.inputs.sum[0], 55.0F, 1e-4F);
  lead.ticks = 10;
  Span drive{};
  drive.ticks = 14;  // four of them are still to come
  Track::over_drive(lead, 10, drive);
  EXPECT_NEAR(drive.inputs.sum[0], 55.0F + 40.0F, 1e-3F);
}

TEST(InputTrackOfAModelWithoutTemperature, MissesNothing) {
  const InputTerms<2> terms = TemperatureDrift{}.terms();
  Track track{terms, kTick};
  track.take(at_ms(0), true, kNan);
  EXPECT_FALSE(track.misses_temperature(at_ms(0)));
}

/// A bias that follows the specific force along x and the vibration.
constexpr ModelShape kMovingShape{.decaying = 1, .inputs = 2, .has_accelerometer = true};
constexpr InputTerms<2> kForceAndVibration{
    .terms = {{{Input::acceleration_x, 1.0F, {}}, {Input::vibration, 1.0F, {}}}}};
using MovingTrack = InputTrack<kMovingShape>;

/// A sample every 100 ms with a specific force along x [g].
template <class Force>
void run_with_force(MovingTrack& track, std::int64_t from_ms, std::int64_t to_ms, Force force_at) {
  for (std::int64_t ms = from_ms; ms < to_ms; ms += 100) {
    track.take(at_ms(ms), ms % 500 == 0, kNan);
    track.take_acceleration(at_ms(ms), {standard_gravity(force_at(ms)), standard_gravity(0.0F),
                                        standard_gravity(1.0F)});
  }
}

TEST(InputTrackWithForces, PredictsByTheTickBefore) {
  MovingTrack track{kForceAndVibration, kTick};
  // 0.1 g in the first tick, 0.2 g and 0.4 g in turn in the second.
  run_with_force(track, 0, 1'000, [](std::int64_t ms) {
    if (ms < 500) return 0.1F;
    return ms % 200 == 0 ? 0.4F : 0.2F;
  });
  EXPECT_NEAR(track.tick().weights[0], 0.1F, 1e-6F);
  EXPECT_NEAR(track.tick().weights[1], 0.0F, 1e-7F);
  // Three of 0.2 g and two of 0.4 g: mean 0.28 g, variance (3 0.08^2 + 2 0.12^2) / 4.
  EXPECT_NEAR(track.measurement().weights[0], 0.28F, 1e-6F);
  EXPECT_NEAR(track.measurement().weights[1], 0.012F, 1e-6F);
}

TEST(InputTrackWithForces, SumsTheirChangesOverADrive) {
  MovingTrack track{kForceAndVibration, kTick};
  run_with_force(track, 0, 1'000, [](std::int64_t) { return 0.0F; });
  TransitionWithInputs<kMovingShape> lead{};
  track.measure(track.measurement(), 2, lead);
  // A slope of 0.05 g for ten ticks; the first tick of it is predicted by the level one.
  for (std::uint32_t ticks = 1; ticks <= 10; ++ticks) {
    const std::int64_t ms = 500 + 500 * std::int64_t{ticks};
    run_with_force(track, ms, ms + 500, [](std::int64_t) { return 0.05F; });
    track.lead_over(ticks, lead);
  }
  EXPECT_NEAR(lead.inputs.change[0], 0.05F, 1e-6F);
  EXPECT_NEAR(lead.inputs.sum[0], 9.0F * 0.05F, 1e-5F);
  EXPECT_TRUE(lead.inputs.is_known());
}

/// Verifies SR-INT-07.
TEST(InputTrackWithoutForces, WidensByWhatAnAttitudeMayBe) {
  MovingTrack track{kForceAndVibration, kTick};
  run_with_force(track, 0, 1'000, [](std::int64_t) { return 0.3F; });
  TransitionWithInputs<kMovingShape> lead{};
  track.measure(track.measurement(), 2, lead);
  for (std::int64_t ms = 1'000; ms < 200'000; ms += 100) {
    track.take(at_ms(ms), ms % 500 == 0, kNan);
    if (ms == 1'900) {
      EXPECT_FALSE(track.misses_acceleration(at_ms(ms)));
    }
    if (ms == 11'000) {
      track.fill_lead(20, lead);
      // From 0.9 s to 11 s at 0.01 g2/s.
      EXPECT_NEAR(lead.inputs.unknown[0], std::sqrt(0.101F), 1e-5F);
      EXPECT_EQ(lead.inputs.change[0], 0.0F);
    }
  }
  EXPECT_TRUE(track.misses_acceleration(at_ms(200'000)));
  track.fill_lead(400, lead);
  EXPECT_EQ(lead.inputs.unknown[0], 1.0F) << "no attitude is farther away";
}

}  // namespace
}  // namespace zerorate::core
