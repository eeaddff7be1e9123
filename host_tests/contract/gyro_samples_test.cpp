/// @file
/// Promises of drivers/common about the samples that GyroSource::read() gives, for every gyro on
/// every bus and in both modes.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "host_tests/contract/any_gyro.hpp"
#include "host_tests/support/allocation_counter.hpp"

namespace zerorate::contract {
namespace {

using core::deg_per_s;
using core::GyroSample;
using drivers::DriverErrorCode;
using hal::testing::Fault;

constexpr Rates kTurning{deg_per_s(10.0F), deg_per_s(-20.0F), deg_per_s(30.0F)};
constexpr std::size_t kZ = 2;

class GyroSamples : public ::testing::TestWithParam<AnyGyro> {};
INSTANTIATE_TEST_SUITE_P(Every, GyroSamples, ::testing::ValuesIn(all_gyros()), name_of);

TEST_P(GyroSamples, AreNotThereBeforeTheChipMeasured) {
  if (GetParam().is_sampled_by_reading) GTEST_SKIP() << "the chip measures whenever it is read";
  for (const auto& settings : kModes) {
    const auto rig = GetParam().rig(settings);
    ASSERT_TRUE(rig->start_and_settle());
    std::array<GyroSample, 4> out{};
    const auto count = rig->read(out);
    ASSERT_TRUE(count);
    EXPECT_EQ(*count, 0U);
  }
}

TEST_P(GyroSamples, ComeOnceWithTheirTimeAndTemperature) {
  for (const auto& settings : kModes) {
    const auto rig = GetParam().rig(settings);
    ASSERT_TRUE(rig->start_and_settle());
    rig->sample(kTurning, core::Temperature::from_degc(-12.5F));
    std::array<GyroSample, 4> out{};
    ASSERT_EQ(rig->read(out).value_or(0), 1U);
    EXPECT_EQ(out[0].time, rig->clock().now());
    EXPECT_EQ(out[0].saturated_axes, 0);
    EXPECT_EQ(out[0].has_temperature, GetParam().temperature_lsb > 0.0F);
    if (out[0].has_temperature) {
      EXPECT_NEAR(out[0].temperature.degc(), -12.5F, 0.51F * GetParam().temperature_lsb);
    }
    EXPECT_EQ(rig->read(out).value_or(9), 0U);
  }
}

TEST_P(GyroSamples, FollowTheTemperatureToHalfAnLsb) {
  if (GetParam().temperature_lsb == 0.0F) GTEST_SKIP() << "the chip has no thermometer";
  const auto rig = GetParam().rig();
  ASSERT_TRUE(rig->start_and_settle());
  for (const float degc : {-40.0F, -0.3F, 0.0F, 25.0F, 44.9F, 85.0F}) {
    rig->sample(kTurning, core::Temperature::from_degc(degc));
    std::array<GyroSample, 1> out{};
    ASSERT_EQ(rig->read(out).value_or(0), 1U);
    EXPECT_NEAR(out[0].temperature.degc(), degc, 0.51F * GetParam().temperature_lsb);
  }
}

TEST_P(GyroSamples, ReturnTheRateToHalfAnLsbInEveryRange) {
  for (std::size_t k = 0; k < GetParam().ranges.size(); ++k) {
    const AnyRange& range = GetParam().ranges[k];
    const auto rig = GetParam().rig({Setting::Kind::range, k});
    ASSERT_TRUE(rig->start_and_settle());
    std::mt19937 random{20240611};
    std::uniform_real_distribution<float> rate{-range.span_dps, range.span_dps};
    // Half an LSB, and the float rounding of values up to the full scale on both ways.
    const float tolerance = 0.5F * range.lsb_dps + 4.0F * range.span_dps * std::exp2(-24.0F);
    std::array<GyroSample, 1> out{};
    for (int i = 0; i < 200; ++i) {
      const Rates sent{deg_per_s(rate(random)), deg_per_s(rate(random)), deg_per_s(rate(random))};
      rig->sample(sent);
      ASSERT_EQ(rig->read(out).value_or(0), 1U);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(out[0].rate[axis].in(deg_per_s), GetParam().expected_dps(sent, axis),
                    tolerance);
      }
    }
  }
}

TEST_P(GyroSamples, OfNoRateAreExactlyZero) {
  for (std::size_t range = 0; range < GetParam().ranges.size(); ++range) {
    const auto rig = GetParam().rig({Setting::Kind::range, range});
    ASSERT_TRUE(rig->start_and_settle());
    rig->sample({});
    std::array<GyroSample, 1> out{};
    ASSERT_EQ(rig->read(out).value_or(0), 1U);
    for (const auto rate : out[0].rate) EXPECT_EQ(rate.in(deg_per_s), 0.0F);
  }
}

/// Verifies SR-HEALTH-03.
TEST_P(GyroSamples, SayWhichAxisIsSaturated) {
  for (const auto& settings : kModes) {
    const auto rig = GetParam().rig(settings);
    ASSERT_TRUE(rig->start_and_settle());
    std::array<GyroSample, 1> out{};
    const auto inside = deg_per_s(0.999F * GetParam().full_scale_dps);
    const auto beyond = deg_per_s(4.0F * GetParam().full_scale_dps);
    rig->sample({beyond, deg_per_s(0.0F), inside});
    ASSERT_EQ(rig->read(out).value_or(0), 1U);
    EXPECT_EQ(out[0].saturated_axes, GetParam().is_single_axis ? 0b000 : 0b001);
    rig->sample({inside, -beyond, -beyond});
    ASSERT_EQ(rig->read(out).value_or(0), 1U);
    EXPECT_EQ(out[0].saturated_axes, GetParam().is_single_axis ? 0b111 : 0b110);
    EXPECT_NEAR(out[0].rate[kZ].in(deg_per_s), GetParam().lowest_raw * GetParam().lsb_dps, 1e-3F);
  }
}

/// Verifies SR-LEARN-18.
TEST_P(GyroSamples, OfThePowerUpNeverComeOut) {
  for (const auto& settings : kModes) {
    const auto rig = GetParam().rig(settings);
    ASSERT_TRUE(rig->start());
    const core::Instant powered = rig->clock().now();
    std::array<GyroSample, 1> out{};
    core::Instant first{};
    for (int i = 0; i < 60; ++i) {
      rig->sample({});
      const auto count = rig->read(out);
      ASSERT_TRUE(count);
      if (*count == 0) continue;
      if (first == core::Instant{}) first = out[0].time;
      for (const auto rate : out[0].rate) EXPECT_EQ(rate.in(deg_per_s), 0.0F);
    }
    EXPECT_GE(first - powered, GetParam().earliest);
    EXPECT_LE(first - powered, GetParam().latest);
  }
}

TEST_P(GyroSamples, RaiseTheInterruptPinAtTheTimeOfTheConversion) {
  if (GetParam().is_sampled_by_reading) GTEST_SKIP() << "the chip has no interrupt pin";
  const auto rig = GetParam().rig();
  ASSERT_TRUE(rig->start_and_settle());
  for (int i = 0; i < 3; ++i) {
    rig->sample(kTurning);
    const core::Instant converted = rig->clock().now();
    rig->clock().advance(core::Duration::microseconds(300));
    const auto edge = rig->interrupt()->take_edge();
    ASSERT_TRUE(edge);
    EXPECT_EQ(*edge, converted);
    std::array<GyroSample, 1> out{};
    ASSERT_EQ(rig->read(*edge, out).value_or(0), 1U);
    EXPECT_EQ(out[0].time, converted);
    EXPECT_EQ(rig->interrupt()->level(), !GetParam().reading_releases_pin);
  }
}

TEST_P(GyroSamples, MayCarryTimesBeforeZero) {
  for (const auto& settings : kModes) {
    const auto rig = GetParam().rig(settings, core::Instant{} - core::Duration::seconds(10));
    ASSERT_TRUE(rig->start_and_settle());
    std::array<GyroSample, 4> out{};
    for (int i = 0; i < 2; ++i) rig->sample(kTurning);
    const std::size_t count = rig->read(out).value_or(0);
    ASSERT_GE(count, 1U);
    EXPECT_EQ(out[count - 1].time, rig->clock().now());
    EXPECT_LT(rig->clock().now(), core::Instant{});
  }
}

TEST_P(GyroSamples, AreNotReadIntoAnEmptyBuffer) {
  const auto rig = GetParam().rig();
  ASSERT_TRUE(rig->start_and_settle());
  rig->sample(kTurning);
  EXPECT_EQ(rig->read({}).value_or(9), 0U);
  std::array<GyroSample, 1> out{};
  EXPECT_EQ(rig->read(out).value_or(0), 1U);
}

TEST_P(GyroSamples, ABusErrorIsReportedAndTheNextReadGoesOn) {
  for (const auto& settings : kModes) {
    for (std::size_t call = 0; call < GetParam().read_transactions; ++call) {
      for (const auto kind : {Fault::Kind::refused, Fault::Kind::after_effect}) {
        const auto rig = GetParam().rig(settings);
        ASSERT_TRUE(rig->start_and_settle());
        rig->sample(kTurning);
        rig->faults().inject(
            {.kind = kind, .first = rig->faults().calls() + call, .error = hal::BusError::overrun});
        std::array<GyroSample, 4> out{};
        const auto failed = rig->read(out);
        ASSERT_FALSE(failed);
        EXPECT_EQ(failed.error().code, DriverErrorCode::bus_failed);
        EXPECT_EQ(failed.error().bus, hal::BusError::overrun);
        rig->sample(kTurning);
        EXPECT_GE(rig->read(out).value_or(0), 1U);
      }
    }
  }
}

/// Verifies SR-IF-16.
TEST_P(GyroSamples, AStuckLineIsCorruptDataOrNoDataButNeverASample) {
  for (const auto& settings : kModes) {
    for (const auto kind : {Fault::Kind::stuck_high, Fault::Kind::stuck_low}) {
      const auto rig = GetParam().rig(settings);
      ASSERT_TRUE(rig->start_and_settle());
      rig->sample(kTurning);
      std::array<GyroSample, 4> out{};
      rig->faults().inject({.kind = kind, .calls = Fault::kForEver});
      const auto read = rig->read(out);
      if (read) {
        EXPECT_EQ(*read, 0U);
      } else {
        EXPECT_EQ(read.error().code, DriverErrorCode::corrupt_data);
      }
      std::size_t calls = 0;
      while (rig->verify_next() && calls < GetParam().configured.size()) ++calls;
      EXPECT_LT(calls, GetParam().configured.size()) << "the verification does not see it";
    }
  }
}

/// Verifies SR-IF-16.
TEST_P(GyroSamples, LineStuckInAReadGivesNoInventedSample) {
  for (const auto& settings : kModes) {
    for (const auto kind : {Fault::Kind::stuck_high, Fault::Kind::stuck_low}) {
      for (std::size_t call = 0; call < 4; ++call) {
        const auto rig = GetParam().rig(settings);
        ASSERT_TRUE(rig->start_and_settle());
        rig->sample(kTurning);
        rig->faults().inject(
            {.kind = kind, .first = rig->faults().calls() + call, .calls = Fault::kForEver});
        std::array<GyroSample, 4> out{};
        const std::size_t count = rig->read(out).value_or(0);
        for (std::size_t i = 0; i < count; ++i) {
          for (std::size_t axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(out[i].rate[axis].in(deg_per_s), GetParam().expected_dps(kTurning, axis),
                        0.51F * GetParam().lsb_dps)
                << "stuck from transaction " << call;
          }
        }
      }
    }
  }
}

/// One transfer reads nothing, and those before and after it are right.
TEST_P(GyroSamples, AnEmptyTransferGivesNoSample) {
  for (const auto& settings : kModes) {
    for (const auto kind : {Fault::Kind::stuck_high, Fault::Kind::stuck_low}) {
      for (std::size_t call = 0; call < 6; ++call) {
        const auto rig = GetParam().rig(settings);
        ASSERT_TRUE(rig->start_and_settle());
        std::array<GyroSample, 8> out{};
        rig->sample(kTurning);
        ASSERT_TRUE(rig->read(out));
        for (int i = 0; i < 3; ++i) rig->sample(kTurning);
        rig->faults().inject({.kind = kind, .first = rig->faults().calls() + call});
        const std::size_t count = rig->read(out).value_or(0);
        for (std::size_t i = 0; i < count; ++i) {
          for (std::size_t axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(out[i].rate[axis].in(deg_per_s), GetParam().expected_dps(kTurning, axis),
                        0.51F * GetParam().lsb_dps)
                << "transaction " << call;
          }
        }
      }
    }
  }
}

TEST_P(GyroSamples, OneThatIsMeasuredInTheMiddleOfAReadComesOnce) {
  if (GetParam().is_sampled_by_reading) GTEST_SKIP() << "the chip measures whenever it is read";
  constexpr Rates kNewer{deg_per_s(11.0F), deg_per_s(-21.0F), deg_per_s(31.0F)};
  for (const auto& settings : kModes) {
    for (std::size_t call = 0; call < 3; ++call) {
      const auto rig = GetParam().rig(settings);
      ASSERT_TRUE(rig->start_and_settle());
      rig->sample(kTurning);
      rig->faults().before(rig->faults().calls() + call, [&] { rig->sample(kNewer); });
      int newer = 0;
      for (int i = 0; i < 3; ++i) {
        std::array<GyroSample, 4> out{};
        const std::size_t count = rig->read(out).value_or(9);
        ASSERT_LE(count, 2U);
        for (std::size_t j = 0; j < count; ++j) newer += out[j].rate[0].in(deg_per_s) > 10.5F;
      }
      EXPECT_EQ(newer, 1) << "in front of transaction " << call;
    }
  }
}

TEST_P(GyroSamples, AFlippedBitNeverGivesASampleOfTheFuture) {
  for (const auto& settings : kModes) {
    for (std::size_t call = 0; call < 3; ++call) {
      for (std::size_t bit = 0; bit < 64; ++bit) {
        const auto rig = GetParam().rig(settings);
        ASSERT_TRUE(rig->start_and_settle());
        rig->sample(kTurning);
        rig->faults().inject(
            {.kind = Fault::Kind::flipped_bit, .first = rig->faults().calls() + call, .bit = bit});
        std::array<GyroSample, 4> out{};
        const auto read = rig->read(out);
        if (!read) {
          EXPECT_TRUE(read.error().code == DriverErrorCode::corrupt_data ||
                      read.error().code == DriverErrorCode::fifo_overrun);
          continue;
        }
        // Where frames carry no mark, a wrong level gives frames that are not there.
        if (GetParam().frames_are_marked) {
          EXPECT_LE(*read, 1U) << "call " << call << " bit " << bit;
        }
        for (std::size_t i = 0; i < *read; ++i) EXPECT_LE(out[i].time, rig->clock().now());
      }
    }
  }
}

/// Verifies SR-MEM-01.
TEST_P(GyroSamples, AreReadWithoutTheHeap) {
  for (const auto& settings : kModes) {
    const auto rig = GetParam().rig(settings);
    rig->sample(kTurning);
    std::array<GyroSample, 4> out{};
    const support::AllocationCounter starting;
    const bool started = rig->start_and_settle().has_value();
    EXPECT_EQ(starting.count(), 0U);
    ASSERT_TRUE(started);
    rig->sample(kTurning);  // the simulated chip may allocate
    const support::AllocationCounter reading;
    const std::size_t count = rig->read(out).value_or(0);
    const bool verified = rig->verify_next().has_value();
    EXPECT_EQ(reading.count(), 0U);
    EXPECT_EQ(count, 1U);
    EXPECT_TRUE(verified);
  }
}

}  // namespace
}  // namespace zerorate::contract
