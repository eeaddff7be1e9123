/// @file
/// Pauses that some chips need between two transactions on SPI.

#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <vector>

#include "hal/linux/spidev.hpp"
#include "host_tests/unit/hal/linux/kernel_double.hpp"

namespace zerorate::hal::linux_os {
namespace {

constexpr std::array<std::uint8_t, 2> kWord{0x72, 0x00};
const std::array kOperations{Operation::write(kWord)};

TEST(SpidevDevice, PausesBetweenTransactionsWhereTheChipNeedsIt) {
  KernelState kernel;
  SpidevDevice<KernelDouble> bus{
      {.device = "/dev/spidev1.0", .pause = core::Duration::microseconds(16)},
      KernelDouble{kernel}};
  kernel.now = core::Instant::from_ns(1'000'000);
  ASSERT_TRUE(bus.transaction(kOperations));
  EXPECT_TRUE(kernel.waits.empty());
  kernel.now = kernel.now + core::Duration::microseconds(6);
  kernel.next_error = EIO;
  EXPECT_FALSE(bus.transaction(kOperations));
  EXPECT_EQ(kernel.waits, std::vector{core::Duration::microseconds(10)});
  ASSERT_TRUE(bus.transaction(kOperations)) << "after a failure too";
  EXPECT_EQ(kernel.waits.size(), 2U);
  EXPECT_EQ(kernel.waits.back(), core::Duration::microseconds(16));
}

TEST(SpidevDevice, DoesNotWaitWhereNoPauseIsNeeded) {
  KernelState kernel;
  SpidevDevice<KernelDouble> bus{{.device = "/dev/spidev1.0"}, KernelDouble{kernel}};
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(bus.transaction(kOperations));
  EXPECT_TRUE(kernel.waits.empty());
}

}  // namespace
}  // namespace zerorate::hal::linux_os
