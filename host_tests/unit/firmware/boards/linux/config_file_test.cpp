/// @file
/// The file of the maker's that a chip needs at each start.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "firmware/boards/linux/chips/gyro.hpp"
#include "firmware/boards/linux/configuration.hpp"
#include "firmware/toml/error.hpp"
#include "hal/linux/sysfs.hpp"
#include "host_tests/support/folders.hpp"

namespace zerorate::linux_node {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string gyro_table(const std::string& chip, const std::string& more) {
  return "schema = \"zerorate.daemon/1\"\n[gyro]\nchip = \"" + chip +
         "\"\nbus = \"i2c\"\ndevice = \"/dev/i2c-1\"\nrate_hz = 100\nfull_scale_dps = 250\n" + more;
}

std::string mistakes_of(const std::string& toml) {
  try {
    (void)parse_configuration(toml, "z.toml");
  } catch (const toml_file::Error& error) {
    return error.what();
  }
  return "no error";
}

GyroSettings bmi270_with(const std::string& config_file) {
  return {.chip = "bmi270",
          .bus = BusKind::spi,
          .device = "/dev/there-is-no-such-device",
          .rate_hz = 100.0,
          .full_scale_dps = 250.0,
          .config_file = config_file};
}

std::string refusal_of_file(const std::string& config_file) {
  try {
    (void)find_chip("bmi270")->make(bmi270_with(config_file));
  } catch (const hal::linux_os::KernelFileError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ConfigFile, IsAskedForWhereTheChipNeedsIt) {
  EXPECT_THAT(mistakes_of(gyro_table("bmi270", "")),
              HasSubstr("z.toml:2:1: missing \"config_file\" in [gyro]; expected the path of the "
                        "maker's file for this chip, which it needs at each start"));
  EXPECT_THAT(mistakes_of(gyro_table("bmi270", "config_file = \"/f\"\n")),
              Not(HasSubstr("config_file")));
  EXPECT_THAT(mistakes_of(gyro_table("bmi160", "config_file = \"/f\"\n")),
              HasSubstr("unknown key \"config_file\" in [gyro]"));
}

TEST(ConfigFile, ThatCannotBeReadIsToldWithItsName) {
  EXPECT_THAT(refusal_of_file("/there/is/none"), HasSubstr("/there/is/none"));
  EXPECT_THAT(refusal_of_file("/there/is/none"), HasSubstr("config_file of [gyro]"));
}

TEST(ConfigFile, OfAnImpossibleSizeIsRefused) {
  const zerorate::testing::ScratchFolder folder;
  for (const int bytes : {0, 599, 8194}) {
    const std::string text(static_cast<std::size_t>(bytes), 'x');
    EXPECT_THAT(refusal_of_file(folder.write("file", text)),
                HasSubstr(std::to_string(bytes) + " bytes cannot be the file of this chip"));
  }
  EXPECT_EQ(refusal_of_file(folder.write("file", std::string(8192, 'x'))), "no error");
}

TEST(ConfigFile, IsNamedWhereADriverLacksIt) {
  const auto gyro = find_chip("bmi270")->make(bmi270_with(""));
  const auto started = gyro->start(core::Instant{});
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().code, drivers::DriverErrorCode::no_config_file);
  EXPECT_THAT(gyro->reason(started.error().code).told, HasSubstr("config_file of [gyro]"));
  EXPECT_THAT(gyro->reason(drivers::DriverErrorCode::sensor_fault).told,
              HasSubstr("did not take config_file"));
}

}  // namespace
}  // namespace zerorate::linux_node
