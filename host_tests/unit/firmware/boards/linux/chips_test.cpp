#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>
#include <span>

#include "firmware/boards/linux/chips/gyro.hpp"
#include "firmware/boards/linux/chips/iio_gyro.hpp"
#include "firmware/boards/linux/speed_source.hpp"
#include "host_tests/unit/firmware/boards/linux/made_iio.hpp"

namespace zerorate::linux_node {
namespace {

/// Eight bytes as one number, as the byte order says.
std::uint64_t number_of(const std::array<std::uint8_t, 8>& payload, bool is_big_endian) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < payload.size(); ++i) {
    number = number << 8U | payload.at(is_big_endian ? i : payload.size() - 1 - i);
  }
  return number;
}

TEST(SignalOfACanFrame, IsThatOfTheDbcFile) {
  std::mt19937_64 random{18};
  int tried = 0;
  for (int i = 0; i < 20'000; ++i) {
    CanSignal signal{.start_bit = static_cast<unsigned>(random() % 64),
                     .length = static_cast<unsigned>(1 + random() % 32),
                     .is_big_endian = random() % 2 == 0};
    std::array<std::uint8_t, 8> payload{};
    for (std::uint8_t& byte : payload) byte = static_cast<std::uint8_t>(random());
    // Bits above the signal in the number of all eight bytes.
    const unsigned above = signal.is_big_endian
                               ? signal.start_bit / 8 * 8 + 7 - signal.start_bit % 8
                               : 64 - signal.length - signal.start_bit;
    if (above > 64 - signal.length) {
      EXPECT_EQ(signal.bytes(), 0U);
      EXPECT_FALSE(decode_signal(signal, payload));
      continue;
    }
    const std::uint64_t shifted = number_of(payload, signal.is_big_endian) << above;
    ASSERT_EQ(decode_signal(signal, payload), static_cast<double>(shifted >> (64 - signal.length)));
    signal.is_signed = true;
    signal.scale = 0.5;
    signal.offset = -3.0;
    const auto value = static_cast<std::int64_t>(shifted) >> (64 - signal.length);
    ASSERT_EQ(decode_signal(signal, payload), 0.5 * static_cast<double>(value) - 3.0);
    ++tried;
  }
  EXPECT_GT(tried, 10'000);
}

TEST(SignalOfACanFrame, IsNoneInAFrameThatIsTooShort) {
  const CanSignal signal{.start_bit = 7, .length = 16, .is_big_endian = true};
  const std::array<std::uint8_t, 2> payload{0x12, 0x34};
  EXPECT_EQ(decode_signal(signal, payload), 4660.0);
  EXPECT_FALSE(decode_signal(signal, std::span{payload}.first(1)));
}

TEST(ChipOfIio, IsTheOneWhoseNameTheDeviceBears) {
  EXPECT_EQ(chip_of_iio("lsm6dso_gyro"), "lsm6dso");
  EXPECT_EQ(chip_of_iio("bmi088_gyro"), "bmi088");
  EXPECT_EQ(chip_of_iio("lsm6dsox_gyro"), "lsm6dsox");
  EXPECT_EQ(chip_of_iio("lsm6ds3tr-c_gyro"), "lsm6ds3tr-c");
  EXPECT_EQ(chip_of_iio("icm42605-gyro"), "icm42605");
  EXPECT_EQ(chip_of_iio("iio:device0"), "");
}

TEST(MakeGyro, RefusesAChipThatADriverOfTheKernelHolds) {
  const testing::ScratchFolder sys;
  const auto bind = [&](const std::string& device, const std::string& driver) {
    std::filesystem::create_directories(sys.path() / "bus" / device);
    std::filesystem::create_symlink("/drivers/" + driver, sys.path() / "bus" / device / "driver");
  };
  bind("i2c/devices/1-006a", "st_lsm6dsx_i2c");
  bind("spi/devices/spi0.0", "spidev");
  bind("spi/devices/spi0.1", "adxrs450");
  GyroSettings wired{.chip = "lsm6dso",
                     .bus = BusKind::i2c,
                     .device = "/dev/i2c-1",
                     .address = 0x6A,
                     .rate_hz = 104,
                     .full_scale_dps = 250};
  EXPECT_EQ(kernel_error_of([&] { return make_gyro(wired, sys.path()); }),
            "/dev/i2c-1: the kernel's driver st_lsm6dsx_i2c holds the chip (read it with bus = "
            "\"iio\", see zerorate probe; or unbind the driver)");
  wired.address = 0x6B;
  EXPECT_NE(make_gyro(wired, sys.path()), nullptr);
  wired.bus = BusKind::spi;
  wired.device = "/dev/spidev0.0";
  EXPECT_NE(make_gyro(wired, sys.path()), nullptr);
  wired.device = "/dev/spidev0.1";
  EXPECT_TRUE(
      contains(kernel_error_of([&] { return make_gyro(wired, sys.path()); }), "adxrs450 holds"));
  wired.device = "/dev/spidev0.0";
  wired.accelerometer_device = "/dev/spidev0.1";
  EXPECT_TRUE(contains(kernel_error_of([&] { return make_gyro(wired, sys.path()); }),
                       "/dev/spidev0.1: the kernel's driver adxrs450 holds"));
}

}  // namespace
}  // namespace zerorate::linux_node
