/// @file
/// Reading of the accelerometer as a configuration asks for it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/simulated_vehicle.hpp"
#include "firmware/toml/error.hpp"
#include "host_tests/unit/firmware/boards/linux/simulated_hardware.hpp"

namespace zerorate::linux_node {
namespace {

using ::testing::HasSubstr;

/// The minimal file with more lines in [gyro].
std::string gyro_with(const std::string& lines) {
  std::string toml = kMinimalConfiguration;
  return toml.insert(toml.find("[odometer]"), lines);
}

std::string mistake_in(const std::string& toml) {
  try {
    (void)parse_configuration(toml, "z.toml");
  } catch (const toml_file::Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ConfigurationOfAcceleration, TakesTheUsualOrTheGivenRange) {
  const auto range_of = [](const std::string& lines) {
    return parse_configuration(gyro_with(lines), "z.toml").gyro.acceleration_range_g;
  };
  EXPECT_FALSE(range_of(""));
  EXPECT_FALSE(range_of("acceleration = false\n"));
  EXPECT_EQ(range_of("acceleration = true\n"), 4.0);
  EXPECT_EQ(range_of("acceleration = true\nacceleration_range_g = 16\n"), 16.0);
}

TEST(ConfigurationOfAcceleration, IsRefusedWithReasonAndCure) {
  struct Mistake {
    std::string toml;
    std::string message;
  };
  const std::string schema = "schema = \"zerorate.daemon/1\"\n[gyro]\n";
  const std::vector<Mistake> mistakes{
      {gyro_with("acceleration = 1\n"),
       "z.toml:8:16: \"acceleration\" in [gyro]: expected true or false"},
      {gyro_with("acceleration = true\nacceleration_range_g = 3\n"),
       "z.toml:9:24: \"acceleration_range_g\" in [gyro]: the chip offers 2, 4, 8, 16"},
      {gyro_with("acceleration_range_g = 4\n"),
       "z.toml:8:24: \"acceleration_range_g\" in [gyro]: stands only beside acceleration = true"},
      {schema + "chip = \"adxrs453\"\nacceleration = true\n",
       "z.toml:4:16: \"acceleration\" in [gyro]: no accelerometer of the chip is read; leave the "
       "key out, or set it to false"},
      {schema + "bus = \"iio\"\nacceleration = true\n",
       "missing \"accelerometer_device\" in [gyro]"},
      {schema + "bus = \"iio\"\nacceleration_range_g = 4\n",
       "z.toml:4:24: \"acceleration_range_g\" in [gyro]: stands only beside acceleration = true"},
  };
  for (const Mistake& mistake : mistakes) {
    EXPECT_THAT(mistake_in(mistake.toml), HasSubstr(mistake.message));
  }
}

constexpr const char* kTwoDies =
    "schema = \"zerorate.daemon/1\"\n[gyro]\nchip = \"bmi088\"\nrate_hz = 100\nfull_scale_dps = "
    "250\n"
    "acceleration = true\n";
constexpr const char* kSomeOdometer = "[odometer]\nchip = \"/dev/gpiochip0\"\nline = 24\n";

TEST(ConfigurationOfTwoDies, NamesTheSecondOnItsBus) {
  const auto read = [](const std::string& lines) {
    return parse_configuration(kTwoDies + lines + kSomeOdometer, "z.toml").gyro;
  };
  const GyroSettings on_i2c = read("bus = \"i2c\"\ndevice = \"/dev/i2c-1\"\n");
  EXPECT_EQ(on_i2c.accelerometer_address, 0x18);
  EXPECT_EQ(on_i2c.acceleration_range_g, 6.0);
  EXPECT_NE(find_chip("bmi088")->make(on_i2c), nullptr);
  const GyroSettings on_spi = read(
      "bus = \"spi\"\ndevice = \"/dev/spidev0.1\"\naccelerometer_device = \"/dev/spidev0.0\"\n");
  EXPECT_EQ(on_spi.accelerometer_device, "/dev/spidev0.0");
  EXPECT_NE(find_chip("bmi088")->make(on_spi), nullptr);
}

TEST(ConfigurationOfTwoDies, IsRefusedWithoutTheSecond) {
  const auto mistake = [](const std::string& lines) {
    return mistake_in(kTwoDies + lines + kSomeOdometer);
  };
  EXPECT_THAT(mistake("bus = \"spi\"\ndevice = \"/dev/spidev0.1\"\n"),
              HasSubstr("z.toml:2:1: missing \"accelerometer_device\" in [gyro]"));
  EXPECT_THAT(
      mistake("bus = \"i2c\"\ndevice = \"/dev/i2c-1\"\naccelerometer_address = 0x68\n"),
      HasSubstr("z.toml:9:25: \"accelerometer_address\" in [gyro]: it answers at 0x18, 0x19"));
  EXPECT_THAT(mistake_in(gyro_with("accelerometer_address = 0x18\n")),
              HasSubstr("z.toml:8:1: unknown key \"accelerometer_address\""));
}

TEST(ChipsWithAcceleration, AreMadeInEveryRange) {
  std::size_t count = 0;
  for (const ChipDescription& chip : chips()) {
    for (const double range_g : chip.acceleration_ranges_g) {
      const GyroSettings settings{.chip = std::string(chip.name),
                                  .bus = BusKind::spi,
                                  .device = "/dev/there-is-no-such-device",
                                  .rate_hz = chip.rates_hz.back(),
                                  .full_scale_dps = chip.full_scales_dps.front(),
                                  .acceleration_range_g = range_g};
      EXPECT_NE(chip.make(settings), nullptr) << chip.name;
      ++count;
    }
  }
  EXPECT_GE(count, 28U);
}

/// Samples of half a second of the simulated vehicle.
std::vector<drivers::GyroSample> samples_of_vehicle(const std::string& lines) {
  SimulatedVehicle vehicle{parse_configuration(
      "schema = \"zerorate.daemon/1\"\n[gyro]\nchip = \"simulated\"\n" + lines, "z.toml")};
  std::vector<drivers::GyroSample> samples;
  (void)vehicle.gyro().start(vehicle.now());
  while (samples.size() < 50) {
    vehicle.wait();
    std::array<drivers::GyroSample, 4> out{};
    const auto count = vehicle.gyro().read(vehicle.now(), out);
    if (!count) (void)vehicle.gyro().start(vehicle.now());
    samples.insert(samples.end(), out.begin(), out.begin() + count.value_or(0));
  }
  return samples;
}

TEST(SimulatedVehicleWithAcceleration, MeasuresGravityAlongZ) {
  for (const auto& sample : samples_of_vehicle("acceleration = true\n")) {
    ASSERT_TRUE(sample.has_acceleration);
    // Six standard deviations of 1 mg.
    EXPECT_NEAR(sample.acceleration[2].in(core::standard_gravity), 1.0F, 6e-3F);
    EXPECT_NEAR(sample.acceleration[0].in(core::standard_gravity), 0.0F, 6e-3F);
  }
  for (const auto& sample : samples_of_vehicle("")) EXPECT_FALSE(sample.has_acceleration);
}

}  // namespace
}  // namespace zerorate::linux_node
