#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/daemon.hpp"

namespace {

enum ExitCode : int { success = 0, usage = 2, bad_configuration = 3 };

int run(int argc, char** argv) {
  CLI::App app{"zerorated: publishes the bias-corrected rate of a gyro", "zerorated"};
  app.set_version_flag("--version", "zerorated " ZERORATE_VERSION);
  std::string file = zerorate::linux_node::kConfigurationFile;
  app.add_option("--config", file, "the configuration, a TOML file")->capture_default_str();
  bool only_check = false;
  app.add_flag("--check-config", only_check,
               "read the configuration, say what is wrong with it, and end");
  app.footer(
      "SIGTERM: save the state and end. SIGHUP: read the configuration again.\n"
      "Exit codes: 0 ended or valid, 2 wrong usage, 3 a configuration that cannot be used.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? success : usage;
  }
  try {
    if (only_check) {
      (void)zerorate::linux_node::read_configuration(file);
      fmt::print("{}: valid\n", file);
    } else {
      zerorate::linux_node::run_daemon(file);
    }
    return success;
  } catch (const std::exception& error) {
    fmt::print(stderr, "zerorated: {}\n", error.what());
    return bad_configuration;
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (...) {  // only what the error stream itself refused to print comes this far
    return bad_configuration;
  }
}
