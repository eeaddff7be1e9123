#include "hal/testing/fault_injector.hpp"

#include <gtest/gtest.h>

#include <array>

namespace zerorate::hal::testing {
namespace {

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

TEST_F(FaultInjectorTest, RefusesTheChosenCallsOnlyAndBeforeTheyTakeEffect) {
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
