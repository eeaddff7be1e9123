#include "drivers/common/register_bus.hpp"

#include <gtest/gtest.h>

#include "drivers/common/register_access.hpp"
#include "hal/testing/scripted_bus.hpp"

namespace zerorate::drivers {
namespace {

using hal::testing::FailureAt;
using hal::testing::reads;
using hal::testing::writes;

constexpr Register<0x22, Access::read_only> kOutput;
constexpr Register<0x11, Access::read_write> kControl;
constexpr hal::I2cAddress kDevice{0x6B};

TEST(SpiRegisters, SetBit7OfTheAddressToRead) {
  hal::testing::ScriptedSpiDevice spi;
  spi.expect({writes({0xA2}), reads({1, 2, 3})});
  SpiRegisters bus{spi};
  std::array<std::uint8_t, 3> values{};
  ASSERT_TRUE(read_registers(bus, kOutput, values));
  EXPECT_EQ(values, (std::array<std::uint8_t, 3>{1, 2, 3}));
}

TEST(SpiRegisters, WriteAddressAndValueUnderOneSelection) {
  hal::testing::ScriptedSpiDevice spi;
  spi.expect({writes({0x11, 0x40})});
  SpiRegisters bus{spi};
  EXPECT_TRUE(write_register(bus, kControl, 0x40));
}

TEST(I2cRegisters, WriteTheAddressAndReadAfterARepeatedStart) {
  hal::testing::ScriptedI2cBus i2c;
  i2c.expect(kDevice, {writes({0x22}), reads({7})});
  I2cRegisters bus{i2c, kDevice};
  EXPECT_EQ(read_register(bus, kOutput).value_or(0), 7);
}

TEST(I2cRegisters, WriteAddressAndValueInOneMessage) {
  hal::testing::ScriptedI2cBus i2c;
  i2c.expect(kDevice, {writes({0x11, 0x40})});
  I2cRegisters bus{i2c, kDevice};
  EXPECT_TRUE(write_register(bus, kControl, 0x40));
}

TEST(RegisterAccess, ReportsTheBusErrorAndTheRegister) {
  hal::testing::ScriptedI2cBus i2c;
  i2c.expect(kDevice, {writes({0x22}), reads({7})}, FailureAt{1, hal::BusError::nack});
  i2c.expect(kDevice, {writes({0x11, 0x40})}, FailureAt{0, hal::BusError::timeout});
  I2cRegisters bus{i2c, kDevice};
  EXPECT_EQ(read_register(bus, kOutput).error(),
            (DriverError{DriverErrorCode::bus_failed, hal::BusError::nack, 0x22}));
  EXPECT_EQ(write_register(bus, kControl, 0x40).error(),
            (DriverError{DriverErrorCode::bus_failed, hal::BusError::timeout, 0x11}));
}

}  // namespace
}  // namespace zerorate::drivers
