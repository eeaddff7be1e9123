#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "host_tests/emulated/linux/guest/bench.hpp"
#include "host_tests/emulated/linux/guest/scenarios.hpp"

namespace zerorate::emulated {
namespace {

/// A chip as one of the two drivers reads it.
struct Reading {
  GyroSetup setup;
  double rate_hz = 100.0;
};

/// A chip, once read by our driver and once through IIO by the kernel's.
struct Wiring {
  const char* name;
  Reading ours;
  Reading kernels;
  double stamps_ms;             ///< largest difference of a sample's two stamps
  bool writes_blindly = false;  ///< the kernel's driver, to registers that the chip does not have
};

/// 1.01 ms was seen while the vehicle drove; whether the played chip or the driver was late is not
/// known.
constexpr double kStampsWithBuffer_ms = 2.0;

using Make = std::unique_ptr<PlayedChip> (*)();

/// Lines of `[gyro]`, but for bus and device.
std::string lines(const std::string& chip, int rate_hz, int full_scale_dps) {
  return "chip = \"" + chip + "\"\nrate_hz = " + std::to_string(rate_hz) +
         "\nfull_scale_dps = " + std::to_string(full_scale_dps) + "\n";
}

/// A chip of three axes with an interrupt line, which our driver reads.
Reading on_spi_by_ours(Make make, const std::string& chip, int rate_hz, int full_scale_dps = 250) {
  return {.setup = {.make = make,
                    .toml = lines(chip, rate_hz, full_scale_dps) +
                            "bus = \"spi\"\ndevice = \"/dev/spidev0.0\"\n",
                    .lsb_dps = 250.0F / 32768.0F,
                    .sample_ns = std::llround(1e9 / rate_hz),
                    .binding = "spi dh2228fv"},  // for spidev
          .rate_hz = static_cast<double>(rate_hz)};
}
Reading on_i2c_by_ours(Make make, const std::string& chip, int rate_hz, int full_scale_dps = 250) {
  Reading ours = on_spi_by_ours(make, chip, rate_hz);
  ours.setup.toml =
      lines(chip, rate_hz, full_scale_dps) + "bus = \"i2c\"\ndevice = \"/dev/i2c-7\"\n";
  ours.setup.binding = "none";
  return ours;
}

/// @param iio_lines `[gyro]`, but for the bus
/// @param binding the chip as the test bus shows it to the kernel's driver
Wiring wiring(const char* name, const Reading& ours, const std::string& iio_lines,
              const char* binding) {
  Wiring both{name, ours, ours, kStampsWithBuffer_ms};
  both.kernels.setup.has_data_ready = false;  // the kernel's driver has the line
  both.kernels.setup.toml = "bus = \"iio\"\n" + iio_lines;
  both.kernels.setup.binding = binding;
  return both;
}

/// A chip whose two readings differ in nothing but the driver.
struct Row {
  const char* name;
  Make make;
  const char* chip;  ///< in a configuration
  int rate_hz;
  float lsb_dps;
  const char* iio;      ///< name that the kernel's driver gives it
  const char* binding;  ///< see GyroSetup
  int full_scale_dps = 250;
};

constexpr float kLsb16BitDps = 250.0F / 32768.0F;

constexpr std::array kRows{
    Row{"st_lsm6dsx over SPI", on_spi<hal::sim::SimulatedLsm6dso>, "lsm6dso", 104, kLsbDps,
        "lsm6dso_gyro", "spi lsm6dso 0 0"},
    Row{"st_lsm6dsx over I2C", on_i2c<hal::sim::SimulatedLsm6dso, 0x6A>, "lsm6dso", 104, kLsbDps,
        "lsm6dso_gyro", "i2c lsm6dso 6a 0"},
    Row{"inv_mpu6050 over SPI", on_spi<hal::sim::SimulatedMpu6500>, "mpu6500", 100, kLsb16BitDps,
        "mpu6500", "spi mpu6500 0 0"},
    Row{"inv_mpu6050 over I2C", on_i2c<hal::sim::SimulatedMpu6500, 0x68>, "mpu6500", 100,
        kLsb16BitDps, "mpu6500", "i2c mpu6500 68 0"},
};

/// Relatives that Linux 6.1 knows too.
constexpr std::array kRelatives{
    Row{"st_lsm6dsx, ISM330DHCX over SPI", on_spi<hal::sim::SimulatedIsm330dhcx>, "ism330dhcx", 104,
        kLsbDps, "ism330dhcx_gyro", "spi ism330dhcx 0 0"},
    Row{"st_lsm6dsx, ASM330LHH over I2C", on_i2c<hal::sim::SimulatedAsm330lhh, 0x6A>, "asm330lhh",
        104, kLsbDps, "asm330lhh_gyro", "i2c asm330lhh 6a 0"},
    Row{"inv_mpu6050, MPU-6050 over I2C", on_i2c<hal::sim::SimulatedMpu6050, 0x68>, "mpu6500", 100,
        kLsb16BitDps, "mpu6050", "i2c mpu6050 68 0"},
    Row{"inv_mpu6050, MPU-9250 over SPI", on_spi<hal::sim::SimulatedMpu9250>, "mpu6500", 100,
        kLsb16BitDps, "mpu9250", "spi mpu9250 0 0"},
    Row{"inv_mpu6050, ICM-20602 over SPI", on_spi<hal::sim::SimulatedIcm20602>, "icm20602", 100,
        kLsb16BitDps, "icm20602", "spi icm20602 0 0"},
    Row{"inv_mpu6050, ICM-20689 over I2C", on_i2c<hal::sim::SimulatedIcm20689, 0x68>, "icm20689",
        100, kLsb16BitDps, "icm20689", "i2c icm20689 68 0"},
    Row{"st_lsm6dsx, LSM6DSR over SPI", on_spi<hal::sim::SimulatedLsm6dsr>, "lsm6dsr", 104, kLsbDps,
        "lsm6dsr_gyro", "spi lsm6dsr 0 0"},
    Row{"st_lsm6dsx, LSM6DSOX over I2C", on_i2c<hal::sim::SimulatedLsm6dsox, 0x6A>, "lsm6dsox", 104,
        kLsbDps, "lsm6dsox_gyro", "i2c lsm6dsox 6a 0"},
    Row{"st_lsm6dsx, LSM6DSL over I2C", on_i2c<hal::sim::SimulatedLsm6dsl, 0x6A>, "lsm6dsl", 104,
        kLsbDps, "lsm6dsl_gyro", "i2c lsm6dsl 6a 0"},
    Row{"st_lsm6dsx, LSM6DS3TR-C over SPI", on_spi<hal::sim::SimulatedLsm6ds3trC>, "lsm6ds3tr-c",
        104, kLsbDps, "lsm6ds3tr-c_gyro", "spi lsm6ds3tr-c 0 0"},
    Row{"bmi160 over SPI", on_spi<hal::sim::SimulatedBmi160>, "bmi160", 100, kLsb16BitDps, "bmi160",
        "spi bosch,bmi160 0 0"},
    Row{"bmi160 over I2C", on_i2c<hal::sim::SimulatedBmi160, 0x68>, "bmi160", 100, kLsb16BitDps,
        "bmi160", "i2c bosch,bmi160 68 0"},
    Row{"st_gyro, L3GD20H over SPI", on_spi<hal::sim::SimulatedL3gd20h>, "l3gd20h", 100, kLsbDps,
        "l3gd20h", "spi l3gd20h 0 0"},
    Row{"st_gyro, L3GD20 over SPI", on_spi<hal::sim::SimulatedL3gd20>, "l3gd20", 95, kLsbDps,
        "l3gd20", "spi l3gd20 0 0"},
    Row{"st_gyro, L3G4200D over I2C", on_i2c<hal::sim::SimulatedL3g4200d, 0x68>, "l3g4200d", 100,
        kLsbDps, "l3g4200d", "i2c l3g4200d 68 0"},
    Row{"adis16475, ADIS16470", on_words<hal::sim::SimulatedAdis16470>, "adis16470", 100,
        1.0F / 10.0F, "adis16470", "spi adi,adis16470 0 0", 2000},
    Row{"adis16475, ADIS16475-1", on_words<hal::sim::SimulatedAdis16475Part1>, "adis16475-1", 100,
        1.0F / 160.0F, "adis16475-1", "spi adi,adis16475-1 0 0", 125},
    Row{"adis16475, ADIS16475-2", on_words<hal::sim::SimulatedAdis16475Part2>, "adis16475-2", 100,
        1.0F / 40.0F, "adis16475-2", "spi adi,adis16475-2 0 0", 500},
    Row{"adis16475, ADIS16475-3", on_words<hal::sim::SimulatedAdis16475Part3>, "adis16475-3", 100,
        1.0F / 10.0F, "adis16475-3", "spi adi,adis16475-3 0 0", 2000},
};

Wiring wiring_of(const Row& row) {
  const bool is_spi = std::string_view{row.binding}.starts_with("spi");
  Reading ours = (is_spi ? on_spi_by_ours : on_i2c_by_ours)(row.make, row.chip, row.rate_hz,
                                                            row.full_scale_dps);
  ours.setup.lsb_dps = row.lsb_dps;
  return wiring(row.name, ours,
                "device = \"" + std::string{row.iio} + "\"\n" +
                    lines(row.chip, row.rate_hz, row.full_scale_dps),
                row.binding);
}

/// The chip converts when it is asked: our driver asks 200 times a second, the kernel's 100 times.
Wiring wiring_of_adxrs450() {
  Reading ours = on_spi_by_ours(on_frames<hal::sim::SimulatedAdxrs453>, "adxrs453", 200);
  ours.setup.toml = lines("adxrs453", 200, 300) + "bus = \"spi\"\ndevice = \"/dev/spidev0.0\"\n";
  ours.setup.has_data_ready = false;
  ours.setup.axes = 1;
  ours.setup.lsb_dps = 1.0F / 80.0F;
  Wiring both = wiring("adxrs450, without a buffer", ours,
                       "device = \"adxrs450\"\n" + lines("adxrs453", 100, 300), "spi adxrs453");
  both.kernels.rate_hz = 100.0;
  both.stamps_ms = 5.0;  // half of the 10 ms between two polls
  both.writes_blindly = true;
  return both;
}

/// Linux 6.1 knows no ICM-42688, but an older sister, by the device tree.
std::vector<Wiring> wirings_of_icm42688() {
  const std::string iio = "device = \"icm42605-gyro\"\n" + lines("icm42688", 100, 250);
  const Reading ours_spi = on_spi_by_ours(on_spi<hal::sim::SimulatedIcm42688>, "icm42688", 100);
  const Reading ours_i2c =
      on_i2c_by_ours(on_i2c<hal::sim::SimulatedIcm42688, 0x68>, "icm42688", 100);
  Wiring spi = wiring("inv_icm42600 over SPI", ours_spi, iio, "spi invensense,icm42605 0 0");
  Wiring i2c = wiring("inv_icm42600 over I2C", ours_i2c, iio, "i2c invensense,icm42605 68 0");
  spi.kernels.setup.make = on_spi<hal::sim::SimulatedIcm42605>;
  i2c.kernels.setup.make = on_i2c<hal::sim::SimulatedIcm42605, 0x68>;
  return {spi, i2c};
}

std::vector<Wiring> wirings() {
  std::vector<Wiring> all;
  std::ranges::transform(kRows, std::back_inserter(all), wiring_of);
  all.push_back(wiring_of_adxrs450());
  Wiring bosch =
      wiring("bmg160", on_spi_by_ours(on_spi<hal::sim::SimulatedBmi088>, "bmi088", 100),
             "device = \"bmi088_gyro\"\n" + lines("bmi088", 100, 250), "spi bmi088_gyro 0 0");
  bosch.writes_blindly = true;
  all.push_back(bosch);
  std::ranges::move(wirings_of_icm42688(), std::back_inserter(all));
  return all;
}

double in_lsb(core::AngularRate difference, float lsb_dps) {
  return std::abs(double{difference.in(core::deg_per_s)} / double{lsb_dps});
}

/// Messages of a drive with a calibrated rate, in the drive's own time.
struct Drive {
  std::vector<app::RateMessage> messages;
  core::Instant start;

