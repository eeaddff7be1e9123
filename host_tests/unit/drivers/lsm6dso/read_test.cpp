/// @file
/// Samples, over both buses and in both modes.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host_tests/unit/drivers/lsm6dso/rig.hpp"

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using hal::testing::Fault;
using lsm6dso::FullScale;
using lsm6dso::Mode;
using lsm6dso::Settings;

constexpr Rates kTurning{deg_per_s(10.0F), deg_per_s(-20.0F), deg_per_s(30.0F)};

template <class Wiring>
class Lsm6dsoSamples : public ::testing::Test {};
template <class Wiring>
class Lsm6dsoFifo : public ::testing::Test {};
using Wirings = ::testing::Types<OverSpi, OverI2c>;
TYPED_TEST_SUITE(Lsm6dsoSamples, Wirings);
TYPED_TEST_SUITE(Lsm6dsoFifo, Wirings);

constexpr std::array kModes{Settings{.mode = Mode::data_ready}, Settings{.mode = Mode::fifo}};

TYPED_TEST(Lsm6dsoSamples, ThereIsNoneBeforeTheChipMeasured) {
  for (const Settings& settings : kModes) {
    Rig<TypeParam> rig{settings};
    ASSERT_TRUE(rig.start_and_settle());
    std::array<GyroSample, 4> out{};
    const auto count = rig.read(out);
    ASSERT_TRUE(count);
    EXPECT_EQ(*count, 0U);
  }
}

TYPED_TEST(Lsm6dsoSamples, EachComesOnceWithItsTimeAndTemperature) {
  for (const Settings& settings : kModes) {
    Rig<TypeParam> rig{settings};
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample(kTurning, core::Temperature::from_degc(-12.5F));
    std::array<GyroSample, 4> out{};
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    EXPECT_EQ(out[0].time, rig.clock.now());
    EXPECT_TRUE(out[0].has_temperature);
    EXPECT_EQ(out[0].temperature.degc(), -12.5F);
    EXPECT_EQ(out[0].saturated_axes, 0);
    EXPECT_EQ(rig.read(out).value_or(9), 0U);
  }
}

TYPED_TEST(Lsm6dsoSamples, ReturnTheRateToHalfAnLsbInEveryRange) {
  struct Range {
    FullScale full_scale;
    float lsb_dps;
    float span_dps;
  };
  for (const Range& range :
       {Range{FullScale::dps_125, 4.375e-3F, 124.0F}, Range{FullScale::dps_250, 8.75e-3F, 249.0F},
        Range{FullScale::dps_500, 17.5e-3F, 499.0F}, Range{FullScale::dps_1000, 35e-3F, 999.0F},
        Range{FullScale::dps_2000, 70e-3F, 1999.0F}}) {
    Rig<TypeParam> rig{{.full_scale = range.full_scale}};
    ASSERT_TRUE(rig.start_and_settle());
    std::mt19937 random{20240611};
    std::uniform_real_distribution<float> rate{-range.span_dps, range.span_dps};
    // Half an LSB, and the float rounding of values up to the full scale on both ways.
    const float tolerance = 0.5F * range.lsb_dps + 4.0F * range.span_dps * std::exp2(-24.0F);
    std::array<GyroSample, 1> out{};
    for (int i = 0; i < 200; ++i) {
      const Rates sent{deg_per_s(rate(random)), deg_per_s(rate(random)), deg_per_s(rate(random))};
      rig.sample(sent);
      ASSERT_EQ(rig.read(out).value_or(0), 1U);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(out[0].rate[axis].in(deg_per_s), sent[axis].in(deg_per_s), tolerance);
      }
    }
  }
}

TYPED_TEST(Lsm6dsoSamples, SayWhichAxisIsSaturated) {
  for (const Settings& settings : kModes) {
    Rig<TypeParam> rig{settings};
    ASSERT_TRUE(rig.start_and_settle());
    std::array<GyroSample, 1> out{};
    rig.sample({deg_per_s(249.9F), deg_per_s(-1000.0F), deg_per_s(0.0F)});
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    EXPECT_EQ(out[0].saturated_axes, 0b010);
    EXPECT_NEAR(out[0].rate[1].in(deg_per_s), -32768 * 8.75e-3F, 1e-3F);
    rig.sample({deg_per_s(300.0F), deg_per_s(0.0F), deg_per_s(251.0F)});
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    EXPECT_EQ(out[0].saturated_axes, 0b101);
    EXPECT_EQ(out[0].rate[1].in(deg_per_s), 0.0F);
  }
}

