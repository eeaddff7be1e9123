#include "drivers/common/configuration_table.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace zerorate::drivers {
namespace {

constexpr Register<0x10, Access::read_write> kFirst;
constexpr Register<0x11, Access::read_write> kSecond;

/// Registers in memory; bits of `stuck_low` cannot be set.
struct MemoryBus {
  core::Result<void, hal::BusError> read(std::uint8_t first, std::span<std::uint8_t> out) {
    ++reads;
    for (std::uint8_t& value : out) value = memory[first++];
    return {};
  }
  core::Result<void, hal::BusError> write(std::uint8_t address, std::uint8_t value) {
    order.push_back(address);
    memory[address] = static_cast<std::uint8_t>(value & ~stuck_low);
    return {};
  }

  std::array<std::uint8_t, 256> memory{};
  std::uint8_t stuck_low = 0;
  int reads = 0;
  std::vector<std::uint8_t> order;
};
static_assert(RegisterBus<MemoryBus>);

ConfigurationTable<2> table() {
  return ConfigurationTable<2>{{configure(kFirst, 0x0F, 0x05), configure(kSecond, 0xC0, 0x80)}};
}

TEST(ConfigurationTable, ChangesItsFieldsOnlyAndInOrder) {
  MemoryBus bus;
  bus.memory[0x10] = 0xFF;
  bus.memory[0x11] = 0x7E;
  auto configuration = table();
  ASSERT_TRUE(configuration.apply(bus));
  EXPECT_EQ(bus.memory[0x10], 0xF5);
  EXPECT_EQ(bus.memory[0x11], 0xBE);
  EXPECT_EQ(bus.order, (std::vector<std::uint8_t>{0x10, 0x11}));
}

TEST(ConfigurationTable, StopsAtARegisterThatDoesNotTakeItsValue) {
  MemoryBus bus;
  bus.stuck_low = 0x04;
  auto configuration = table();
  const auto applied = configuration.apply(bus);
  ASSERT_FALSE(applied);
  EXPECT_EQ(applied.error(), (DriverError{DriverErrorCode::configuration_lost, {}, 0x10}));
  EXPECT_EQ(bus.order.size(), 1U);
}

TEST(ConfigurationTable, VerifiesOneEntryACallAndBeginsAgain) {
  MemoryBus bus;
  auto configuration = table();
  ASSERT_TRUE(configuration.apply(bus));
  bus.reads = 0;
  for (int call = 0; call < 4; ++call) EXPECT_TRUE(configuration.verify_next(bus));
  EXPECT_EQ(bus.reads, 4);
}

TEST(ConfigurationTable, SeesBitsThatWereLostAndBitsThatAppeared) {
  MemoryBus bus;
  auto configuration = table();
  ASSERT_TRUE(configuration.apply(bus));
  bus.memory[0x10] = 0x04;  // bit 0 lost
  EXPECT_EQ(configuration.verify_next(bus).error().reg, 0x10);
  EXPECT_FALSE(configuration.verify_next(bus)) << "stays at the entry that differs";
  bus.memory[0x10] = 0x05;
  EXPECT_TRUE(configuration.verify_next(bus));
  bus.memory[0x11] = 0xC0;  // bit 6 appeared
  EXPECT_EQ(configuration.verify_next(bus).error().reg, 0x11);
}

TEST(ConfigurationTable, IgnoresBitsThatAreNotItsOwn) {
  MemoryBus bus;
  auto configuration = table();
  ASSERT_TRUE(configuration.apply(bus));
  bus.memory[0x10] = 0xF5;
  EXPECT_TRUE(configuration.verify_next(bus));
}

}  // namespace
}  // namespace zerorate::drivers
