/// @file
/// Sources of messages on a command line: a node that runs, for `monitor` and `record`, or the chip
/// itself.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "hal/linux/descriptor.hpp"
#include "host_tools/lib/live/source.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library chose the name
class App;
class Option;
}  // namespace CLI

namespace zerorate::cli {

/// Options as typed; empty where not given.
struct LiveOptions {
  std::string udp = "127.0.0.1:24680";
  std::string unix_path;
  std::string serial;
  unsigned baud = 230'400;
  std::string json;
};

/// Adds --udp, --unix, --serial, --baud and --json, of which one source may be given.
void add_live_options(CLI::App& command, LiveOptions& options);

/// Opens the source that was asked for. Throws std::invalid_argument for an address that is none,
/// std::system_error for a source that cannot be opened.
[[nodiscard]] std::unique_ptr<live::Source> open_source(const LiveOptions& options);

/// A chip and how it is wired, as typed; `chip` is empty where a configuration file is meant.
struct ChipOptions {
  std::string configuration;  ///< a file for zerorated
  std::string chip;
  std::string spi;
  std::string i2c;
  std::string address;
  std::string rate_hz;
  std::string full_scale_dps;

  [[nodiscard]] bool is_given() const { return !configuration.empty() || !chip.empty(); }
};

/// Adds --config, --chip and its wiring, of which one source may be given instead of those of
/// add_live_options(), which comes first.
void add_chip_options(CLI::App& command, ChipOptions& chip);

/// Reads the chip as zerorated would, with the odometer of the configuration and without its sinks;
/// the messages are those that zerorated would publish. Throws toml_file::Error for a configuration
/// that cannot be used, std::runtime_error where a zerorated that runs has the state.
[[nodiscard]] std::unique_ptr<live::Source> open_chip(const ChipOptions& options);

/// The sensor model that the node of open_chip() runs with, by name or file. Throws
/// toml_file::Error.
[[nodiscard]] std::string model_of_chip(const ChipOptions& options);

struct Endpoint {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;
};

/// Reads "ADDRESS:PORT" or "PORT"; an IPv6 address may stand in brackets. Throws
/// std::invalid_argument.
/// @param option  for the message
[[nodiscard]] Endpoint parse_endpoint(const std::string& option, const std::string& where,
                                      unsigned least_port);

/// SIGINT, SIGTERM and SIGHUP as something to read: the source is closed properly.
[[nodiscard]] hal::linux_os::Descriptor open_end_signals();

/// Tells once, on the error stream, that no message has come for two seconds.
class SilenceNotice {
 public:
  explicit SilenceNotice(std::string source) : source_(std::move(source)) {}
  void tell(std::uint64_t messages, std::chrono::milliseconds silence);

 private:
  std::string source_;
  bool is_told_ = false;
};

}  // namespace zerorate::cli
