#include "firmware/boards/linux/chips/iio_gyro.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "hal/linux/sysfs.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tests/unit/firmware/boards/linux/iio_settings.hpp"
#include "host_tests/unit/firmware/boards/linux/made_iio.hpp"

namespace zerorate::linux_node {
namespace {

using drivers::DriverErrorCode;
using drivers::GyroSample;

constexpr core::Duration kPeriod = core::Duration::nanoseconds(9'615'385);
constexpr double kScale = 8.75e-3 * 0.017453292519943295;  // rad/s; the driver gives 0.000152716

/// A device and its gyro, one second after its start: what the chip sends first is past.
struct Rig {
  explicit Rig(const Attributes& attributes = buffered(), double rate_hz = 104.0) {
    made.add("iio:device0", attributes);
    gyro.emplace(iio_settings("iio:device0", rate_hz), made.places());
  }
  std::string start_message() {
    const auto started = gyro->start(kIioStart);
    return started ? "" : gyro->reason(started.error().code).told;
  }
  core::Result<std::size_t, drivers::DriverError> read() { return gyro->read(now, samples); }

  MadeIio made;
  std::optional<IioGyro> gyro;
  core::Instant now = kIioStart + core::Duration::seconds(1);
  std::array<GyroSample, 8> samples{};
};

TEST(IioGyro, SetsRangeRateClockScanAndBuffer) {
  Rig rig;
  ASSERT_EQ(rig.start_message(), "");
  EXPECT_NEAR(std::stod(rig.made.get("in_anglvel_scale")), 0.000152716, 1e-12);
  EXPECT_EQ(rig.made.get("sampling_frequency"), "104.000");
  EXPECT_EQ(rig.made.get("current_timestamp_clock"), "monotonic");
  for (const char* const channel : {"anglvel_x", "anglvel_y", "anglvel_z", "timestamp"}) {
    EXPECT_EQ(rig.made.get(std::string{"scan_elements/in_"} + channel + "_en"), "1") << channel;
  }
  EXPECT_EQ(rig.made.get("buffer/length"), "208");
  EXPECT_EQ(rig.made.get("buffer/watermark"), "2");
  EXPECT_EQ(rig.made.get("buffer/enable"), "1");
  EXPECT_EQ(rig.gyro->sample_period(), kPeriod);
  EXPECT_TRUE(rig.gyro->is_batched());
  EXPECT_GE(rig.gyro->descriptor(), 0);
}

TEST(IioGyro, ReadsScansWithTheirStamps) {
  Rig rig;
  ASSERT_EQ(rig.start_message(), "");
  EXPECT_EQ(*rig.read(), 0U);
  rig.made.send(rig.now, {114, -229, 3429});
  rig.made.send(rig.now + kPeriod, {0, 32767, -28580});
  ASSERT_EQ(*rig.read(), 2U);
  EXPECT_EQ(rig.samples[0].time, rig.now);
  EXPECT_EQ(rig.samples[1].time, rig.now + kPeriod);
  const std::array<double, 3> dps{1.0, -2.0, 30.0};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(rig.samples[0].rate.at(i).in(core::deg_per_s), dps.at(i), 0.00875);
  }
  EXPECT_EQ(rig.samples[0].saturated_axes, 0);
  EXPECT_EQ(rig.samples[1].rate[0].in(core::rad_per_s), 0.0F);
  EXPECT_EQ(rig.samples[1].saturated_axes, 0b110);
  EXPECT_FALSE(rig.samples[0].has_temperature);
}

TEST(IioGyro, LeavesOutWhatTheChipSendsWhileItSettles) {
  Rig rig;
  ASSERT_EQ(rig.start_message(), "");
  for (int i = 1; i <= 33; ++i) rig.made.send(kIioStart + kPeriod * i, {1, 1, 1});
  ASSERT_EQ(*rig.read(), 2U);  // the 32nd is the first after 300 ms
  EXPECT_EQ(rig.samples[0].time, kIioStart + kPeriod * 32);
}

TEST(IioGyro, TakesAScanThatComesInTwoPieces) {
  Rig rig;
  ASSERT_EQ(rig.start_message(), "");
  std::array<std::uint8_t, 16> scan{};
  const std::int64_t stamp = (rig.now - core::Instant{}).ns();
  std::memcpy(scan.data() + 8, &stamp, sizeof stamp);
  rig.made.send(std::span{scan}.first(9));
  EXPECT_EQ(*rig.read(), 0U);
  rig.made.send(std::span{scan}.subspan(9));
  ASSERT_EQ(*rig.read(), 1U);
  EXPECT_EQ(rig.samples[0].time, rig.now);
}

TEST(IioGyro, TellsAGapOnceAndGoesOnBehindIt) {
  Rig rig;
  ASSERT_EQ(rig.start_message(), "");
  rig.made.send(rig.now, {1, 1, 1});
  rig.made.send(rig.now + kPeriod * 4, {2, 2, 2});
  rig.made.send(rig.now + kPeriod * 5, {3, 3, 3});
  EXPECT_EQ(*rig.read(), 1U);
  const auto gap = rig.read();
  ASSERT_FALSE(gap);
  EXPECT_EQ(gap.error().code, DriverErrorCode::fifo_overrun);
  ASSERT_EQ(*rig.read(), 2U);
  EXPECT_EQ(rig.samples[0].time, rig.now + kPeriod * 4);
}

TEST(IioGyro, RefusesStampsThatRunBackwardsAndTellsSilence) {
  Rig rig;
  ASSERT_EQ(rig.start_message(), "");
  rig.made.send(rig.now, {1, 1, 1});
  rig.made.send(rig.now - kPeriod, {1, 1, 1});
  const auto backwards = rig.read();
  ASSERT_FALSE(backwards);
  EXPECT_TRUE(contains(rig.gyro->reason(backwards.error().code).told, "run backwards"));

  ASSERT_EQ(rig.start_message(), "");
  rig.now = kIioStart + core::Duration::milliseconds(1001);
  const auto silent = rig.read();
  ASSERT_FALSE(silent);
  EXPECT_EQ(silent.error().bus, hal::BusError::timeout);
  EXPECT_TRUE(contains(rig.gyro->reason(silent.error().code).told, "iio:device0: no sample"));
}

TEST(IioGyro, TurnsTheAxesByTheMountMatrix) {
  Attributes turned = buffered();
  turned["in_mount_matrix"] = "0, 1, 0; -1, 0, 0; 0, 0, 1";
  Rig rig{turned};
  ASSERT_EQ(rig.start_message(), "");
  rig.made.send(rig.now, {100, 32767, 7});
  ASSERT_EQ(*rig.read(), 1U);
  EXPECT_FLOAT_EQ(rig.samples[0].rate[0].in(core::rad_per_s), static_cast<float>(32767 * kScale));
  EXPECT_FLOAT_EQ(rig.samples[0].rate[1].in(core::rad_per_s), static_cast<float>(-100 * kScale));
  EXPECT_EQ(rig.samples[0].saturated_axes, 0b001);
}

TEST(IioGyro, GivesAChipWithoutAThermometerNoTemperature) {
  MadeIio made;
  made.add("iio:device0", polled());
  GyroSettings bosch = iio_settings("iio:device0", 50.0);
  bosch.chip = "bmi088";
  IioGyro gyro{bosch, made.places()};
  ASSERT_TRUE(gyro.start(kIioStart));
  std::array<GyroSample, 1> sample{};
  ASSERT_EQ(*gyro.read(kIioStart, sample), 1U);
  EXPECT_FALSE(sample[0].has_temperature);
}

TEST(IioGyro, TakesTemperatureFromTheScanWhereItIsOne) {
  Attributes warm = buffered();
  warm["in_temp_raw"] = "0";
  warm["in_temp_scale"] = "7.548309";  // inv_icm42600: 132.48 counts a kelvin, 25 degC at 0
  warm["in_temp_offset"] = "3312";
  warm["scan_elements/in_temp_en"] = "0";
  warm["scan_elements/in_temp_index"] = "4";
  warm["scan_elements/in_temp_type"] = "be:s16/16>>0";
  warm["scan_elements/in_timestamp_index"] = "5";
  Rig rig{warm};
  ASSERT_EQ(rig.start_message(), "");
  std::array<std::uint8_t, 16> scan{0, 0, 0, 0, 0, 0, 0x05, 0x2D};  // 1325: 10 K
  const std::int64_t stamp = (rig.now - core::Instant{}).ns();
  std::memcpy(scan.data() + 8, &stamp, sizeof stamp);
  rig.made.send(scan);
  ASSERT_EQ(*rig.read(), 1U);
  ASSERT_TRUE(rig.samples[0].has_temperature);
  EXPECT_NEAR((rig.samples[0].temperature - core::Temperature::from_degc(35.0F)).in(core::kelvin),
              0.0F, 0.01F);
}

TEST(IioGyro, TakesTheTriggerOfItsDevice) {
  Attributes triggered = buffered();
  triggered["trigger/current_trigger"] = "";
  {
    Rig rig{triggered};
    EXPECT_TRUE(contains(rig.start_message(), "none is called \"lsm6dso_gyro-dev0\""));
  }
  Rig rig{triggered};
  std::filesystem::create_directories(rig.made.path() / "sys/trigger0");
  rig.made.set("trigger0", "name", "lsm6dso_gyro-dev0\n");
  ASSERT_EQ(rig.start_message(), "");
  EXPECT_EQ(rig.made.get("trigger/current_trigger"), "lsm6dso_gyro-dev0");
}

TEST(IioGyro, NoticesWhenAnotherProgramChangesTheDevice) {
  Rig rig;
  ASSERT_EQ(rig.start_message(), "");
  const auto verify_for_a_minute = [&] {
    for (int i = 0; i < 104 * 60; ++i) {
      if (const auto verified = rig.gyro->verify_next(); !verified) return verified.error().code;
    }
    return DriverErrorCode::not_ready;
  };
  EXPECT_EQ(verify_for_a_minute(), DriverErrorCode::not_ready);
  rig.made.set("iio:device0", "sampling_frequency", "208.000");
  EXPECT_EQ(verify_for_a_minute(), DriverErrorCode::configuration_lost);
  EXPECT_TRUE(contains(rig.gyro->reason(DriverErrorCode::configuration_lost).told, "changed"));
  EXPECT_EQ(rig.start_message(), "");
  EXPECT_EQ(verify_for_a_minute(), DriverErrorCode::not_ready);
}

TEST(IioGyro, FindsADeviceAgainThatWasUnplugged) {
  Rig rig;
  ASSERT_EQ(rig.start_message(), "");
  const auto sys = rig.made.path() / "sys/iio:device0";
  std::filesystem::rename(sys, rig.made.path() / "gone");
  EXPECT_TRUE(contains(rig.start_message(), "no gyro is called \"iio:device0\""));
  EXPECT_EQ(rig.gyro->descriptor(), -1);
  EXPECT_FALSE(rig.read());
  std::filesystem::rename(rig.made.path() / "gone", sys);
  EXPECT_EQ(rig.start_message(), "");
}

TEST(IioGyro, TellsPathReasonAndCureOfWhatItCannotUse) {
  struct Case {
    std::string attribute;
    std::string value;
    std::string words;
  };
  const std::vector<Case> cases{
      {"sampling_frequency_available", "12.500 26.000",
       "sampling_frequency: the driver has no rate of rate_hz (it offers 12.500 26.000)"},
      {"in_anglvel_scale_available", "0.0000001", "no range is so large as full_scale_dps"},
      {"in_anglvel_scale_available", "a lot", "in_anglvel_scale_available: \"a\" is no number"},
      {"scan_elements/in_anglvel_y_type", "le:s16/17>>0", "in_anglvel_y_type: \"le:s16/17>>0\""},
      {"mount_matrix", "1, 0; 0, 1", "mount_matrix: not nine numbers"},
  };
  for (const Case& wrong : cases) {
    Attributes attributes = buffered();
    attributes[wrong.attribute] = wrong.value;
    Rig rig{attributes};
    const std::string message = rig.start_message();
    EXPECT_TRUE(contains(message, wrong.words)) << message;
    EXPECT_TRUE(contains(message, rig.made.places().sysfs)) << message;
  }
  Rig rig;
  std::filesystem::remove(rig.made.path() / "dev/iio:device0");
  EXPECT_EQ(
      rig.start_message(),
      rig.made.places().nodes + "/iio:device0: No such file or directory (is the driver bound?)");
}

/// Fails the calls on the nodes with these numbers; 0: does them.
struct FailingNodes final : hal::linux_os::FileCalls {
  int open_error = 0;
  int read_error = 0;

