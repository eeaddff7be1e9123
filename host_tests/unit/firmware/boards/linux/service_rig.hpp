/// @file
/// A node service on simulated hardware, both of its threads played by the test.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/boards/linux/node_service.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tests/unit/firmware/boards/linux/simulated_hardware.hpp"

namespace zerorate::linux_node {

inline constexpr app::Session kBoot{'a'};

inline std::vector<std::string>& log_lines() {
  static std::vector<std::string> lines;
  return lines;
}
inline void keep_line(std::string_view line) {
  log_lines().emplace_back(line);
}
inline void forget_line(std::string_view) {}

inline bool was_logged(const std::string& piece) {
  return std::ranges::any_of(
      log_lines(), [&](const std::string& line) { return line.find(piece) != std::string::npos; });
}

/// A service on simulated hardware, both of its threads played by the test.
struct ServiceRig {
  explicit ServiceRig(Log log = keep_line, const app::Session& boot = kBoot) {
    log_lines().clear();
    configuration.sinks.emplace_back(UnixSettings{(folder.path() / "rate").string()});
    configuration.sinks.emplace_back(JsonSettings{(folder.path() / "rate.jsonl").string()});
    configuration.state =
        StateSettings{(folder.path() / "state").string(), core::Duration::seconds(10)};
    service.emplace(configuration, hardware, &storage, boot, log);
  }

  /// A new service, in this boot, on the same storage.
  void restart(const app::Session& boot) {
    service.emplace(configuration, hardware, &storage, boot, keep_line);
  }

  /// Sample by sample, with a tick each second.
  void run(int samples) {
    for (int i = 0; i < samples; ++i) {
      service->measure();
      service->publish_waiting();
      if (++samples_ % 104 == 0) (void)service->tick();
    }
  }
  [[nodiscard]] const app::RateMessage& latest() const { return service->latest()->message; }

  testing::ScratchFolder folder;
  hal::linux_os::FileCalls calls;
  hal::linux_os::FileStorage storage{(folder.path() / "state").string(), calls};
  Configuration configuration = parse_configuration(kMinimalConfiguration, "test.toml");
  SimulatedHardware hardware;
  std::optional<NodeService> service;
  int samples_ = 0;
};

}  // namespace zerorate::linux_node
