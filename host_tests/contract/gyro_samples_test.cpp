/// @file
/// Promises of drivers/common about the samples that GyroSource::read() gives, for every gyro on
/// every bus and in both modes.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "host_tests/contract/gyro_wirings.hpp"
#include "host_tests/support/allocation_counter.hpp"

namespace zerorate::contract {
namespace {

using core::deg_per_s;
using core::GyroSample;
using drivers::DriverErrorCode;
using hal::testing::Fault;
using support::Rates;

constexpr Rates kTurning{deg_per_s(10.0F), deg_per_s(-20.0F), deg_per_s(30.0F)};
constexpr std::size_t kZ = 2;

template <class Wiring>
class GyroSamples : public ::testing::Test {
 protected:
  using Gyro = typename Wiring::Gyro;
  using Rig = support::GyroRig<Wiring>;
  static constexpr std::array kModes = {Gyro::kDataReady, Gyro::kFifo};
  /// Transactions of a read that gives a sample, at least.
  static constexpr std::size_t kReadTransactions = [] {
    if constexpr (requires { Gyro::kReadTransactions; }) {
      return Gyro::kReadTransactions;
    } else {
      return std::size_t{2};
    }
  }();
  static constexpr bool kReadingReleasesPin = [] {
    if constexpr (requires { Gyro::kReadingReleasesPin; }) {
      return Gyro::kReadingReleasesPin;
    } else {
      return true;
    }
  }();
  static constexpr bool kIsSingleAxis = Wiring::Driver::kAxes == 1;

  /// Rate expected on an axis: a chip with one axis measures z and gives it on all.
  static float expected_dps(const Rates& sent, std::size_t axis) {
    return sent[kIsSingleAxis ? kZ : axis].in(deg_per_s);
  }
};
TYPED_TEST_SUITE(GyroSamples, AllGyros, WiringName);

TYPED_TEST(GyroSamples, AreNotThereBeforeTheChipMeasured) {
  if (TypeParam::Gyro::kIsSampledByReading) GTEST_SKIP() << "the chip measures whenever it is read";
  for (const auto& settings : TestFixture::kModes) {
    typename TestFixture::Rig rig{settings};
    ASSERT_TRUE(rig.start_and_settle());
    std::array<GyroSample, 4> out{};
    const auto count = rig.read(out);
    ASSERT_TRUE(count);
    EXPECT_EQ(*count, 0U);
  }
}

TYPED_TEST(GyroSamples, ComeOnceWithTheirTimeAndTemperature) {
  for (const auto& settings : TestFixture::kModes) {
    typename TestFixture::Rig rig{settings};
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample(kTurning, core::Temperature::from_degc(-12.5F));
    std::array<GyroSample, 4> out{};
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    EXPECT_EQ(out[0].time, rig.clock.now());
    EXPECT_EQ(out[0].saturated_axes, 0);
    EXPECT_EQ(out[0].has_temperature, TypeParam::Gyro::kTemperatureLsb > 0.0F);
    if (out[0].has_temperature) {
      EXPECT_NEAR(out[0].temperature.degc(), -12.5F, 0.51F * TypeParam::Gyro::kTemperatureLsb);
    }
    EXPECT_EQ(rig.read(out).value_or(9), 0U);
  }
}

TYPED_TEST(GyroSamples, FollowTheTemperatureToHalfAnLsb) {
  if (TypeParam::Gyro::kTemperatureLsb == 0.0F) GTEST_SKIP() << "the chip has no thermometer";
  typename TestFixture::Rig rig;
  ASSERT_TRUE(rig.start_and_settle());
  for (const float degc : {-40.0F, -0.3F, 0.0F, 25.0F, 44.9F, 85.0F}) {
    rig.sample(kTurning, core::Temperature::from_degc(degc));
    std::array<GyroSample, 1> out{};
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    EXPECT_NEAR(out[0].temperature.degc(), degc, 0.51F * TypeParam::Gyro::kTemperatureLsb);
  }
}

TYPED_TEST(GyroSamples, ReturnTheRateToHalfAnLsbInEveryRange) {
  for (const auto& range : TypeParam::Gyro::kRanges) {
    typename TestFixture::Rig rig{range.settings};
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
        EXPECT_NEAR(out[0].rate[axis].in(deg_per_s), TestFixture::expected_dps(sent, axis),
                    tolerance);
      }
    }
  }
}