  hal::linux_os::CallResult open(const char* path, int flags, unsigned mode) override {
    if (open_error != 0) return core::Unexpected{open_error};
    return FileCalls::open(path, flags, mode);
  }
  hal::linux_os::CallResult read(int descriptor, std::span<std::uint8_t> out) override {
    if (read_error != 0) return core::Unexpected{read_error};
    return FileCalls::read(descriptor, out);
  }
};

struct FailingRig : Rig {
  FailingRig() {
    hal::linux_os::IioPlaces places = made.places();
    places.calls = &nodes;
    gyro.emplace(iio_settings("iio:device0"), places);
  }
  FailingNodes nodes;
};

TEST(IioGyroOfTheKernel, TellsWhatKeepsItsNodeFromBeingOpened) {
  struct Case {
    int error;
    std::string_view words;
  };
  for (const Case& failure :
       {Case{EBUSY, "Device or resource busy (another program reads it, e.g. iio-sensor-proxy)"},
        Case{EACCES, "Permission denied (is the udev rule of zerorate installed?)"},
        Case{ENODEV, "No such device (is the driver bound?)"}}) {
    FailingRig rig;
    rig.nodes.open_error = failure.error;
    const auto started = rig.gyro->start(kIioStart);
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().bus, hal::BusError::not_present);
    const GyroReason reason = rig.gyro->reason(started.error().code);
    EXPECT_EQ(reason.error_number, failure.error);
    EXPECT_EQ(reason.told, rig.made.places().nodes + "/iio:device0: " + std::string{failure.words});
    EXPECT_EQ(rig.made.get("buffer/enable"), "0") << "nothing was changed";
    rig.nodes.open_error = 0;
    EXPECT_EQ(rig.start_message(), "") << "tried again";
  }
}