  [[nodiscard]] core::Duration time(const app::RateMessage& message) const {
    return message.time - start;
  }
};

bool is_same_sample(const app::RateMessage& a, const app::RateMessage& b, float lsb_dps) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (in_lsb(a.axes.at(i).measured - b.axes.at(i).measured, lsb_dps) > 0.5) return false;
  }
  return true;
}

struct Comparison {
  long samples = 0;
  long alone = 0;  ///< samples of the kernel's driver alone
  double largest_lsb = 0.0;
  double largest_ms = 0.0;
  double largest_degc = 0.0;  ///< where both tell a temperature
};

/// Compares the corrected rates of equal samples, which stand at equal times of both drives.
Comparison compare(const Drive& ours, const Drive& kernels, float lsb_dps) {
  constexpr core::Duration kWindow = core::Duration::milliseconds(12);
  Comparison found;
  for (const app::RateMessage& theirs : kernels.messages) {
    const core::Duration at = kernels.time(theirs);
    const auto is_before = [&](const app::RateMessage& our, core::Duration time) {
      return ours.time(our) < time;
    };
    const auto begin =
        std::lower_bound(ours.messages.begin(), ours.messages.end(), at - kWindow, is_before);
    const auto end = std::lower_bound(begin, ours.messages.end(), at + kWindow, is_before);
    auto same = end;
    double same_ms = 0.0;
    for (auto our = begin; our != end; ++our) {
      const double ms = std::abs(static_cast<double>((ours.time(*our) - at).ns())) / 1e6;
      if (!is_same_sample(*our, theirs, lsb_dps) || (same != end && ms >= same_ms)) continue;
      same = our;
      same_ms = ms;
    }
    if (same == end) {
      ++found.alone;
      continue;
    }
    ++found.samples;
    found.largest_ms = std::max(found.largest_ms, same_ms);
    if (same->temperature && theirs.temperature) {
      const double degc = same->temperature->degc() - theirs.temperature->degc();
      found.largest_degc = std::max(found.largest_degc, std::abs(degc));
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const auto difference = same->axes.at(i).corrected - theirs.axes.at(i).corrected;
      found.largest_lsb = std::max(found.largest_lsb, in_lsb(difference, lsb_dps));
    }
  }
  return found;
}