TYPED_TEST(Lsm6dsoSamples, OfThePowerUpNeverComeOut) {
  for (const Settings& settings : kModes) {
    Rig<TypeParam> rig{settings};
    ASSERT_TRUE(rig.start());
    const core::Instant powered = rig.clock.now();
    std::array<GyroSample, 1> out{};
    core::Instant first{};
    for (int i = 0; i < 30; ++i) {
      rig.sample({});
      const auto count = rig.read(out);
      ASSERT_TRUE(count);
      if (*count == 0) continue;
      if (first == core::Instant{}) first = out[0].time;
      // The simulated chip's transient is at least 20 deg/s / 70 ms * 1 ns until 70 ms are over.
      for (const auto rate : out[0].rate) EXPECT_EQ(rate.in(deg_per_s), 0.0F);
    }
    EXPECT_GE(first - powered, core::Duration::milliseconds(70) + rig.driver.sample_period() * 3);
    EXPECT_LE(first - powered, core::Duration::milliseconds(70) + rig.driver.sample_period() * 5);
  }
}

TYPED_TEST(Lsm6dsoSamples, RaiseTheInterruptPinAtTheTimeOfTheConversion) {
  Rig<TypeParam> rig;
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample(kTurning);
  const core::Instant converted = rig.clock.now();
  rig.clock.advance(core::Duration::microseconds(300));
  const auto edge = rig.chip.int1().take_edge();
  ASSERT_TRUE(edge);
  EXPECT_EQ(*edge, converted);
  std::array<GyroSample, 1> out{};
  ASSERT_EQ(rig.driver.read(*edge, out).value_or(0), 1U);
  EXPECT_EQ(out[0].time, converted);
  EXPECT_FALSE(rig.chip.int1().level());
}

TYPED_TEST(Lsm6dsoSamples, MayCarryTimesBeforeZero) {
  for (const Settings& settings : kModes) {
    Rig<TypeParam> rig{settings, 0, core::Instant{} - core::Duration::seconds(10)};
    ASSERT_TRUE(rig.start_and_settle());
    std::array<GyroSample, 4> out{};
    for (int i = 0; i < 2; ++i) rig.sample(kTurning);
    const std::size_t count = rig.read(out).value_or(0);
    ASSERT_GE(count, 1U);
    EXPECT_EQ(out[count - 1].time, rig.clock.now());
    EXPECT_LT(rig.clock.now(), core::Instant{});
  }
}

TYPED_TEST(Lsm6dsoSamples, AreNotReadIntoAnEmptyBuffer) {
  Rig<TypeParam> rig;
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample(kTurning);
  EXPECT_EQ(rig.read({}).value_or(9), 0U);
  std::array<GyroSample, 1> out{};
  EXPECT_EQ(rig.read(out).value_or(0), 1U);
}

TYPED_TEST(Lsm6dsoSamples, ABusErrorIsReportedAndTheNextReadGoesOn) {
  for (const Settings& settings : kModes) {
    for (std::size_t call = 0; call < 2; ++call) {
      for (const auto kind : {Fault::Kind::refused, Fault::Kind::after_effect}) {
        Rig<TypeParam> rig{settings};
        ASSERT_TRUE(rig.start_and_settle());
        rig.sample(kTurning);
        rig.faults.inject(
            {.kind = kind, .first = rig.faults.calls() + call, .error = hal::BusError::overrun});
        std::array<GyroSample, 4> out{};
        const auto failed = rig.read(out);
        ASSERT_FALSE(failed);
        EXPECT_EQ(failed.error().code, DriverErrorCode::bus_failed);
        EXPECT_EQ(failed.error().bus, hal::BusError::overrun);
        rig.sample(kTurning);
        EXPECT_GE(rig.read(out).value_or(0), 1U);
      }
    }
  }
}

TYPED_TEST(Lsm6dsoSamples, AStuckLineIsCorruptDataOrNoDataButNeverASample) {
  for (const Settings& settings : kModes) {
    Rig<TypeParam> rig{settings};
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample(kTurning);
    std::array<GyroSample, 4> out{};
    rig.faults.inject({.kind = Fault::Kind::stuck_high, .calls = Fault::kForEver});
    const auto high = rig.read(out);
    ASSERT_FALSE(high);
    EXPECT_EQ(high.error().code, DriverErrorCode::corrupt_data);
    EXPECT_EQ(rig.driver.verify_next().error().code, DriverErrorCode::configuration_lost);
    rig.faults.clear();
    rig.faults.inject({.kind = Fault::Kind::stuck_low, .calls = Fault::kForEver});
    EXPECT_EQ(rig.read(out).value_or(9), 0U);
    EXPECT_EQ(rig.driver.verify_next().error().code, DriverErrorCode::configuration_lost);
  }
}

constexpr Settings kFifo{.mode = Mode::fifo};

