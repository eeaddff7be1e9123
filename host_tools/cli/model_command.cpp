#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "firmware/model/catalogue.hpp"
#include "firmware/model/model_file.hpp"
#include "hal/linux/standard_output.hpp"
#include "host_tools/cli/commands.hpp"

namespace zerorate::cli {
namespace {

using hal::linux_os::printable;

ExitCode list() {
  for (const auto& entry : model::catalogue()) {
    fmt::print("{:<12} {}\n", entry.name, model::find_model(entry.name).name);
  }
  return success;
}

ExitCode show(const std::string& name) {
  fmt::print("{}", model::format_model(model::find_model(name)));
  return success;
}

ExitCode check(const std::string& file) {
  const model::SensorModel model = model::read_model(file);
  fmt::print("{}: {} is a valid model\n", printable(file), printable(model.name));
  return success;
}

}  // namespace

Command add_model(CLI::App& app) {
  auto* command = app.add_subcommand("model", "The sensor models: list, show, check");
  command->require_subcommand(1);
  const auto argument = std::make_shared<std::string>();
  command->add_subcommand("list", "The models that come with zerorate");
  auto* show_command = command->add_subcommand("show", "Print a model as TOML, with its sources");
  show_command->add_option("NAME", *argument)->required();
  auto* check_command =
      command->add_subcommand("check", "Check a model file and report what is wrong");
  check_command->add_option("FILE", *argument)->required();
  command->footer(
      "Examples:\n"
      "  zerorate model show lsm6dso > mine.toml\n"
      "  zerorate model check mine.toml\n"
      "The format is described in docs/reference/model-format.md.");
  return {command, [show_command, check_command, argument] {
            if (show_command->parsed()) return show(*argument);
            if (check_command->parsed()) return check(*argument);
            return list();
          }};
}

}  // namespace zerorate::cli
