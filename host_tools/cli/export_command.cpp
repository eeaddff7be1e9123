#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "core/base/time.hpp"
#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/outputs/can_dbc.hpp"
#include "firmware/boards/linux/outputs/sink_settings.hpp"
#include "firmware/model/catalogue.hpp"
#include "firmware/model/node_model.hpp"
#include "firmware/model/source_headers.hpp"
#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/replay_options.hpp"
#include "host_tools/cli/terminal.hpp"

namespace zerorate::cli {
namespace {

struct ExportFlags {
  std::string model;
  bool cpp = false;
  bool c = false;
  bool accelerometer = false;
  std::string name = "sensor_model";
  double sample_rate_hz = 0.0;
  double filter_rate_hz = 2.0;
  std::optional<int> hypotheses;
  std::optional<std::int64_t> held_ticks;
  std::string output = "-";
  std::string dbc;
  std::string interface;
  std::vector<std::string> receivers;
};

core::Duration period_of(double rate_hz, const char* option) {
  const double period_ns = 1e9 / rate_hz;
  if (!(period_ns >= 1.0 && period_ns <= 1e15)) {
    throw std::invalid_argument(std::string{option} + ": expected a rate in Hz");
  }
  return core::Duration::nanoseconds(std::llround(period_ns));
}

/// CAN sinks of the bus that is asked for, or of the only one.
std::vector<linux_node::CanSettings> sinks_of_bus(const linux_node::Configuration& configuration,
                                                  const std::string& asked) {
  std::vector<linux_node::CanSettings> sinks;
  std::string interface = asked;
  for (const linux_node::SinkSettings& sink : configuration.sinks) {
    const auto* can = std::get_if<linux_node::CanSettings>(&sink);
    if (can == nullptr || (!asked.empty() && can->interface != asked)) continue;
    if (interface.empty()) interface = can->interface;
    if (can->interface != interface) {
      throw std::invalid_argument("the configuration has sinks on " + interface + " and " +
                                  can->interface + "; --interface says which bus");
    }
    sinks.push_back(*can);
  }
  return sinks;
}

/// Writes the frames that a node with this configuration sends.
ExitCode run_dbc(const ExportFlags& flags) {
  const linux_node::Configuration configuration = linux_node::read_configuration(flags.dbc);
  const std::vector<linux_node::CanSettings> sinks = sinks_of_bus(configuration, flags.interface);
  if (sinks.empty()) {
    throw std::invalid_argument(flags.dbc + ": no [[sink]] of type \"can\"" +
                                (flags.interface.empty() ? "" : " on " + flags.interface));
  }
  write_text(flags.output, linux_node::format_dbc(sinks, {.rate_hz = configuration.gyro.rate_hz,
                                                          .receivers = flags.receivers}));
  return success;
}

ExitCode run_export(const ExportFlags& flags) {
  if (!flags.dbc.empty()) return run_dbc(flags);
  if (flags.model.empty()) throw std::invalid_argument("expected MODEL, or --dbc CONFIG");
  if (!flags.cpp && !flags.c) throw std::invalid_argument("expected --cpp or --c: the language");
  if (flags.sample_rate_hz == 0.0) throw std::invalid_argument("--sample-rate is required");
  model::SensorModel model = model::for_node(model::load_model(flags.model), flags.accelerometer);
  if (flags.hypotheses) {
    if (!model.learning) model.learning.emplace();
    model.learning->hypotheses = *flags.hypotheses;
  }
  const core::Duration sample = period_of(flags.sample_rate_hz, "--sample-rate");
  const core::Duration tick = period_of(flags.filter_rate_hz, "--filter-rate");
  const auto held_ticks =
      flags.held_ticks.value_or(flags.c ? model::kCApiHeldTicks : model::kNodeHeldTicks);
  write_text(flags.output, flags.c
                               ? model::format_c_header(model, sample, tick, flags.name, held_ticks)
                               : model::format_cpp_header(model, sample, tick, held_ticks));
  return success;
}

}  // namespace

Command add_export(CLI::App& app) {
  const auto flags = std::make_shared<ExportFlags>();
  auto* command = app.add_subcommand(
      "export", "Write a sensor model as source for firmware, or CAN frames as a DBC file");
  auto* model = command->add_option("MODEL", flags->model,
                                    "a TOML file or a name from 'zerorate model list'");
  auto* dbc = command
                  ->add_option("--dbc", flags->dbc,
                               "in place of a model: a configuration of zerorated, whose CAN "
                               "frames become a DBC file")
                  ->excludes(model);
  command
      ->add_option("--interface", flags->interface,
                   "with --dbc: the bus, where the configuration has several")
      ->needs(dbc);
  command
      ->add_option("--receivers", flags->receivers,
                   "with --dbc: nodes of the bus that read the frames, such as BRAKE,DISPLAY")
      ->delimiter(',')
      ->needs(dbc);
  auto* cpp = command->add_flag("--cpp", flags->cpp, "C++ header of constants, for our own images");
  command->add_flag("--c", flags->c, "C header, for firmware that calls zerorate.h")->excludes(cpp);
  command->add_flag("--accelerometer", flags->accelerometer,
                    "the firmware hands over accelerations: inputs that a model has for such a "
                    "node alone are in the source");
  command->add_option("--name", flags->name, "name of the constant, with --c")
      ->capture_default_str();
  command
      ->add_option("--sample-rate", flags->sample_rate_hz,
                   "samples of the sensor per second [Hz], on which the white noise of a sample "
                   "depends; required with MODEL")
      ->excludes(dbc);
  command
      ->add_option("--filter-rate", flags->filter_rate_hz,
                   "ticks of the predictors per second [Hz]")
      ->capture_default_str();
  command
      ->add_option("--hypotheses", flags->hypotheses,
                   "instead of those of the model; 1: the node takes the model at its word, and is "
                   "small")
      ->check(CLI::IsMember({1, 4, 12}));
  command
      ->add_option("--held-ticks", flags->held_ticks,
                   "places of the firmware for ticks that are held back (default: 16 with --c, 64 "
                   "with --cpp); a filter rate that needs more is refused")
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("-o,--output", flags->output, "file to write; - is the standard output")
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  zerorate export mine.toml --cpp --hypotheses 1 --sample-rate 104.171875 -o model.hpp\n"
      "  zerorate export mine.toml --c --name front_gyro --sample-rate 100 -o front_gyro.h\n"
      "  zerorate export --dbc zerorated.toml --receivers BRAKE,DISPLAY -o zerorate.dbc");
  return {command, [flags] { return run_export(*flags); }};
}

}  // namespace zerorate::cli
