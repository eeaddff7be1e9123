/// @file
/// The driver on a bus of fixed memory: no heap in any of its functions.

#include <gtest/gtest.h>

#include <array>

#include "drivers/common/register_bus.hpp"
#include "drivers/lsm6dso/driver.hpp"
#include "host_tests/support/allocation_counter.hpp"

namespace zerorate::drivers {
namespace {

/// Registers in memory behind an SPI device. Always has a sample, and four words in its FIFO.
class MemorySpi {
 public:
  MemorySpi() {
    memory_[0x0F] = 0x6C;
    memory_[0x1E] = 0x02;
    memory_[0x3A] = 4;
    for (std::size_t i = 0; i < 4; ++i) memory_[0x78 + 7 * i] = 0b00001'00'1;
  }

  core::Result<void, hal::BusError> transaction(std::span<const hal::Operation> operations) {
    std::size_t address = operations[0].bytes()[0] & 0x7FU;
    for (const std::uint8_t byte : operations[0].bytes().subspan(1)) {
      memory_[address] = byte;
      if (address == 0x12) memory_[address] &= 0xFEU;  // the software reset is over at once
      ++address;
    }
    for (const hal::Operation& operation : operations) {
      for (std::uint8_t& byte : operation.buffer()) byte = memory_[address++];
    }
    return {};
  }

 private:
  std::array<std::uint8_t, 0x78 + 4 * 7> memory_{};
};

TEST(Lsm6dso, NeverAllocates) {
  for (const auto mode : {lsm6dso::Mode::data_ready, lsm6dso::Mode::fifo}) {
    const support::AllocationCounter allocations;
    MemorySpi spi;
    Lsm6dso driver{SpiRegisters{spi}, {.mode = mode}};
    std::array<GyroSample, 16> out{};
    constexpr auto kLater = core::Instant{} + core::Duration::seconds(10);
    const bool first = driver.start({}).has_value();
    const bool second = driver.start({}).has_value();
    const std::size_t count = driver.read(kLater, out).value_or(0);
    const bool verified = driver.verify_next().has_value();
    EXPECT_EQ(allocations.count(), 0U);
    EXPECT_FALSE(first);
    EXPECT_TRUE(second);
    EXPECT_EQ(count, mode == lsm6dso::Mode::fifo ? 4U : 1U);
    EXPECT_TRUE(verified);
  }
}

}  // namespace
}  // namespace zerorate::drivers