TEST(IioGyroOfTheKernel, TellsThatItWasUnboundWhileItRan) {
  FailingRig rig;
  ASSERT_EQ(rig.start_message(), "");
  rig.made.send(rig.now, {1, 1, 1});
  ASSERT_EQ(*rig.read(), 1U);
  rig.nodes.read_error = ENODEV;
  const auto gone = rig.read();
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().bus, hal::BusError::not_present);
  EXPECT_EQ(rig.gyro->reason(gone.error().code).told,
            rig.made.places().nodes + "/iio:device0: No such device (was the device unplugged?)");
  EXPECT_EQ(rig.gyro->descriptor(), -1) << "nothing to wait for";
  EXPECT_EQ(rig.gyro->verify_next().error().code, DriverErrorCode::configuration_lost)
      << "its driver resets the chip when it comes back";
  rig.nodes.read_error = 0;
  ASSERT_EQ(rig.start_message(), "");
  rig.made.send(rig.now, {2, 2, 2});
  EXPECT_EQ(*rig.read(), 1U);
}

TEST(IioGyroOfTheKernel, TellsAttributesThatItMayNotWrite) {
  const testing::Unprivileged user;
  Rig rig;
  rig.made.forbid("sampling_frequency");
  EXPECT_TRUE(contains(rig.start_message(),
                       "/sampling_frequency: Permission denied (is the udev rule of zerorate"));
}

