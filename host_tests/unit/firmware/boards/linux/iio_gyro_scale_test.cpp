/// @file
/// Scales that the kernel tells with few digits.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <string>

#include "firmware/boards/linux/chips/iio_gyro.hpp"
#include "host_tests/unit/firmware/boards/linux/iio_settings.hpp"
#include "host_tests/unit/firmware/boards/linux/made_iio.hpp"

namespace zerorate::linux_node {
namespace {

// bmg160 tells its scales with two or three digits: 250 deg/s seem to be 249.7.
TEST(IioGyro, TakesTheScaleOfTheDataSheetForOneThatTheDriverRounds) {
  Attributes rounded = buffered();
  rounded["in_anglvel_scale_available"] = "0.001065 0.000532 0.000266 0.000133 0.000066";
  MadeIio made;
  made.add("iio:device0", rounded);
  GyroSettings bmi088 = iio_settings("iio:device0");
  bmi088.chip = "bmi088";
  for (const bool is_known : {true, false}) {
    if (!is_known) bmi088.chip.clear();
    IioGyro gyro{bmi088, made.places()};
    ASSERT_TRUE(gyro.start(kIioStart));
    EXPECT_NEAR(std::stod(made.get("in_anglvel_scale")), 0.000133, 1e-12);
    const core::Instant now = kIioStart + core::Duration::seconds(1);
    made.send(now, {16384, 0, 0});
    std::array<drivers::GyroSample, 8> samples{};
    ASSERT_EQ(*gyro.read(now, samples), 1U);
    EXPECT_NEAR(samples[0].rate[0].in(core::deg_per_s), is_known ? 125.0 : 124.85, 0.005);
  }
}

// adis16475 gives 32 bits. Its scale of the ADIS16475-1 is 1/160 deg/s by 2^16, 0.000000001665.
TEST(IioGyro, ReadsThirtyTwoBitsWhoseScaleHasOneDigit) {
  Attributes wide = buffered();
  wide["in_anglvel_scale"] = "0.000000001";
  wide.erase("in_anglvel_scale_available");
  for (const char* const axis : {"x", "y", "z"}) {
    wide[std::string{"scan_elements/in_anglvel_"} + axis + "_type"] = "be:s32/32>>0";
  }
  MadeIio made;
  made.add("iio:device0", wide);
  GyroSettings adis = iio_settings("iio:device0");
  adis.chip = "adis16475-1";
  adis.full_scale_dps = 125.0;
  IioGyro gyro{adis, made.places()};
  const auto started = gyro.start(kIioStart);
  ASSERT_TRUE(started) << gyro.reason(started.error().code).told;
  const core::Instant now = kIioStart + core::Duration::seconds(1);
  std::array<std::uint8_t, 24> scan{0x06, 0x40, 0, 0, 0xF9, 0xC0, 0, 0, 0x4E, 0x20};
  const std::int64_t stamp = (now - core::Instant{}).ns();
  std::memcpy(scan.data() + 16, &stamp, sizeof stamp);
  made.send(scan);
  std::array<drivers::GyroSample, 8> samples{};
  ASSERT_EQ(*gyro.read(now, samples), 1U);
  const std::array<float, 3> dps{10.0F, -10.0F, 125.0F};  // 1600, -1600, 20000
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(samples[0].rate.at(i).in(core::deg_per_s), dps.at(i), 1e-4F) << i;
  }
  EXPECT_EQ(samples[0].saturated_axes, 0b100);

  adis.chip.clear();
  IioGyro unknown{adis, made.places()};
  const auto refused = unknown.start(kIioStart);
  ASSERT_FALSE(refused);
  EXPECT_TRUE(contains(unknown.reason(refused.error().code).told,
                       "in_anglvel_scale: too few digits (is chip the name of the chip?)"));
}

}  // namespace
}  // namespace zerorate::linux_node
