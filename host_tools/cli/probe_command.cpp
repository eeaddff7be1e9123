#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <vector>

#include "host_tools/cli/commands.hpp"
#include "host_tools/lib/probe/probe.hpp"

namespace zerorate::cli {
namespace {

struct ProbeFlags {
  probe::Devices devices;
  bool json = false;
};

ExitCode run_probe(const ProbeFlags& flags) {
  const bool is_told = !flags.devices.spi.empty() || !flags.devices.i2c.empty();
  const auto buses = probe::probe_buses(is_told ? flags.devices : probe::find_devices("/dev"));
  const auto kernel = is_told ? probe::KernelSensors{} : probe::find_kernel_sensors({});
  fmt::print("{}", flags.json ? probe::to_json(buses, kernel) : probe::to_text(buses, kernel));
  if (buses.empty() && kernel.gyros.empty()) {
    fmt::print(stderr, "zerorate: no /dev/spidev*, no /dev/i2c-*, and no gyro of the kernel\n");
  }
  const bool is_found = std::ranges::any_of(buses, [](const probe::Bus& bus) {
    return std::ranges::any_of(bus.attempts, &probe::Attempt::is_found);
  });
  return is_found || !kernel.gyros.empty() ? success : finding;
}

}  // namespace

Command add_probe(CLI::App& app) {
  const auto flags = std::make_shared<ProbeFlags>();
  auto* command = app.add_subcommand(
      "probe",
      "Find the gyros on this board's SPI and I2C buses, and those that the kernel reads (IIO)");
  command->add_option("--spi", flags->devices.spi, "a spidev device; default all of /dev");
  command->add_option("--i2c", flags->devices.i2c, "an i2c-dev device; default all of /dev");
  command->add_flag("--json", flags->json, "print JSON");
  command->footer(
      "Examples:\n"
      "  zerorate probe\n"
      "  zerorate probe --spi /dev/spidev0.0 --i2c /dev/i2c-1 --json\n"
      "Reads identity registers and changes none. Lists every place where it looked, with what\n"
      "came back; exit code 1 where no gyro answers. Stop zerorated first: a chip that answers\n"
      "one question with the next (adxrs453) would answer the wrong one. Where no other chip is\n"
      "found on SPI, ADIS16470 and ADIS16475 are asked; a chip with 8-bit registers that is not\n"
      "in the table would take that for a write of 0 to register 72h.");
  return {command, [flags] { return run_probe(*flags); }};
}

}  // namespace zerorate::cli
