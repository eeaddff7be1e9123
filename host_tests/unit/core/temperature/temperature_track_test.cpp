#include "core/temperature/temperature_track.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace zerorate::core {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr TemperatureDrift kDrift{.reference_degc = 25.0F, .slope_sigma_rad_s_per_k = 1.0F};
using Track = TemperatureTrack<2>;
using TemperedTransition =
    TransitionWithTemperature<ModelShape{.decaying = 1, .temperature_weights = 2}>;

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

TEST(TemperatureTrack, HasTheMeanOfTheTickBefore) {
  Track track{kDrift};
  run(track, 0, 1'100, [](std::int64_t ms) { return 25.0F + static_cast<float>(ms) * 1e-3F; });
  EXPECT_TRUE(track.tick().is_known);
  EXPECT_NEAR(track.tick().weights[0], 0.7F, 1e-5F);  // 0.5 to 0.9 K
  EXPECT_NEAR(track.tick().weights[1], 0.49F, 1e-5F);
}

TEST(TemperatureTrackAtTheFirstSample, HasItsReading) {
  Track track{kDrift};
  track.take(at_ms(0), true, 27.0F);
  EXPECT_FALSE(track.is_missed(at_ms(0)));
  track.take(at_ms(500), true, 27.0F);
  EXPECT_EQ(track.tick().weights[0], 2.0F);
}

TEST(TemperatureTrackOfALaggingElement, FollowsItsStepResponse) {
  TemperatureDrift drift = kDrift;
  drift.lag_s = 20.0F;
  Track track{drift};
  run(track, 0, 40'600, [](std::int64_t ms) { return ms < 500 ? 25.0F : 35.0F; });
  // Two time constants, at the beginning of the tick of 40.5 s.
  EXPECT_NEAR(double{track.tick().weights[0]}, 10.0 * (1.0 - std::exp(-2.0)), 1e-4);
}

TEST(TemperatureTrackWithoutReadings, KeepsTheLastFor5Seconds) {
  Track track{kDrift};
  const auto lost = [](std::int64_t ms) { return ms < 2'000 ? 30.0F : kNan; };
  run(track, 0, 2'100, lost);
  TemperedTransition span{};
  track.measure(track.tick(), span);
  run(track, 2'100, 6'600, lost);
  EXPECT_FALSE(track.is_missed(at_ms(6'900)));
  EXPECT_TRUE(track.tick().is_known);
  run(track, 6'600, 22'000, lost);
  EXPECT_TRUE(track.is_missed(at_ms(22'000)));
  EXPECT_EQ(track.tick().weights[0], 5.0F);
  track.lead_over(39, span);
  EXPECT_EQ(span.temperature.change[0], 0.0F);
  // Since 1.9 s, at 21.5 s: 0.01 K2/s.
  EXPECT_NEAR(span.temperature.unknown[0], std::sqrt(0.196F), 1e-5F);
  EXPECT_NEAR(span.temperature.unknown[1], 10.0F * std::sqrt(0.196F), 1e-4F);

  // Back again: what was measured before the loss is compared with what is known now.
  run(track, 22'000, 23'100, [](std::int64_t) { return 33.0F; });
  track.lead_over(42, span);
  EXPECT_TRUE(span.temperature.is_known());
  EXPECT_NEAR(span.temperature.change[0], 3.0F, 1e-5F);
}

TEST(TemperatureTrackThatMeasuredWithoutReadings, HasNoChange) {
  Track track{kDrift};
  run(track, 0, 10'100, [](std::int64_t ms) { return ms < 1'000 ? 30.0F : kNan; });
  TemperedTransition span{};
  track.measure(track.tick(), span);
  run(track, 10'100, 14'600, [](std::int64_t) { return 40.0F; });
  track.measure(track.tick(), span);
  EXPECT_EQ(span.temperature.change[0], 0.0F);
  EXPECT_NEAR(span.temperature.unknown[0], std::sqrt(0.045F), 1e-5F);  // 10 to 14.5 s
}

TEST(TemperatureTrackGivenNonsense, TakesItForNoReading) {
  Track track{kDrift};
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const float nonsense : {kNan, kInf, -kInf, 1e6F, -273.0F}) {
    track.take(at_ms(0), true, nonsense);
    EXPECT_TRUE(track.is_missed(at_ms(0))) << nonsense;
  }
}

TEST(TemperatureTrackOverADrive, SumsTheChangesTickByTick) {
  Track track{kDrift};
  const auto rising = [](std::int64_t ms) { return 25.0F + static_cast<float>(ms / 500); };
  run(track, 0, 1'000, rising);
  TemperedTransition lead{};
  track.measure(track.tick(), lead);  // at 500 ms, of the tick before: 0 K
  for (std::uint32_t ticks = 1; ticks <= 10; ++ticks) {
    const std::int64_t ms = 500 + 500 * std::int64_t{ticks};
    run(track, ms, ms + 500, rising);
    track.lead_over(ticks, lead);
  }
  EXPECT_NEAR(lead.temperature.change[0], 10.0F, 1e-5F);
  EXPECT_NEAR(lead.temperature.sum[0], 55.0F, 1e-4F);
  lead.ticks = 10;
  TemperedTransition drive{};
  drive.ticks = 14;  // four of them are still to come
  Track::over_drive(lead, 10, drive);
  EXPECT_NEAR(drive.temperature.sum[0], 55.0F + 40.0F, 1e-3F);
}

TEST(TemperatureTrackOfAModelWithoutTemperature, MissesNothing) {
  Track track{TemperatureDrift{}};
  track.take(at_ms(0), true, kNan);
  EXPECT_FALSE(track.is_missed(at_ms(0)));
}

}  // namespace
}  // namespace zerorate::core
