/// @file
/// Promises of drivers/common about GyroSource::start() and verify_next(), for every gyro on every
/// bus.

#include <gtest/gtest.h>

#include <algorithm>

#include "host_tests/contract/gyro_wirings.hpp"

namespace zerorate::contract {
namespace {

using core::deg_per_s;
using core::GyroSample;
using drivers::DriverError;
using drivers::DriverErrorCode;
using hal::testing::Fault;
using support::ConfiguredBits;

template <class Wiring>
class GyroStart : public ::testing::Test {
 protected:
  using Gyro = typename Wiring::Gyro;
  using Rig = support::GyroRig<Wiring>;
  static constexpr std::array kModes = {Gyro::kDataReady, Gyro::kFifo};

  /// True if the driver takes a chip whose identity is off by these bits for a relative of it.
  static bool is_relative([[maybe_unused]] Rig& rig, [[maybe_unused]] std::uint8_t bits) {
    if constexpr (requires { Gyro::kIdentities; }) {
      const auto identity =
          static_cast<std::uint8_t>(rig.chip.read_register(Gyro::kIdentity) ^ bits);
      return std::ranges::find(Gyro::kIdentities, identity) != Gyro::kIdentities.end();
    }
    return false;
  }

  /// Enough calls to see every entry of the configuration once, and some of them twice.
  static constexpr std::size_t kCalls = Gyro::kConfigured.size() + 4;

  static void expect_right_rate(Rig& rig) {
    rig.clock.advance(core::Duration::seconds(6));
    rig.sample({deg_per_s(10.0F), deg_per_s(10.0F), deg_per_s(10.0F)});
    std::array<GyroSample, 1> out{};
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    for (const auto rate : out[0].rate) EXPECT_NEAR(rate.in(deg_per_s), 10.0F, Gyro::kLsbDps);
  }
};
TYPED_TEST_SUITE(GyroStart, AllGyros, WiringName);

TYPED_TEST(GyroStart, NeedsItsTimeAndThenSucceeds) {
  typename TestFixture::Rig rig;
  EXPECT_TRUE(rig.is_waiting(rig.driver.start(rig.clock.now())));
  rig.clock.advance(TypeParam::Gyro::kStartTime * 9 / 10);
  EXPECT_TRUE(rig.is_waiting(rig.driver.start(rig.clock.now())));
  EXPECT_TRUE(rig.start());
  EXPECT_TRUE(rig.chip.is_powered());
}

TYPED_TEST(GyroStart, TouchesNoReservedRegister) {
  for (const auto& settings : TestFixture::kModes) {
    typename TestFixture::Rig rig{settings};
    ASSERT_TRUE(rig.start());
    EXPECT_EQ(rig.chip.reserved_writes(), 0U);
  }
}

TYPED_TEST(GyroStart, BringsAForeignConfigurationToItsOwn) {
  for (const auto& settings : TestFixture::kModes) {
    typename TestFixture::Rig rig{settings};
    for (const ConfiguredBits& entry : TypeParam::Gyro::kConfigured) {
      rig.chip.upset(entry.address, entry.bits);
    }
    // The configuration may even lie about the bank or the byte order: some time is granted.
    ASSERT_TRUE(rig.start() || rig.start());
    for (std::size_t call = 0; call < TestFixture::kCalls; ++call) {
      EXPECT_TRUE(rig.driver.verify_next());
    }
    TestFixture::expect_right_rate(rig);
  }
}

/// Verifies SR-IF-17.
TYPED_TEST(GyroStart, RefusesAnotherChip) {
  for (std::uint8_t bit = 0; bit < 8; ++bit) {
    typename TestFixture::Rig rig;
    const auto flipped = static_cast<std::uint8_t>(1U << bit);
    if (TestFixture::is_relative(rig, flipped)) continue;
    rig.chip.upset(TypeParam::Gyro::kIdentity, flipped);
    const auto started = rig.start();
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error(),
              (DriverError{DriverErrorCode::wrong_identity, {}, TypeParam::Gyro::kIdentity}));
  }
}

TYPED_TEST(GyroStart, TakesAStuckLineForAMissingChip) {
  for (const auto kind : {Fault::Kind::stuck_high, Fault::Kind::stuck_low}) {
    typename TestFixture::Rig rig;
    rig.faults.inject({.kind = kind, .calls = Fault::kForEver});
    const auto started = rig.start();
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().code, DriverErrorCode::wrong_identity);
  }
}