TEST(IioGyroWithoutABuffer, IsReadOnceAPeriodThroughItsAttributes) {
  Rig rig{polled(), 50.0};
  ASSERT_EQ(rig.start_message(), "");
  EXPECT_FALSE(rig.gyro->is_batched());
  EXPECT_EQ(rig.gyro->descriptor(), -1);
  ASSERT_EQ(*rig.read(), 1U);
  EXPECT_EQ(rig.samples[0].time, rig.now);
  for (const auto& rate : rig.samples[0].rate) EXPECT_NEAR(rate.in(core::deg_per_s), 2.0, 1e-4);
  EXPECT_NEAR((rig.samples[0].temperature - core::Temperature::from_degc(25.0F)).in(core::kelvin),
              0.0F, 0.001F);
  rig.now = rig.now + core::Duration::milliseconds(10);
  EXPECT_EQ(*rig.read(), 0U);
  rig.now = rig.now + core::Duration::milliseconds(10);
  EXPECT_EQ(*rig.read(), 1U);
  std::filesystem::remove(rig.made.path() / "sys/iio:device0/in_anglvel_z_raw");
  rig.now = rig.now + core::Duration::milliseconds(20);
  const auto unplugged = rig.read();
  ASSERT_FALSE(unplugged);
  EXPECT_EQ(unplugged.error().bus, hal::BusError::not_present);
  EXPECT_TRUE(contains(rig.gyro->reason(unplugged.error().code).told,
                       "in_anglvel_z_raw: No such file or directory (was the device unplugged"));
}

TEST(IioGyroWithoutABuffer, IsRefusedAtATooHighRate) {
  Rig rig{polled(), 200.0};
  EXPECT_TRUE(
      contains(rig.start_message(), "at most 100 times a second (wire the chip's interrupt"));
  Attributes small = polled();
  small["in_anglvel_z_scale"] = "0.0001";
  Rig narrow{small, 50.0};
  EXPECT_TRUE(contains(narrow.start_message(), "the range is smaller than full_scale_dps"));
}

}  // namespace
}  // namespace zerorate::linux_node
