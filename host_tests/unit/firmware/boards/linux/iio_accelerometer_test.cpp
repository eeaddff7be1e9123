#include "firmware/boards/linux/chips/iio_accelerometer.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>

#include "firmware/boards/linux/chips/iio_gyro.hpp"
#include "host_tests/unit/firmware/boards/linux/made_iio.hpp"

namespace zerorate::linux_node {
namespace {

using drivers::DriverErrorCode;

constexpr core::Instant kBegin = core::Instant{} + core::Duration::seconds(100);
constexpr core::Duration kGyroPeriod = core::Duration::nanoseconds(9'615'385);
constexpr const char* kOther = "iio:device1";
constexpr std::int16_t kOneG = 8197;  ///< count of 1 g at 0.122 mg, the range of 4 g

/// A gyro and an accelerometer of the kernel, one second after the start.
struct AccelerationRig {
  explicit AccelerationRig(const Attributes& attributes = accelerometer(),
                           const std::string& device = kOther) {
    made.add("iio:device0", buffered());
    made.add(kOther, attributes);
    settings.accelerometer_device = device;
  }
  std::string start_message() {
    gyro.emplace(settings, made.places());
    const auto started = gyro->start(kBegin);
    return started ? "" : gyro->reason(started.error().code).told;
  }
  /// The only sample of the gyro, at `now`, read later.
  drivers::GyroSample sample(core::Duration later = {}) {
    made.send(now, {1, 1, 1});
    std::array<drivers::GyroSample, 8> samples{};
    const auto count = gyro->read(now + later, samples);
    EXPECT_TRUE(count && *count == 1);
    now = now + kGyroPeriod;
    return samples[0];
  }

