#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <sstream>
#include <string>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/daemon.hpp"
#include "hal/linux/standard_output.hpp"

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
    std::ostringstream text;  // not std::cout, whose flush would lose the reason of a failure
    const int code = app.exit(error, text);
    fmt::print("{}", text.str());
    return code == 0 ? success : usage;
  }
  if (only_check) {
    (void)zerorate::linux_node::read_configuration(file);
    fmt::print("{}: valid\n", zerorate::hal::linux_os::printable(file));
  } else {
    zerorate::linux_node::run_daemon(file);
  }
  return success;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const int code = run(argc, argv);
    zerorate::hal::linux_os::flush_standard_output();
    return code;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "zerorated: %s\n",
                 zerorate::hal::linux_os::printable(error.what()).c_str());
    return bad_configuration;
  } catch (...) {
    return bad_configuration;
  }
}