TYPED_TEST(GyroSamples, OfNoRateAreExactlyZero) {
  for (const auto& range : TypeParam::Gyro::kRanges) {
    typename TestFixture::Rig rig{range.settings};
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample({});
    std::array<GyroSample, 1> out{};
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    for (const auto rate : out[0].rate) EXPECT_EQ(rate.in(deg_per_s), 0.0F);
  }
}

/// Verifies SR-HEALTH-03.
TYPED_TEST(GyroSamples, SayWhichAxisIsSaturated) {
  using Chip = typename TypeParam::Gyro;
  for (const auto& settings : TestFixture::kModes) {
    typename TestFixture::Rig rig{settings};
    ASSERT_TRUE(rig.start_and_settle());
    std::array<GyroSample, 1> out{};
    const auto inside = deg_per_s(0.999F * Chip::kFullScaleDps);
    const auto beyond = deg_per_s(4.0F * Chip::kFullScaleDps);
    rig.sample({beyond, deg_per_s(0.0F), inside});
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    EXPECT_EQ(out[0].saturated_axes, TestFixture::kIsSingleAxis ? 0b000 : 0b001);
    rig.sample({inside, -beyond, -beyond});
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    EXPECT_EQ(out[0].saturated_axes, TestFixture::kIsSingleAxis ? 0b111 : 0b110);
    EXPECT_NEAR(out[0].rate[kZ].in(deg_per_s), Chip::kLowestRaw * Chip::kLsbDps, 1e-3F);
  }
}

/// Verifies SR-LEARN-18.
TYPED_TEST(GyroSamples, OfThePowerUpNeverComeOut) {
  for (const auto& settings : TestFixture::kModes) {
    typename TestFixture::Rig rig{settings};
    ASSERT_TRUE(rig.start());
    const core::Instant powered = rig.clock.now();
    std::array<GyroSample, 1> out{};
    core::Instant first{};
    for (int i = 0; i < 60; ++i) {
      rig.sample({});
      const auto count = rig.read(out);
      ASSERT_TRUE(count);
      if (*count == 0) continue;
      if (first == core::Instant{}) first = out[0].time;
      for (const auto rate : out[0].rate) EXPECT_EQ(rate.in(deg_per_s), 0.0F);
    }
    EXPECT_GE(first - powered, TypeParam::Gyro::kEarliest);
    EXPECT_LE(first - powered, TypeParam::Gyro::kLatest);
  }
}

TYPED_TEST(GyroSamples, RaiseTheInterruptPinAtTheTimeOfTheConversion) {
  if constexpr (TypeParam::Gyro::kIsSampledByReading) {
    GTEST_SKIP() << "the chip has no interrupt pin";
  } else {
    typename TestFixture::Rig rig;
    ASSERT_TRUE(rig.start_and_settle());
    for (int i = 0; i < 3; ++i) {
      rig.sample(kTurning);
      const core::Instant converted = rig.clock.now();
      rig.clock.advance(core::Duration::microseconds(300));
      const auto edge = rig.chip.interrupt().take_edge();
      ASSERT_TRUE(edge);
      EXPECT_EQ(*edge, converted);
      std::array<GyroSample, 1> out{};
      ASSERT_EQ(rig.driver.read(*edge, out).value_or(0), 1U);
      EXPECT_EQ(out[0].time, converted);
      EXPECT_EQ(rig.chip.interrupt().level(), !TestFixture::kReadingReleasesPin);
    }
  }
}

