/// @file
/// Promises of hal/contract about SpiDevice and I2cBus, over every back end.

#include <gtest/gtest.h>

#include <array>

#include "host_tests/contract/register_back_ends.hpp"

namespace zerorate::contract {
namespace {

constexpr std::uint8_t kFirst = 0x10;  // any register that can be read and written

template <class BackEnd>
class BusContract : public ::testing::Test {
 protected:
  BackEnd back_end_;
};
using BackEnds = ::testing::Types<SimulatedSpi, SimulatedI2c, ScriptedSpi, ScriptedI2c, InjectedSpi,
                                  InjectedI2c, LinuxSpi, LinuxI2c>;
TYPED_TEST_SUITE(BusContract, BackEnds);

TYPED_TEST(BusContract, ReadsOneRegister) {
  this->back_end_.prepare_read(kFirst, {0x5A});
  std::array<std::uint8_t, 1> value{};
  ASSERT_TRUE(this->back_end_.registers().read(kFirst, value));
  EXPECT_EQ(value[0], 0x5A);
}

TYPED_TEST(BusContract, ReadsConsecutiveRegistersInOneTransaction) {
  this->back_end_.prepare_read(kFirst, {0x11, 0x22});
  std::array<std::uint8_t, 2> values{};
  ASSERT_TRUE(this->back_end_.registers().read(kFirst, values));
  EXPECT_EQ(values, (std::array<std::uint8_t, 2>{0x11, 0x22}));
}

TYPED_TEST(BusContract, AWriteIsSeenByTheNextRead) {
  this->back_end_.prepare_write(kFirst, 0xA0);
  ASSERT_TRUE(this->back_end_.registers().write(kFirst, 0xA0));
  this->back_end_.prepare_read(kFirst, {0xA0});
  std::array<std::uint8_t, 1> value{};
  ASSERT_TRUE(this->back_end_.registers().read(kFirst, value));
  EXPECT_EQ(value[0], 0xA0);
}

TYPED_TEST(BusContract, EachTransactionBeginsWithItsOwnAddress) {
  this->back_end_.prepare_read(kFirst, {0x33});
  std::array<std::uint8_t, 1> first{};
  ASSERT_TRUE(this->back_end_.registers().read(kFirst, first));
  this->back_end_.prepare_read(kFirst, {0x33});
  std::array<std::uint8_t, 1> again{};
  ASSERT_TRUE(this->back_end_.registers().read(kFirst, again));
  EXPECT_EQ(first, again);
}

TYPED_TEST(BusContract, AnEmptyTransactionSucceeds) {
  this->back_end_.prepare_empty();
  EXPECT_TRUE(this->back_end_.transaction({}));
}

template <class BackEnd>
class SpiContract : public ::testing::Test {
 protected:
  BackEnd back_end_;
};
using SpiBackEnds = ::testing::Types<SimulatedSpi, ScriptedSpi, InjectedSpi, LinuxSpi>;
TYPED_TEST_SUITE(SpiContract, SpiBackEnds);

TYPED_TEST(SpiContract, AnExchangeReceivesWhileItSends) {
  this->back_end_.prepare_exchange({kFirst | 0x80U, 0x00}, {0xFF, 0x5A});
  std::array<std::uint8_t, 2> bytes{kFirst | 0x80U, 0x00};
  const std::array operations{hal::Operation::exchange(bytes, bytes)};
  ASSERT_TRUE(this->back_end_.transaction(operations));
  EXPECT_EQ(bytes[1], 0x5A);
}

template <class Bus>
void expect_nack_at_another_address(Bus& bus) {
  drivers::I2cRegisters elsewhere{bus, hal::I2cAddress{0x11}};
  std::array<std::uint8_t, 1> value{};
  const auto done = elsewhere.read(kFirst, value);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error(), hal::BusError::nack);
}

TEST(I2cBusContract, AnotherAddressIsNotAcknowledged) {
  SimulatedI2c simulated;
  expect_nack_at_another_address(simulated.bus);
  LinuxI2c linux_back_end;
  expect_nack_at_another_address(linux_back_end.device);
}

}  // namespace
}  // namespace zerorate::contract