Drive drive(DeviceWorld& world, Verdict& verdict, const std::string& name, const Reading& reading,
            double seconds) {
  constexpr double kStart_s = 1.0;
  (void)unlink("/run/state/state");
  Bench bench{world, verdict, name.c_str(), reading.setup};
  bench.schedule->run(kStart_s);
  const Tally before = bench.tally();
  bench.schedule->run(seconds - kStart_s);
  const Tally& tally = bench.tally();
  const long samples = tally.with_rate - before.with_rate;
  const double expected = (seconds - kStart_s) * reading.rate_hz;
  verdict.check("samples come at the chip's rate",
                std::abs(static_cast<double>(samples) - expected) < 3.0, samples);
  verdict.check("no message is lost, and nothing is faulty",
                tally.number_gaps == 0 && tally.faulty == before.faulty,
                tally.number_gaps + tally.faulty - before.faulty);
  verdict.check("corrected rate within one LSB of the node beside it",
                tally.largest_difference_lsb <= 1.0, tally.largest_difference_lsb);
  verdict.check("stops are seen", tally.still > 0, tally.still);
  Drive driven{.messages = {}, .start = bench.schedule->start()};
  for (const auto& numbered : bench.witness->published()) {
    const app::RateMessage& message = numbered.message;
    if (message.has_rate() && message.health.calibrated) driven.messages.push_back(message);
  }
  return driven;
}

