/// @file
/// The probe on the simulated chips behind the kernel's double.

#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "hal/sim/buses.hpp"
#include "hal/sim/chips.hpp"
#include "hal/sim/clock.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tests/unit/hal/linux/kernel_double.hpp"
#include "host_tools/lib/probe/probe.hpp"

namespace zerorate::probe {
namespace {

using hal::linux_os::KernelDouble;
using hal::linux_os::KernelState;

std::set<std::string> found(const std::vector<Attempt>& attempts) {
  std::set<std::string> names;
  for (const Attempt& attempt : attempts) {
    if (attempt.is_found) names.emplace(attempt.chip);
  }
  return names;
}

/// Questions to all chips with registers, at all their addresses.
std::size_t questions_on_i2c() {
  std::size_t questions = 0;
  drivers::AllChips::for_each([&]<class Chip> {
    if constexpr (drivers::RegisterChipEntry<Chip>) questions += Chip::kAddresses.size();
  });
  return questions;
}

/// One transaction a chip with registers, two a chip of frames or words.
int questions_on_spi() {
  int questions = 0;
  drivers::AllChips::for_each(
      [&]<class Chip> { questions += drivers::RegisterChipEntry<Chip> ? 1 : 2; });
  return questions;
}

/// Answer of the probe on a chip select with this device.
template <class Device>
std::set<std::string> found_on_spi(Device& device) {
  KernelState kernel;
  kernel.spi_device = [&](auto operations) { (void)device.transaction(operations); };
  return found(probe_spi("/dev/spidev0.0", KernelDouble{kernel}));
}

template <class Chip>
std::set<std::string> found_chip_on_spi() {
  hal::sim::SimulatedClock clock{core::Instant::from_ns(0)};
  Chip chip{clock};
  clock.advance(core::Duration::seconds(1));  // until they are powered some read no registers
  hal::sim::SimulatedSpi<Chip> device{chip};
  return found_on_spi(device);
}

TEST(ProbeOfSpi, NamesTheChipAndNoneThatAnswersOtherwise) {
  // ICM-20689s are also sold as MPU-6500s, whose driver takes them.
  const std::vector<std::set<std::string>> alike{{"asm330lhh", "ism330dhcx", "lsm6dsr"},
                                                 {"lsm6dso", "lsm6dsox"},
                                                 {"lsm6ds3tr-c", "lsm6dsl"},
                                                 {"adis16475-1", "adis16475-2", "adis16475-3"},
                                                 {"icm20689", "mpu6500"}};
  hal::sim::AllSimulatedChips::for_each([&]<class Chip> {
    const std::string name{Chip::kName};
    std::set<std::string> expected{name};
    for (const auto& names : alike) {
      if (name != "mpu6500" && names.contains(name)) expected = names;
    }
    EXPECT_EQ(found_chip_on_spi<Chip>(), expected);
  });
}

/// Calls with the first byte of each question to a chip select.
template <class Device>
void probe_and_see(Device& device, const std::function<void(std::uint8_t)>& see) {
  KernelState kernel;
  kernel.spi_device = [&](std::span<const hal::Operation> operations) {
    see(operations[0].bytes()[0]);
    (void)device.transaction(operations);
  };
  (void)probe_spi("/dev/spidev0.0", KernelDouble{kernel});
}

TEST(ProbeOfSpi, WritesToNoChipWithRegistersThatItFinds) {
  hal::sim::AllSimulatedChips::for_each([&]<class Chip> {
    if constexpr (!hal::sim::WordChip<Chip>) {
      hal::sim::SimulatedClock clock{core::Instant::from_ns(0)};
      Chip chip{clock};
      clock.advance(core::Duration::seconds(1));
      hal::sim::SimulatedSpi<Chip> device{chip};
      probe_and_see(device,
                    [&](std::uint8_t first) { EXPECT_NE(first & 0x80U, 0U) << Chip::kName; });
    }
  });
}

TEST(ProbeOfSpi, AsksChipsOfWordsAfterAllOthers) {
  hal::sim::SimulatedClock clock{core::Instant::from_ns(0)};
  hal::sim::SimulatedAdis16470 chip{clock};
  hal::sim::SimulatedWordSpi device{chip};
  bool has_asked_for_words = false;
  probe_and_see(device, [&](std::uint8_t first) {
    const bool is_of_words = first == 0x72;
    EXPECT_TRUE(is_of_words || (!has_asked_for_words && (first & 0x80U) != 0)) << int{first};
    has_asked_for_words |= is_of_words;
  });
  EXPECT_TRUE(has_asked_for_words);
}

TEST(ProbeOfSpi, FindsNothingOnAStuckLine) {
  for (const std::uint8_t level : {std::uint8_t{0x00}, std::uint8_t{0xFF}}) {
    KernelState kernel;
    kernel.spi_device = [&](auto operations) {
      for (const hal::Operation& operation : operations) {
        std::ranges::fill(operation.buffer(), level);
      }
    };
    EXPECT_TRUE(found(probe_spi("/dev/spidev0.0", KernelDouble{kernel})).empty());
  }
}

TEST(ProbeOfI2c, FindsTheChipAndListsSilentAddresses) {
  hal::sim::SimulatedClock clock{core::Instant::from_ns(0)};
  hal::sim::SimulatedIcm42688 chip{clock};
  hal::sim::SimulatedI2cBus<hal::sim::SimulatedIcm42688> bus{chip, hal::I2cAddress{0x69}};
  KernelState kernel;
  kernel.i2c_device = [&](hal::I2cAddress address, auto operations) {
    return bus.transaction(address, operations).has_value();
  };
  const auto attempts = probe_i2c("/dev/i2c-1", KernelDouble{kernel});
  ASSERT_EQ(attempts.size(), questions_on_i2c());
  for (const Attempt& attempt : attempts) {
    const bool is_it = attempt.chip == "icm42688" && attempt.address == 0x69;
    EXPECT_EQ(attempt.is_found, is_it);
    EXPECT_EQ(attempt.answer == "not acknowledged", attempt.address != 0x69);
  }
}

TEST(ProbeOfI2c, WritesNothingButTheAddressOfTheRegister) {
  KernelState kernel;
  kernel.i2c_device = [](hal::I2cAddress, std::span<const hal::Operation> operations) {
    EXPECT_EQ(operations.size(), 2U);
    EXPECT_EQ(operations[0].bytes().size(), 1U);
    EXPECT_TRUE(operations[1].is_read());
    return true;
  };
  EXPECT_TRUE(found(probe_i2c("/dev/i2c-1", KernelDouble{kernel})).empty());
  EXPECT_EQ(kernel.transfers, static_cast<int>(questions_on_i2c()));
}

TEST(ProbeOfSpi, AsksEachChipOnceWhereNoneAnswers) {
  KernelState kernel;
  (void)probe_spi("/dev/spidev0.0", KernelDouble{kernel});
  EXPECT_EQ(kernel.transfers, questions_on_spi());
}

TEST(ProbeOfADeviceThatIsGone, SaysSoForEveryChip) {
  KernelState kernel{.open_error = ENOENT};
  for (const Attempt& attempt : probe_spi("/dev/spidev0.0", KernelDouble{kernel})) {
    EXPECT_FALSE(attempt.is_found);
    EXPECT_EQ(attempt.answer, "not present");
  }
}

TEST(ProbeOfADeviceThatIsForbidden, SaysSoOnceWithTheCure) {
  KernelState kernel{.open_error = EACCES};
  const Bus bus{Bus::Kind::i2c, "/dev/i2c-1", probe_i2c("/dev/i2c-1", KernelDouble{kernel})};
  EXPECT_EQ(to_text({bus}),
            "/dev/i2c-1           Permission denied (is the user in the device's group, i2c or "
            "spi?)\n");
}

TEST(ProbeOfI2cWithoutAnyChip, HasALineForEveryAddress) {
  KernelState kernel;
  kernel.i2c_device = [](hal::I2cAddress, std::span<const hal::Operation>) { return false; };
  const Bus bus{Bus::Kind::i2c, "/dev/i2c-1", probe_i2c("/dev/i2c-1", KernelDouble{kernel})};
  EXPECT_EQ(std::ranges::count(to_text({bus}), '\n'),
            static_cast<std::ptrdiff_t>(questions_on_i2c()));
}

TEST(DevicesOfAFolder, AreTheBusesInOrder) {
  const testing::ScratchFolder folder;
  for (const char* name : {"spidev1.0", "spidev0.1", "i2c-7", "i2c", "spi", "tty0"}) {
    (void)folder.write(name, "");
  }
  const Devices devices = find_devices(folder.path().string());
  EXPECT_EQ(devices.spi, (std::vector<std::string>{(folder.path() / "spidev0.1").string(),
                                                   (folder.path() / "spidev1.0").string()}));
  EXPECT_EQ(devices.i2c, std::vector<std::string>{(folder.path() / "i2c-7").string()});
}

TEST(ResultOfAProbe, IsTheSameAsTextAndAsJson) {
  const std::vector<Bus> buses{
      {Bus::Kind::i2c,
       "/dev/i2c-1",
       {{.chip = "bmi088", .address = 0x68, .is_found = false, .answer = "not acknowledged"},
        {.chip = "lsm6dso", .address = 0x6A, .is_found = true, .answer = "0x6c"}}}};
  EXPECT_EQ(to_text(buses),
            "/dev/i2c-1 at 0x68   bmi088      no    not acknowledged\n"
            "/dev/i2c-1 at 0x6a   lsm6dso     found 0x6c\n");
  const auto json = nlohmann::json::parse(to_json(buses));
  EXPECT_EQ(json["schema"], "zerorate.probe/1");
  EXPECT_EQ(json["buses"][0]["bus"], "i2c");
  EXPECT_EQ(json["buses"][0]["attempts"][1]["address"], 0x6A);
  EXPECT_EQ(json["buses"][0]["attempts"][1]["found"], true);
  EXPECT_EQ(json["buses"][0]["attempts"][0]["answer"], "not acknowledged");
}

TEST(SensorsOfTheKernel, AreToldWithTheLinesThatZerorateNeeds) {
  const testing::ScratchFolder folder;
  const auto device = [&](const std::string& node, const std::string& name,
                          const std::vector<std::string>& channels) {
    std::filesystem::create_directories(folder.path() / node);
    (void)folder.write(node + "/name", name + "\n");
    for (const auto& channel : channels) (void)folder.write(node + "/" + channel, "1\n");
  };
  device("iio:device0", "lsm6dso_accel", {"in_accel_x_raw"});
  device("iio:device1", "lsm6dso_gyro", {"in_anglvel_x_raw"});
  (void)folder.write("iio:device1/sampling_frequency", "104.000\n");
  device("iio:device2", "mpu6050", {"in_anglvel_x_raw", "in_accel_x_raw"});
  device("iio:device3", "ina219", {"in_voltage0_raw"});
  device("iio:device10", "mpu6050", {"in_anglvel_x_raw"});
  const KernelSensors sensors = find_kernel_sensors({.sysfs = folder.path().string()});
  ASSERT_EQ(sensors.gyros.size(), 3U);
  ASSERT_EQ(sensors.accelerometers.size(), 2U);
  EXPECT_EQ(
      to_text({}, {{sensors.gyros[0]}, {sensors.accelerometers[0]}}),
      "iio:device1          lsm6dso_gyro found, by a driver of the kernel. In zerorated.toml:\n"
      "    [gyro]\n    bus = \"iio\"\n    device = \"lsm6dso_gyro\"\n    rate_hz = 104\n"
      "iio:device0          lsm6dso_accel found, an accelerometer. Below a [gyro] of the kernel:\n"
      "    acceleration = true\n    accelerometer_device = \"lsm6dso_accel\"\n");
  EXPECT_EQ(sensors.gyros[1].device, "iio:device2");
  EXPECT_EQ(sensors.gyros[2].device, "iio:device10");
  EXPECT_EQ(sensors.accelerometers[1].device, "mpu6050");
  const auto json = nlohmann::json::parse(to_json({}, sensors));
  EXPECT_EQ(json["kernel"][0]["rate_hz"], 104.0);
  EXPECT_EQ(json["kernel_accelerometers"][0]["device"], "lsm6dso_accel");
}

}  // namespace
}  // namespace zerorate::probe