TYPED_TEST(GyroSamples, MayCarryTimesBeforeZero) {
  for (const auto& settings : TestFixture::kModes) {
    typename TestFixture::Rig rig{settings, core::Instant{} - core::Duration::seconds(10)};
    ASSERT_TRUE(rig.start_and_settle());
    std::array<GyroSample, 4> out{};
    for (int i = 0; i < 2; ++i) rig.sample(kTurning);
    const std::size_t count = rig.read(out).value_or(0);
    ASSERT_GE(count, 1U);
    EXPECT_EQ(out[count - 1].time, rig.clock.now());
    EXPECT_LT(rig.clock.now(), core::Instant{});
  }
}

TYPED_TEST(GyroSamples, AreNotReadIntoAnEmptyBuffer) {
  typename TestFixture::Rig rig;
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample(kTurning);
  EXPECT_EQ(rig.read({}).value_or(9), 0U);
  std::array<GyroSample, 1> out{};
  EXPECT_EQ(rig.read(out).value_or(0), 1U);
}

TYPED_TEST(GyroSamples, ABusErrorIsReportedAndTheNextReadGoesOn) {
  for (const auto& settings : TestFixture::kModes) {
    for (std::size_t call = 0; call < TestFixture::kReadTransactions; ++call) {
      for (const auto kind : {Fault::Kind::refused, Fault::Kind::after_effect}) {
        typename TestFixture::Rig rig{settings};
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

/// Verifies SR-IF-16.
TYPED_TEST(GyroSamples, AStuckLineIsCorruptDataOrNoDataButNeverASample) {
  for (const auto& settings : TestFixture::kModes) {
    for (const auto kind : {Fault::Kind::stuck_high, Fault::Kind::stuck_low}) {
      typename TestFixture::Rig rig{settings};
      ASSERT_TRUE(rig.start_and_settle());
      rig.sample(kTurning);
      std::array<GyroSample, 4> out{};
      rig.faults.inject({.kind = kind, .calls = Fault::kForEver});
      const auto read = rig.read(out);
      if (read) {
        EXPECT_EQ(*read, 0U);
      } else {
        EXPECT_EQ(read.error().code, DriverErrorCode::corrupt_data);
      }
      std::size_t calls = 0;
      while (rig.driver.verify_next() && calls < TypeParam::Gyro::kConfigured.size()) ++calls;
      EXPECT_LT(calls, TypeParam::Gyro::kConfigured.size()) << "the verification does not see it";
    }
  }
}

/// Verifies SR-IF-16.
TYPED_TEST(GyroSamples, LineStuckInAReadGivesNoInventedSample) {
  for (const auto& settings : TestFixture::kModes) {
    for (const auto kind : {Fault::Kind::stuck_high, Fault::Kind::stuck_low}) {
      for (std::size_t call = 0; call < 4; ++call) {
        typename TestFixture::Rig rig{settings};
        ASSERT_TRUE(rig.start_and_settle());
        rig.sample(kTurning);
        rig.faults.inject(
            {.kind = kind, .first = rig.faults.calls() + call, .calls = Fault::kForEver});
        std::array<GyroSample, 4> out{};
        const std::size_t count = rig.read(out).value_or(0);
        for (std::size_t i = 0; i < count; ++i) {
          for (std::size_t axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(out[i].rate[axis].in(deg_per_s), TestFixture::expected_dps(kTurning, axis),
                        0.51F * TypeParam::Gyro::kLsbDps)
                << "stuck from transaction " << call;
          }
        }
      }
    }
  }
}

/// One transfer reads nothing, and those before and after it are right.
TYPED_TEST(GyroSamples, AnEmptyTransferGivesNoSample) {
  for (const auto& settings : TestFixture::kModes) {
    for (const auto kind : {Fault::Kind::stuck_high, Fault::Kind::stuck_low}) {
      for (std::size_t call = 0; call < 6; ++call) {
        typename TestFixture::Rig rig{settings};
        ASSERT_TRUE(rig.start_and_settle());
        std::array<GyroSample, 8> out{};
        rig.sample(kTurning);
        ASSERT_TRUE(rig.read(out));
        for (int i = 0; i < 3; ++i) rig.sample(kTurning);
        rig.faults.inject({.kind = kind, .first = rig.faults.calls() + call});
        const std::size_t count = rig.read(out).value_or(0);
        for (std::size_t i = 0; i < count; ++i) {
          for (std::size_t axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(out[i].rate[axis].in(deg_per_s), TestFixture::expected_dps(kTurning, axis),
                        0.51F * TypeParam::Gyro::kLsbDps)
                << "transaction " << call;
          }
        }
      }
    }
  }
}

TYPED_TEST(GyroSamples, OneThatIsMeasuredInTheMiddleOfAReadComesOnce) {
  if (TypeParam::Gyro::kIsSampledByReading) GTEST_SKIP() << "the chip measures whenever it is read";
  constexpr Rates kNewer{deg_per_s(11.0F), deg_per_s(-21.0F), deg_per_s(31.0F)};
  for (const auto& settings : TestFixture::kModes) {
    for (std::size_t call = 0; call < 3; ++call) {
      typename TestFixture::Rig rig{settings};
      ASSERT_TRUE(rig.start_and_settle());
      rig.sample(kTurning);
      rig.faults.before(rig.faults.calls() + call, [&] { rig.sample(kNewer); });
      int newer = 0;
      for (int i = 0; i < 3; ++i) {
        std::array<GyroSample, 4> out{};
        const std::size_t count = rig.read(out).value_or(9);
        ASSERT_LE(count, 2U);
        for (std::size_t j = 0; j < count; ++j) newer += out[j].rate[0].in(deg_per_s) > 10.5F;
      }
      EXPECT_EQ(newer, 1) << "in front of transaction " << call;
    }
  }
}

TYPED_TEST(GyroSamples, AFlippedBitNeverGivesASampleOfTheFuture) {
  for (const auto& settings : TestFixture::kModes) {
    for (std::size_t call = 0; call < 3; ++call) {
      for (std::size_t bit = 0; bit < 64; ++bit) {
        typename TestFixture::Rig rig{settings};
        ASSERT_TRUE(rig.start_and_settle());
        rig.sample(kTurning);
        rig.faults.inject(
            {.kind = Fault::Kind::flipped_bit, .first = rig.faults.calls() + call, .bit = bit});
        std::array<GyroSample, 4> out{};
        const auto read = rig.read(out);
        if (!read) {
          EXPECT_TRUE(read.error().code == DriverErrorCode::corrupt_data ||
                      read.error().code == DriverErrorCode::fifo_overrun);
          continue;
        }
        // Where frames carry no mark, a wrong level gives frames that are not there.
        if (TypeParam::Gyro::kFramesAreMarked) {
          EXPECT_LE(*read, 1U) << "call " << call << " bit " << bit;
        }
        for (std::size_t i = 0; i < *read; ++i) EXPECT_LE(out[i].time, rig.clock.now());
      }
    }
  }
}

/// Verifies SR-MEM-01.
TYPED_TEST(GyroSamples, AreReadWithoutTheHeap) {
  for (const auto& settings : TestFixture::kModes) {
    typename TestFixture::Rig rig{settings};
    rig.sample(kTurning);
    std::array<GyroSample, 4> out{};
    const support::AllocationCounter starting;
    const bool started = rig.start_and_settle().has_value();
    EXPECT_EQ(starting.count(), 0U);
    ASSERT_TRUE(started);
    rig.sample(kTurning);  // the simulated chip may allocate
    const support::AllocationCounter reading;
    const std::size_t count = rig.read(out).value_or(0);
    const bool verified = rig.driver.verify_next().has_value();
    EXPECT_EQ(reading.count(), 0U);
    EXPECT_EQ(count, 1U);
    EXPECT_TRUE(verified);
  }
}

}  // namespace
}  // namespace zerorate::contract