TYPED_TEST(GyroStart, ReportsTheBusErrorOfEveryCallAndThenRecovers) {
  typename TestFixture::Rig counter;
  ASSERT_TRUE(counter.start());
  const std::size_t calls = counter.faults.calls();
  for (const auto kind : {Fault::Kind::refused, Fault::Kind::after_effect}) {
    for (std::size_t call = 0; call < calls; ++call) {
      typename TestFixture::Rig rig;
      rig.faults.inject({.kind = kind, .first = call, .error = hal::BusError::timeout});
      const auto failed = rig.start();
      ASSERT_FALSE(failed) << "call " << call;
      EXPECT_EQ(failed.error().code, DriverErrorCode::bus_failed);
      EXPECT_EQ(failed.error().bus, hal::BusError::timeout);
      EXPECT_TRUE(rig.start()) << "after a fault in call " << call;
    }
  }
}

TYPED_TEST(GyroStart, NeverSucceedsWithAFlippedConfigurationBit) {
  typename TestFixture::Rig counter;
  ASSERT_TRUE(counter.start());
  const std::size_t calls = counter.faults.calls();
  for (std::size_t call = 0; call < calls; ++call) {
    for (std::size_t bit = 0; bit < 8; ++bit) {
      SCOPED_TRACE(::testing::Message() << "call " << call << " bit " << bit);
      typename TestFixture::Rig rig;
      rig.faults.inject({.kind = Fault::Kind::flipped_bit, .first = call, .bit = bit});
      if (!rig.start()) continue;
      // It may pass, for instance where the bit is none of ours; then the chip must be right.
      for (std::size_t i = 0; i < TestFixture::kCalls; ++i) EXPECT_TRUE(rig.driver.verify_next());
      TestFixture::expect_right_rate(rig);
    }
  }
}

TYPED_TEST(GyroStart, MustComeBeforeReadingAndVerifying) {
  typename TestFixture::Rig rig;
  std::array<GyroSample, 1> out{};
  const auto read = rig.read(out);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, DriverErrorCode::not_ready);
  const auto verified = rig.driver.verify_next();
  ASSERT_FALSE(verified);
  EXPECT_EQ(verified.error().code, DriverErrorCode::not_ready);
  EXPECT_EQ(rig.faults.calls(), 0U);
}

TYPED_TEST(GyroStart, MayBeRepeatedWhileTheChipRuns) {
  typename TestFixture::Rig rig;
  ASSERT_TRUE(rig.start());
  ASSERT_TRUE(rig.start());
  TestFixture::expect_right_rate(rig);
}

TYPED_TEST(GyroStart, IsFollowedByVerificationsOfOneRegisterEach) {
  typename TestFixture::Rig rig;
  ASSERT_TRUE(rig.start());
  const std::size_t before = rig.faults.calls();
  ASSERT_TRUE(rig.driver.verify_next());
  EXPECT_EQ(rig.faults.calls(), before + TypeParam::Gyro::kVerifyTransactions);
}

/// Verifies SR-IF-17.
TYPED_TEST(GyroStart, IsFollowedByAWatchOverEveryBitThatWasConfigured) {
  for (const ConfiguredBits& entry : TypeParam::Gyro::kConfigured) {
    for (unsigned bit = 1; bit < 0x100; bit <<= 1U) {
      if ((entry.bits & bit) == 0) continue;
      typename TestFixture::Rig rig;
      ASSERT_TRUE(rig.start());
      rig.chip.upset(entry.address, static_cast<std::uint8_t>(bit));
      std::size_t refused_calls = 0;
      for (std::size_t call = 0; call < TestFixture::kCalls; ++call) {
        const auto verified = rig.driver.verify_next();
        if (verified) continue;
        ++refused_calls;
        EXPECT_TRUE(verified.error().code == DriverErrorCode::configuration_lost ||
                    verified.error().code == DriverErrorCode::sensor_fault);
      }
      EXPECT_GE(refused_calls, 1U) << "register " << int{entry.address} << " bit " << bit;
      ASSERT_TRUE(rig.start() || rig.start());
      TestFixture::expect_right_rate(rig);
    }
  }
}

TYPED_TEST(GyroStart, IsNeededAgainAfterAnInterruptedSupply) {
  typename TestFixture::Rig rig;
  ASSERT_TRUE(rig.start());
  for (std::size_t call = 0; call < 3 * TestFixture::kCalls; ++call) {
    ASSERT_TRUE(rig.driver.verify_next());
  }
  rig.chip.cycle_power();
  std::size_t calls = 0;
  while (rig.driver.verify_next() && calls < TestFixture::kCalls) ++calls;
  EXPECT_LT(calls, TestFixture::kCalls);
  ASSERT_TRUE(rig.start());
  TestFixture::expect_right_rate(rig);
}

}  // namespace
}  // namespace zerorate::contract