TYPED_TEST(Lsm6dsoFifo, GivesTheSamplesOldestFirstAndBackDated) {
  Rig<TypeParam> rig{kFifo};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 1; i <= 40; ++i) rig.sample({deg_per_s(static_cast<float>(i)), {}, {}});
  const core::Instant now = rig.clock.now();
  std::array<GyroSample, 64> out{};
  ASSERT_EQ(rig.read(out).value_or(0), 40U);
  for (int i = 0; i < 40; ++i) {
    const GyroSample& sample = out[static_cast<std::size_t>(i)];
    EXPECT_NEAR(sample.rate[0].in(deg_per_s), static_cast<float>(i + 1), 0.005F);
    EXPECT_EQ(sample.time, now - rig.driver.sample_period() * (39 - i));
  }
}

TYPED_TEST(Lsm6dsoFifo, KeepsWhatDoesNotFitIntoTheBuffer) {
  Rig<TypeParam> rig{kFifo};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 5; ++i) rig.sample({deg_per_s(static_cast<float>(i)), {}, {}});
  const core::Instant now = rig.clock.now();
  std::array<GyroSample, 2> out{};
  for (int first = 0; first < 4; first += 2) {
    ASSERT_EQ(rig.read(out).value_or(0), 2U);
    for (int i = 0; i < 2; ++i) {
      const GyroSample& sample = out[static_cast<std::size_t>(i)];
      EXPECT_NEAR(sample.rate[0].in(deg_per_s), static_cast<float>(first + i), 0.005F);
      EXPECT_EQ(sample.time, now - rig.driver.sample_period() * (4 - first - i));
    }
  }
  EXPECT_EQ(rig.read(out).value_or(0), 1U);
  EXPECT_EQ(rig.read(out).value_or(9), 0U);
}

TYPED_TEST(Lsm6dsoFifo, RaisesThePinAtTheWatermark) {
  Rig<TypeParam> rig{{.mode = Mode::fifo, .fifo_watermark = 3}};
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample(kTurning);
  rig.sample(kTurning);
  EXPECT_FALSE(rig.chip.int1().level());
  rig.sample(kTurning);
  EXPECT_TRUE(rig.chip.int1().level());
  EXPECT_EQ(rig.chip.int1().take_edge(), rig.clock.now());
}

TYPED_TEST(Lsm6dsoFifo, ReportsAnOverrunOnceAndGoesOnWithTheOldestThatIsLeft) {
  Rig<TypeParam> rig{kFifo};
  ASSERT_TRUE(rig.start_and_settle());
  constexpr int kLost = 7;
  for (int i = 0; i < 512 + kLost; ++i) {
    rig.sample({deg_per_s(0.1F * static_cast<float>(i)), {}, {}});
  }
  std::array<GyroSample, 600> out{};
  const auto overrun = rig.read(out);
  ASSERT_FALSE(overrun);
  EXPECT_EQ(overrun.error().code, DriverErrorCode::fifo_overrun);
  ASSERT_EQ(rig.read(out).value_or(0), 512U);
  EXPECT_NEAR(out[0].rate[0].in(deg_per_s), 0.1F * kLost, 0.005F);
  EXPECT_EQ(out[511].time, rig.clock.now());
}

TYPED_TEST(Lsm6dsoFifo, FilledToTheBrimIsNotAnOverrun) {
  Rig<TypeParam> rig{kFifo};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 512; ++i) rig.sample(kTurning);
  std::array<GyroSample, 600> out{};
  EXPECT_EQ(rig.read(out).value_or(0), 512U);
}

TYPED_TEST(Lsm6dsoFifo, StampsNeverRunBackwardsWhenTheChipIsFasterThanItSays) {
  Rig<TypeParam> rig{kFifo};
  ASSERT_TRUE(rig.start_and_settle());
  const core::Duration fast = rig.chip.sample_period() * 97 / 100;
  core::Instant last{};
  std::array<GyroSample, 128> out{};
  for (int batch = 0; batch < 10; ++batch) {
    for (int i = 0; i < 100; ++i) {
      rig.clock.advance(fast);
      rig.chip.measure(kTurning, {});
    }
    const auto count = rig.read(out);
    ASSERT_EQ(count.value_or(0), 100U);
    for (std::size_t i = 0; i < *count; ++i) {
      EXPECT_GT(out[i].time, last);
      last = out[i].time;
    }
    EXPECT_EQ(last, rig.clock.now());
  }
}

TYPED_TEST(Lsm6dsoFifo, AFlippedTagIsCorruptData) {
  for (std::size_t bit = 0; bit < 8; ++bit) {
    Rig<TypeParam> rig{kFifo};
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample(kTurning);
    rig.faults.inject(
        {.kind = Fault::Kind::flipped_bit, .first = rig.faults.calls() + 2, .bit = bit});
    std::array<GyroSample, 4> out{};
    const auto read = rig.read(out);
    ASSERT_FALSE(read) << bit;
    EXPECT_EQ(read.error(), (DriverError{DriverErrorCode::corrupt_data, {}, 0x78}));
  }
}

}  // namespace
}  // namespace zerorate::drivers
