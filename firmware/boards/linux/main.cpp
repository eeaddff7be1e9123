#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/daemon.hpp"
#include "firmware/boards/linux/process/error_stream.hpp"
#include "hal/linux/standard_output.hpp"

namespace {

enum ExitCode : int { success = 0, usage = 2, bad_configuration = 3 };

int run(int argc, char** argv) {
  CLI::App app{"zerorated: publishes the bias-corrected rate of a gyro", "zerorated"};
  app.set_version_flag("--version", "zerorated " ZERORATE_VERSION);
  std::vector<std::string> files{zerorate::linux_node::kConfigurationFile};
  app.add_option("--config", files,
                 "a configuration, a TOML file; each time it is given, a further node")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->capture_default_str();
  bool only_check = false;
  app.add_flag("--check-config", only_check,
               "read the configuration, report what is wrong with it, and end");
  app.footer(
      "Examples:\n"
      "  zerorated --check-config\n"
      "  zerorated --config front.toml --config rear.toml   two gyros, two nodes, one process\n"
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
    (void)zerorate::linux_node::read_configurations(files);
    for (const std::string& file : files) {
      fmt::print("{}: valid\n", zerorate::hal::linux_os::printable(file));
    }
  } else {
    zerorate::linux_node::run_daemon(files);
  }
  return success;
}

}  // namespace

int main(int argc, char** argv) {
  zerorate::linux_node::keep_standard_descriptors();
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