  MadeIio made;
  GyroSettings settings{.chip = "lsm6dso",
                        .bus = BusKind::iio,
                        .device = "iio:device0",
                        .rate_hz = 104.0,
                        .full_scale_dps = 250.0,
                        .acceleration_range_g = 4.0};
  std::optional<IioGyro> gyro;
  core::Instant now = kBegin + core::Duration::seconds(1);
};

void expect_force(const drivers::GyroSample& sample, const std::array<double, 3>& g) {
  ASSERT_TRUE(sample.has_acceleration);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(sample.acceleration.at(axis).in(core::standard_gravity), g.at(axis), 1e-3) << axis;
  }
}

TEST(IioAccelerometer, SetsItsRangeRateAndBuffer) {
  AccelerationRig rig;
  ASSERT_EQ(rig.start_message(), "");
  EXPECT_NEAR(std::stod(rig.made.get("in_accel_scale", kOther)), 0.001196411, 1e-12);
  EXPECT_EQ(rig.made.get("sampling_frequency", kOther), "104.000");
  EXPECT_EQ(rig.made.get("current_timestamp_clock", kOther), "monotonic");
  EXPECT_EQ(rig.made.get("buffer/enable", kOther), "1");
}

TEST(IioAccelerometer, GivesASampleTheNewestReadingAndEachOnce) {
  AccelerationRig rig;
  ASSERT_EQ(rig.start_message(), "");
  rig.made.send(rig.now - kGyroPeriod, {kOneG, 0, 0}, kOther);
  rig.made.send(rig.now + kGyroPeriod / 3, {0, -kOneG, 0}, kOther);
  rig.made.send(rig.now + kGyroPeriod, {0, 0, kOneG}, kOther);
  expect_force(rig.sample(), {0.0, -1.0, 0.0});
  expect_force(rig.sample(), {0.0, 0.0, 1.0});
  EXPECT_FALSE(rig.sample().has_acceleration) << "none has come since";
  rig.now = rig.now + core::Duration::milliseconds(1);
  rig.made.send(rig.now - core::Duration::milliseconds(101), {0, 0, kOneG}, kOther);
  EXPECT_FALSE(rig.sample().has_acceleration) << "it is too old";
}

TEST(IioAccelerometer, GivesNoForceAtTheEndOfItsRange) {
  AccelerationRig rig;
  ASSERT_EQ(rig.start_message(), "");
  for (const std::int16_t count : {std::int16_t{32767}, std::int16_t{-32768}}) {
    rig.made.send(rig.now, {0, count, 0}, kOther);
    EXPECT_FALSE(rig.sample().has_acceleration);
  }
  rig.settings.acceleration_range_g = 3.0;  // less than the 4 g of the driver
  ASSERT_EQ(rig.start_message(), "");
  rig.made.send(rig.now, {0, 0, 3 * kOneG + 100}, kOther);
  EXPECT_FALSE(rig.sample().has_acceleration);
  rig.made.send(rig.now, {0, 0, 3 * kOneG - 100}, kOther);
  EXPECT_TRUE(rig.sample().has_acceleration);
}

TEST(IioAccelerometer, IsTurnedByItsOwnMountMatrix) {
  Attributes turned = accelerometer();
  turned["in_accel_mount_matrix"] = "0, 1, 0; -1, 0, 0; 0, 0, 1";
  AccelerationRig rig{turned};
  ASSERT_EQ(rig.start_message(), "");
  rig.made.send(rig.now, {kOneG, 2 * kOneG, 0}, kOther);
  expect_force(rig.sample(), {2.0, -1.0, 0.0});
}

TEST(IioAccelerometerWithoutABuffer, IsReadEveryFortyMilliseconds) {
  Attributes bare = accelerometer();
  std::erase_if(bare, [](const auto& attribute) {
    return attribute.first.starts_with("scan_elements") || attribute.first.starts_with("buffer") ||
           attribute.first == "current_timestamp_clock";
  });
  AccelerationRig rig{bare};
  ASSERT_EQ(rig.start_message(), "");
  const core::Duration late = core::Duration::milliseconds(3);
  expect_force(rig.sample(late), {0.0, 0.0, 1.0});
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(rig.sample(late).has_acceleration) << i;
  EXPECT_TRUE(rig.sample(late).has_acceleration);
}

TEST(IioAccelerometer, TellsWhatIsMissing) {
  AccelerationRig nowhere{accelerometer(), "roof"};
  const std::string message = nowhere.start_message();
  EXPECT_TRUE(contains(message, "no accelerometer is called \"roof\" (there are iio:device1 "))
      << message;
  Attributes small = accelerometer();
  small["in_accel_scale_available"] = "0.000598205";
  AccelerationRig narrow{small};
  EXPECT_TRUE(contains(narrow.start_message(), "no range is so large as acceleration_range_g"));
  Attributes slow = accelerometer();
  slow["sampling_frequency_available"] = "12.500 26.000";
  AccelerationRig other_rate{slow};
  EXPECT_TRUE(contains(other_rate.start_message(), "/iio:device1/sampling_frequency: the driver "));
}

TEST(IioAccelerometer, IsStartedAgainWhereAnotherProgramChangedIt) {
  AccelerationRig rig;
  ASSERT_EQ(rig.start_message(), "");
  rig.made.set(kOther, "sampling_frequency", "208.000");
  const auto verify_for_a_minute = [&] {
    for (int i = 0; i < 104 * 60; ++i) {
      if (const auto verified = rig.gyro->verify_next(); !verified) return verified.error().code;
    }
    return DriverErrorCode::not_ready;
  };
  EXPECT_EQ(verify_for_a_minute(), DriverErrorCode::configuration_lost);
  EXPECT_TRUE(contains(rig.gyro->reason(DriverErrorCode::configuration_lost).told, kOther));
}

/// Attributes as inv_mpu6050 shows them: rates and accelerations in one scan.
Attributes of_both() {
  Attributes both = buffered();
  both["name"] = "mpu6500";
  for (const auto& [name, value] : accelerometer()) {
    if (name.starts_with("in_accel") || contains(name, "in_accel")) both[name] = value;
  }
  both["scan_elements/in_anglvel_x_index"] = "3";
  both["scan_elements/in_anglvel_y_index"] = "4";
  both["scan_elements/in_anglvel_z_index"] = "5";
  both["scan_elements/in_timestamp_index"] = "6";
  return both;
}

TEST(IioAccelerometerOfTheGyrosDevice, IsReadInTheSameScan) {
  MadeIio made;
  made.add("iio:device0", of_both());
  IioGyro gyro{{.chip = "mpu6500",
                .bus = BusKind::iio,
                .device = "mpu6500",
                .rate_hz = 104.0,
                .full_scale_dps = 250.0,
                .acceleration_range_g = 4.0,
                .accelerometer_device = "0"},
               made.places()};
  ASSERT_TRUE(gyro.start(kBegin));
  EXPECT_EQ(made.get("scan_elements/in_accel_z_en"), "1");
  EXPECT_NEAR(std::stod(made.get("in_accel_scale")), 0.001196411, 1e-12);
  const core::Instant now = kBegin + core::Duration::seconds(1);
  const std::array<std::int16_t, 6> raw{kOneG, 0, -kOneG, 114, -229, 3429};
  std::array<std::uint8_t, 24> scan{};  // six values, four bytes of padding, the stamp
  const std::int64_t stamp = (now - core::Instant{}).ns();
  std::memcpy(scan.data(), raw.data(), sizeof raw);
  std::memcpy(scan.data() + 16, &stamp, sizeof stamp);
  made.send(scan);
  std::array<drivers::GyroSample, 2> samples{};
  ASSERT_EQ(*gyro.read(now, samples), 1U);
  expect_force(samples[0], {1.0, 0.0, -1.0});
  EXPECT_NEAR(samples[0].rate[2].in(core::deg_per_s), 30.0, 0.03);
}

TEST(IioGyroWithoutAcceleration, ReadsNone) {
  AccelerationRig rig;
  rig.settings.acceleration_range_g.reset();
  ASSERT_EQ(rig.start_message(), "");
  EXPECT_FALSE(rig.sample().has_acceleration);
  EXPECT_EQ(rig.made.get("buffer/enable", kOther), "0");
}

}  // namespace
}  // namespace zerorate::linux_node