void compare_drivers(DeviceWorld& world, Verdict& verdict, const Wiring& wiring, double seconds,
                     bool is_host_quiet) {
  const std::string name = wiring.name;
  const Drive ours = drive(world, verdict, name + ": our driver", wiring.ours, seconds);
  const Drive kernels = drive(world, verdict, name + ": the kernel's", wiring.kernels, seconds);
  verdict.check("and wrote to nothing that the chip does not have",
                wiring.writes_blindly || world.reserved_writes() == 0, world.reserved_writes());
  const Comparison found = compare(ours, kernels, wiring.ours.setup.lsb_dps);
  // Where both poll, one of them can miss a sample that the other has, and does so more often where
  // the host delays the polls. A driver that reads other numbers has nearly all samples alone.
  const long polled_alone = found.samples / (is_host_quiet ? 20 : 4);
  const long most_alone = wiring.ours.setup.has_data_ready ? 0 : polled_alone;
  verdict.check("their samples are equal", found.alone <= most_alone, found.alone);
  if (is_host_quiet) {
    verdict.check("and their stamps [ms]", found.largest_ms <= wiring.stamps_ms, found.largest_ms);
  }
  verdict.check("and their temperatures [degC]", found.largest_degc <= 0.5, found.largest_degc);
  verdict.check("corrected rates of both drivers are within one LSB",
                found.samples > 0 && found.largest_lsb <= 1.0, found.largest_lsb);
}

