/// @file
/// Promises of drivers/common about GyroSource::start() and verify_next(), for every gyro on every
/// bus.

#include <gtest/gtest.h>

#include <algorithm>

#include "host_tests/contract/any_gyro.hpp"
#include "host_tests/support/gyro_rig.hpp"

namespace zerorate::contract {
namespace {

using core::deg_per_s;
using core::GyroSample;
using drivers::DriverError;
using drivers::DriverErrorCode;
using hal::testing::Fault;
using support::ConfiguredBits;

class GyroStart : public ::testing::TestWithParam<AnyGyro> {
 protected:
  /// Enough calls to see every entry of the configuration once, and some of them twice.
  static std::size_t enough_calls() { return GetParam().configured.size() + 4; }

  static void expect_right_rate(AnyRig& rig) {
    rig.clock().advance(core::Duration::seconds(6));
    rig.sample({deg_per_s(10.0F), deg_per_s(10.0F), deg_per_s(10.0F)});
    std::array<GyroSample, 1> out{};
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    for (const auto rate : out[0].rate) EXPECT_NEAR(rate.in(deg_per_s), 10.0F, GetParam().lsb_dps);
  }
};
INSTANTIATE_TEST_SUITE_P(Every, GyroStart, ::testing::ValuesIn(all_gyros()), name_of);

TEST_P(GyroStart, NeedsItsTimeAndThenSucceeds) {
  const auto rig = GetParam().rig();
  EXPECT_TRUE(support::is_waiting(rig->start_once()));
  rig->clock().advance(GetParam().start_time * 9 / 10);
  EXPECT_TRUE(support::is_waiting(rig->start_once()));
  EXPECT_TRUE(rig->start());
  EXPECT_TRUE(rig->is_powered());
}

TEST_P(GyroStart, TouchesNoReservedRegister) {
  for (const auto& settings : kModes) {
    const auto rig = GetParam().rig(settings);
    ASSERT_TRUE(rig->start());
    EXPECT_EQ(rig->reserved_writes(), 0U);
  }
}

TEST_P(GyroStart, BringsAForeignConfigurationToItsOwn) {
  for (const auto& settings : kModes) {
    const auto rig = GetParam().rig(settings);
    for (const ConfiguredBits& entry : GetParam().configured) {
      rig->upset(entry.address, entry.bits);
    }
    // The configuration may even lie about the bank or the byte order: some time is granted.
    ASSERT_TRUE(rig->start() || rig->start());
    for (std::size_t call = 0; call < enough_calls(); ++call) {
      EXPECT_TRUE(rig->verify_next());
    }
    expect_right_rate(*rig);
  }
}

/// Verifies SR-IF-17.
TEST_P(GyroStart, RefusesAnotherChip) {
  for (std::uint8_t bit = 0; bit < 8; ++bit) {
    const auto rig = GetParam().rig();
    const auto flipped = static_cast<std::uint8_t>(1U << bit);
    if (rig->is_relative(flipped)) continue;
    rig->upset(GetParam().identity, flipped);
    const auto started = rig->start();
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error(),
              (DriverError{DriverErrorCode::wrong_identity, {}, GetParam().identity}));
  }
}

TEST_P(GyroStart, TakesAStuckLineForAMissingChip) {
  for (const auto kind : {Fault::Kind::stuck_high, Fault::Kind::stuck_low}) {
    const auto rig = GetParam().rig();
    rig->faults().inject({.kind = kind, .calls = Fault::kForEver});
    const auto started = rig->start();
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().code, DriverErrorCode::wrong_identity);
  }
}

TEST_P(GyroStart, ReportsTheBusErrorOfEveryCallAndThenRecovers) {
  const auto counter = GetParam().rig();
  ASSERT_TRUE(counter->start());
  const std::size_t calls = counter->faults().calls();
  for (const auto kind : {Fault::Kind::refused, Fault::Kind::after_effect}) {
    for (std::size_t call = 0; call < calls; ++call) {
      const auto rig = GetParam().rig();
      rig->faults().inject({.kind = kind, .first = call, .error = hal::BusError::timeout});
      const auto failed = rig->start();
      ASSERT_FALSE(failed) << "call " << call;
      EXPECT_EQ(failed.error().code, DriverErrorCode::bus_failed);
      EXPECT_EQ(failed.error().bus, hal::BusError::timeout);
      EXPECT_TRUE(rig->start()) << "after a fault in call " << call;
    }
  }
}

