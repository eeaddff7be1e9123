#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <array>

#include "hal/testing/fault_injector.hpp"
#include "hal/testing/scripted_bus.hpp"

namespace zerorate::hal::testing {
namespace {

constexpr std::array<std::uint8_t, 1> kCommand{0x8F};

TEST(ScriptedBus, AnswersReadsAndAcceptsTheScriptedWrites) {
  ScriptedSpiDevice spi;
  spi.expect({writes({0x8F}), reads({0x6C})});
  std::array<std::uint8_t, 1> answer{};
  const std::array operations{Operation::write(kCommand), Operation::read(answer)};
  EXPECT_TRUE(spi.transaction(operations));
  EXPECT_EQ(answer[0], 0x6C);
}

TEST(ScriptedBus, FailsTheTestWhenOtherBytesAreWritten) {
  ScriptedSpiDevice spi;
  spi.expect({writes({0x90})});
  const std::array operations{Operation::write(kCommand)};
  EXPECT_NONFATAL_FAILURE(EXPECT_FALSE(spi.transaction(operations)),
                          "transaction 0: operation 0 is a write of 8F, scripted a write of 90");
}

TEST(ScriptedBus, FailsTheTestWhenAReadHasAnotherLength) {
  ScriptedSpiDevice spi;
  spi.expect({reads({1, 2})});
  std::array<std::uint8_t, 3> answer{};
  const std::array operations{Operation::read(answer)};
  EXPECT_NONFATAL_FAILURE(EXPECT_FALSE(spi.transaction(operations)),
                          "a read of 3, scripted a read of 2");
}

TEST(ScriptedBus, FailsTheTestWhenTheTransactionIsSplit) {
  ScriptedSpiDevice spi;
  spi.expect({writes({0x8F}), reads({0x6C})});
  const std::array operations{Operation::write(kCommand)};
  EXPECT_NONFATAL_FAILURE(EXPECT_FALSE(spi.transaction(operations)), "1 operations, scripted 2");
}

TEST(ScriptedBus, FailsTheTestWhenAnotherDeviceIsAddressed) {
  ScriptedI2cBus i2c;
  i2c.expect(I2cAddress{0x6A}, {writes({0x8F})});
  const std::array operations{Operation::write(kCommand)};
  EXPECT_NONFATAL_FAILURE(EXPECT_FALSE(i2c.transaction(I2cAddress{0x6B}, operations)),
                          "another device address");
}

TEST(ScriptedBus, FailsTheTestWhenMoreIsAskedThanScripted) {
  ScriptedSpiDevice spi;
  const std::array operations{Operation::write(kCommand)};
  EXPECT_NONFATAL_FAILURE(EXPECT_FALSE(spi.transaction(operations)), "not in the script");
}

TEST(ScriptedBus, FailsTheTestWhenTheScriptIsNotUsedUp) {
  EXPECT_NONFATAL_FAILURE(
      {
        ScriptedSpiDevice spi;
        spi.expect({writes({0x8F})});
      },
      "1 scripted transactions did not happen");
}

TEST(ScriptedBus, DoesWhatComesBeforeAFailureInTheMiddle) {
  ScriptedI2cBus i2c;
  i2c.expect(I2cAddress{0x6A}, {reads({0x11}), reads({0x22})}, FailureAt{1, BusError::nack});
  std::array<std::uint8_t, 1> first{};
  std::array<std::uint8_t, 1> second{};
  const std::array operations{Operation::read(first), Operation::read(second)};
  const auto done = i2c.transaction(I2cAddress{0x6A}, operations);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error(), BusError::nack);
  EXPECT_EQ(first[0], 0x11);
  EXPECT_EQ(second[0], 0x00);
}

/// Counts transactions and answers every read with 0x0F.
struct CountingSpi {
  core::Result<void, BusError> transaction(std::span<const Operation> operations) {
    ++calls;
    for (const Operation& operation : operations) {
      for (std::uint8_t& byte : operation.buffer()) byte = 0x0F;
    }
    return {};
  }
  int calls = 0;
};

class FaultInjectorTest : public ::testing::Test {
 protected:
  core::Result<void, BusError> read() {
    const std::array operations{Operation::read(answer_)};
    return injector_.transaction(operations);
  }

  CountingSpi spi_;
  FaultInjector<CountingSpi> injector_{spi_};
  std::array<std::uint8_t, 2> answer_{};
};

TEST_F(FaultInjectorTest, RefusesChosenCallsBeforeTheirEffect) {
  injector_.inject({.first = 1, .calls = 2, .error = BusError::timeout});
  EXPECT_TRUE(read());
  EXPECT_EQ(read().error(), BusError::timeout);
  EXPECT_EQ(read().error(), BusError::timeout);
  EXPECT_TRUE(read());
  EXPECT_EQ(spi_.calls, 2);
  EXPECT_EQ(injector_.calls(), 4U);
}

TEST_F(FaultInjectorTest, FailsAfterTheTransactionTookEffect) {
  injector_.inject({.kind = Fault::Kind::after_effect, .error = BusError::nack});
  EXPECT_EQ(read().error(), BusError::nack);
  EXPECT_EQ(spi_.calls, 1);
}

TEST_F(FaultInjectorTest, FlipsOneBitOfTheFirstByteRead) {
  injector_.inject({.kind = Fault::Kind::flipped_bit, .bit = 7});
  EXPECT_TRUE(read());
  EXPECT_EQ(answer_, (std::array<std::uint8_t, 2>{0x8F, 0x0F}));
}

TEST_F(FaultInjectorTest, HoldsTheLineForEver) {
  injector_.inject({.kind = Fault::Kind::stuck_high, .calls = Fault::kForEver});
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(read());
  EXPECT_EQ(answer_, (std::array<std::uint8_t, 2>{0xFF, 0xFF}));
  EXPECT_EQ(spi_.calls, 0);
  injector_.clear();
  EXPECT_TRUE(read());
  EXPECT_EQ(spi_.calls, 1);
}

}  // namespace
}  // namespace zerorate::hal::testing