/// Lines of `zerorate probe` as the whole configuration of the gyro, at the rate that the
/// driver starts with.
void take_lines_of_probe(DeviceWorld& world, Verdict& verdict) {
  constexpr std::int64_t kSample12_5Hz_ns = 80'000'000;
  Bench bench{world,
              verdict,
              "the lines that zerorate probe prints",
              {.toml = "",
               .has_data_ready = false,
               .sample_ns = kSample12_5Hz_ns,
               .binding = "spi lsm6dso 0 0"}};
  bench.schedule->run(6.0);
  const Tally& tally = bench.tally();
  verdict.check("zerorated runs with them", tally.with_rate >= 60, tally.with_rate);
  verdict.check("and every sample is the one that was next",
                tally.out_of_order == 0 && tally.faulty == 0, tally.out_of_order + tally.faulty);
}

void write_to(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out{file};
  if (!(out << text << std::flush)) give_up(file.c_str());
}

/// The device that the test bus shows.
std::filesystem::path shown_device() {
  const std::filesystem::path spi = "/sys/bus/spi/devices/spi0.0";
  for (const auto& i2c : std::filesystem::directory_iterator{"/sys/bus/i2c/devices"}) {
    if (i2c.path().filename().string().starts_with("7-")) return i2c.path();
  }
  return spi;
}

/// The driver of the kernel goes while zerorated reads through it, and comes back.
void unbind(DeviceWorld& world, Verdict& verdict, const Wiring& wiring) {
  const std::string name = std::string{wiring.name} + ": unbound and bound again";
  Bench bench{world, verdict, name.c_str(), wiring.kernels.setup};
  bench.schedule->run(2.0);
  const std::filesystem::path device = shown_device();
  const std::filesystem::path driver = std::filesystem::canonical(device / "driver");
  write_to(driver / "unbind", device.filename());
  check_silence(bench);
  verdict.check("the log tells place, reason and cure",
                DaemonProcess::has_logged("/sys/bus/iio/devices: no gyro is called ") &&
                    DaemonProcess::has_logged("is the driver's module loaded and bound?"),
                0);
  write_to(driver / "bind", device.filename());
  check_recovery(bench, 3.0, 95);
}

}  // namespace

void compare_kernel_drivers(DeviceWorld& world, Verdict& verdict, double seconds, bool is_whole) {
  take_lines_of_probe(world, verdict);
  for (const Wiring& wiring : wirings()) {
    compare_drivers(world, verdict, wiring, seconds, is_whole);
  }
  if (is_whole) compare_kernel_drivers_of_relatives(world, verdict, seconds / 3.0);
  for (const Wiring& wiring : wirings()) unbind(world, verdict, wiring);
}

void compare_kernel_drivers_of_relatives(DeviceWorld& world, Verdict& verdict, double seconds) {
  for (const Row& relative : kRelatives) {
    compare_drivers(world, verdict, wiring_of(relative), seconds, true);
  }
}

}  // namespace zerorate::emulated