TEST_P(GyroStart, NeverSucceedsWithAFlippedConfigurationBit) {
  const auto counter = GetParam().rig();
  ASSERT_TRUE(counter->start());
  const std::size_t calls = counter->faults().calls();
  for (std::size_t call = 0; call < calls; ++call) {
    for (std::size_t bit = 0; bit < 8; ++bit) {
      SCOPED_TRACE(::testing::Message() << "call " << call << " bit " << bit);
      const auto rig = GetParam().rig();
      rig->faults().inject({.kind = Fault::Kind::flipped_bit, .first = call, .bit = bit});
      if (!rig->start()) continue;
      // It may pass, for instance where the bit is none of ours; then the chip must be right.
      for (std::size_t i = 0; i < enough_calls(); ++i) EXPECT_TRUE(rig->verify_next());
      expect_right_rate(*rig);
    }
  }
}

TEST_P(GyroStart, MustComeBeforeReadingAndVerifying) {
  const auto rig = GetParam().rig();
  std::array<GyroSample, 1> out{};
  const auto read = rig->read(out);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, DriverErrorCode::not_ready);
  const auto verified = rig->verify_next();
  ASSERT_FALSE(verified);
  EXPECT_EQ(verified.error().code, DriverErrorCode::not_ready);
  EXPECT_EQ(rig->faults().calls(), 0U);
}

TEST_P(GyroStart, MayBeRepeatedWhileTheChipRuns) {
  const auto rig = GetParam().rig();
  ASSERT_TRUE(rig->start());
  ASSERT_TRUE(rig->start());
  expect_right_rate(*rig);
}

TEST_P(GyroStart, IsFollowedByVerificationsOfOneRegisterEach) {
  const auto rig = GetParam().rig();
  ASSERT_TRUE(rig->start());
  const std::size_t before = rig->faults().calls();
  ASSERT_TRUE(rig->verify_next());
  EXPECT_EQ(rig->faults().calls(), before + GetParam().verify_transactions);
}

/// Verifies SR-IF-17.
TEST_P(GyroStart, IsFollowedByAWatchOverEveryBitThatWasConfigured) {
  for (const ConfiguredBits& entry : GetParam().configured) {
    for (unsigned bit = 1; bit < 0x100; bit <<= 1U) {
      if ((entry.bits & bit) == 0) continue;
      const auto rig = GetParam().rig();
      ASSERT_TRUE(rig->start());
      rig->upset(entry.address, static_cast<std::uint8_t>(bit));
      std::size_t refused_calls = 0;
      for (std::size_t call = 0; call < enough_calls(); ++call) {
        const auto verified = rig->verify_next();
        if (verified) continue;
        ++refused_calls;
        EXPECT_TRUE(verified.error().code == DriverErrorCode::configuration_lost ||
                    verified.error().code == DriverErrorCode::sensor_fault);
      }
      EXPECT_GE(refused_calls, 1U) << "register " << int{entry.address} << " bit " << bit;
      ASSERT_TRUE(rig->start() || rig->start());
      expect_right_rate(*rig);
    }
  }
}

TEST_P(GyroStart, IsNeededAgainAfterAnInterruptedSupply) {
  const auto rig = GetParam().rig();
  ASSERT_TRUE(rig->start());
  for (std::size_t call = 0; call < 3 * enough_calls(); ++call) {
    ASSERT_TRUE(rig->verify_next());
  }
  rig->cycle_power();
  std::size_t calls = 0;
  while (rig->verify_next() && calls < enough_calls()) ++calls;
  EXPECT_LT(calls, enough_calls());
  ASSERT_TRUE(rig->start());
  expect_right_rate(*rig);
}

}  // namespace
}  // namespace zerorate::contract
