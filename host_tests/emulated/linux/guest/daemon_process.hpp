/// @file
/// The unmodified zerorated as a child process.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <string>

#include "host_tests/emulated/linux/guest/device_world.hpp"

namespace zerorate::emulated {

inline constexpr const char* kLogFile = "/run/zerorated.log";
inline constexpr const char* kMetricsFile = "/run/metrics";

[[nodiscard]] inline std::string content_of(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream{file}.rdbuf();
  return text.str();
}

/// Its log is new with every start.
class DaemonProcess {
 public:
  explicit DaemonProcess(std::string configuration) : configuration_(std::move(configuration)) {
    start();
  }
  DaemonProcess(const DaemonProcess&) = delete;
  DaemonProcess& operator=(const DaemonProcess&) = delete;
  ~DaemonProcess() {
    if (process_ > 0) (void)stop(SIGKILL);
  }

  void start() {
    (void)unlink(kMetricsFile);
    process_ = fork();
    if (process_ < 0) give_up("fork");
    if (process_ > 0) return;
    const int log = open(kLogFile, O_WRONLY | O_CREAT | O_TRUNC, 0644);
    (void)dup2(log, STDERR_FILENO);
    (void)execlp("zerorated", "zerorated", "--config", configuration_.c_str(), nullptr);
    _exit(127);
  }
  [[nodiscard]] pid_t process() const { return process_; }
  void send(int signal) const { (void)kill(process_, signal); }
  /// @return its exit code, or minus the signal that ended it
  int stop(int signal) {
    send(signal);
    return wait();
  }
  int wait() {
    int status = 0;
    (void)waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  [[nodiscard]] static bool has_logged(const std::string& words) {
    return content_of(kLogFile).find(words) != std::string::npos;
  }
  /// A number of the metrics file, which is up to a second old; -1 where there is none.
  [[nodiscard]] static double metric(const std::string& name) {
    std::istringstream text{content_of(kMetricsFile)};
    for (std::string line; std::getline(text, line);) {
      if (line.starts_with("zerorate_" + name + " ")) {
        return std::stod(line.substr(line.rfind(' ')));
      }
    }
    return -1.0;
  }

 private:
  std::string configuration_;
  pid_t process_ = -1;
};

}  // namespace zerorate::emulated
