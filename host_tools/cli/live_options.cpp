#include "host_tools/cli/live_options.hpp"

#include <fmt/format.h>
#include <sys/signalfd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdio>
#include <stdexcept>

namespace zerorate::cli {

Endpoint parse_endpoint(const std::string& option, const std::string& where, unsigned least_port) {
  const std::size_t colon = where.rfind(':');
  const bool has_address = colon != std::string::npos;
  const std::string port = has_address ? where.substr(colon + 1) : where;
  const bool is_number =
      !port.empty() && port.size() <= 5 && std::ranges::all_of(port, [](unsigned char character) {
        return std::isdigit(character) != 0;
      });
  const unsigned long number = is_number ? std::stoul(port) : 65536;
  if (number < least_port || number > 65535) {
    throw std::invalid_argument(
        fmt::format("{}: \"{}\" does not end in a port, {} to 65535", option, where, least_port));
  }
  Endpoint endpoint{.port = static_cast<std::uint16_t>(number)};
  if (!has_address) return endpoint;
  endpoint.address = where.substr(0, colon);
  if (endpoint.address.starts_with('[') && endpoint.address.ends_with(']')) {
    endpoint.address = endpoint.address.substr(1, endpoint.address.size() - 2);
  }
  return endpoint;
}

void add_live_options(CLI::App& command, LiveOptions& options) {
  auto* udp = command.add_option("--udp", options.udp, "receive datagrams, [ADDRESS:]PORT")
                  ->capture_default_str();
  auto* local =
      command.add_option("--unix", options.unix_path, "receive on a Unix datagram socket");
  auto* serial = command.add_option("--serial", options.serial, "read a Pico's serial line");
  command.add_option("--baud", options.baud, "speed of the serial line")
      ->capture_default_str()
      ->needs(serial);
  auto* json = command.add_option("--json", options.json, "read JSON lines; - for standard input");
  udp->excludes(local)->excludes(serial)->excludes(json);
  local->excludes(serial)->excludes(json);
  serial->excludes(json);
}

void add_chip_options(CLI::App& command, ChipOptions& chip) {
  auto* configuration = command.add_option(
      "--config", chip.configuration,
      "read the chip itself with this configuration of zerorated; stop zerorated first");
  auto* name = command
                   .add_option("--chip", chip.chip,
                               "read this chip itself, without an odometer; simulated: one that is "
                               "not there")
                   ->excludes(configuration);
  auto* spi = command.add_option("--spi", chip.spi, "the chip's spidev device")->needs(name);
  command.add_option("--i2c", chip.i2c, "the chip's i2c-dev device")->needs(name)->excludes(spi);
  command.add_option("--address", chip.address, "the chip's I2C address; its first unless given")
      ->needs(name)
      ->check(CLI::Number | CLI::IsMember({"0x68", "0x69", "0x6a", "0x6b"}));
  command.add_option("--rate", chip.rate_hz, "the chip's output data rate in Hz")
      ->needs(name)
      ->check(CLI::PositiveNumber);
  command.add_option("--full-scale", chip.full_scale_dps, "the chip's range in deg/s")
      ->needs(name)
      ->check(CLI::PositiveNumber);
  for (const char* direct : {"--config", "--chip"}) {
    for (const char* node : {"--udp", "--unix", "--serial", "--json"}) {
      command.get_option(direct)->excludes(command.get_option(node));
    }
  }
}

std::unique_ptr<live::Source> open_source(const LiveOptions& options) {
  if (!options.serial.empty()) return live::open_serial(options.serial, options.baud);
  if (!options.unix_path.empty()) return live::listen_unix(options.unix_path);
  if (!options.json.empty()) return live::open_json_lines(options.json);
  const Endpoint endpoint = parse_endpoint("--udp", options.udp, 1);
  return live::listen_udp(endpoint.address, endpoint.port);
}

hal::linux_os::Descriptor open_end_signals() {
  sigset_t signals{};
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  sigprocmask(SIG_BLOCK, &signals, nullptr);
  return hal::linux_os::checked_descriptor(signalfd(-1, &signals, SFD_CLOEXEC), "signalfd");
}

void SilenceNotice::tell(std::uint64_t messages, std::chrono::milliseconds silence) {
  constexpr std::chrono::milliseconds kPatience{2000};
  if (messages > 0 || silence < kPatience || is_told_) return;
  is_told_ = true;
  fmt::print(stderr,
             "zerorate: no message on {} yet; does zerorated run, and has it a sink there? "
             "journalctl -u zerorated\n",
             source_);
}

}  // namespace zerorate::cli
