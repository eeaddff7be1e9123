#include "firmware/boards/linux/daemon.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/signalfd.h>
#include <sys/timerfd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/metrics_text.hpp"
#include "firmware/boards/linux/node_service.hpp"
#include "firmware/boards/linux/process/process.hpp"
#include "firmware/boards/linux/simulated_vehicle.hpp"
#include "hal/linux/clock.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/file_storage.hpp"
#include "hal/linux/standard_output.hpp"

namespace zerorate::linux_node {
namespace {

using hal::linux_os::checked_descriptor;
using hal::linux_os::Descriptor;

/// The journal takes lines of the error stream.
void log_to_journal(std::string_view line) {
  fmt::print(stderr, "zerorated: {}\n", hal::linux_os::printable(line));
}

/// Signals arrive as readable bytes, in one thread, between two turns of its loop.
Descriptor open_signals() {
  sigset_t signals{};
  sigemptyset(&signals);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // before any thread: all inherit it
  return checked_descriptor(signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC), "signalfd");
}

Descriptor open_seconds() {
  Descriptor timer =
      checked_descriptor(timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC), "timerfd");
  const itimerspec every_second{.it_interval = {.tv_sec = 1, .tv_nsec = 0},
                                .it_value = {.tv_sec = 1, .tv_nsec = 0}};
  (void)timerfd_settime(timer.get(), 0, &every_second, nullptr);
  return timer;
}

/// One node, for as long as its configuration lasts.
class Run {
 public:
  /// Throws what the configuration leads to that cannot be, such as a file in no folder.
  Run(Configuration configuration, const Descriptor& signals)
      : configuration_(std::move(configuration)), signals_(signals) {
    if (configuration_.state) {
      state_lock_ = lock_state(configuration_.state->file);
      storage_.emplace(configuration_.state->file, file_calls_);
    }
    service_.emplace(configuration_, *hardware_, storage_ ? &*storage_ : nullptr, read_boot_id(),
                     log_to_journal);
    log_to_journal(describe(configuration_));
    (void)service_->restore();
  }

  /// @return the signal that ended it
  int until_signalled() {
    int signal = 0;
    {
      const MeasuringThread thread{configuration_.real_time.priority,
                                   [this] { service_->measure(); }, [this] { hardware_->wake(); },
                                   log_to_journal};
      notify_service_manager("READY=1");
      while (signal == 0) signal = turn();
    }
    service_->finish();
    update_metrics();
    return signal;
  }

 private:
  int turn() {
    std::array<pollfd, 4> sources{{
        {.fd = service_->queue().waiting().descriptor(), .events = POLLIN, .revents = 0},
        {.fd = seconds_.get(), .events = POLLIN, .revents = 0},
        {.fd = metrics_.descriptor(), .events = POLLIN, .revents = 0},
        {.fd = signals_.get(), .events = POLLIN, .revents = 0},
    }};
    (void)poll(sources.data(), sources.size(), -1);
    if (sources[0].revents != 0) service_->publish_waiting();
    if (sources[1].revents != 0) each_second();
    if (sources[2].revents != 0) metrics_.serve();
    return sources[3].revents != 0 ? take_signal() : 0;
  }

  void each_second() {
    std::uint64_t seconds = 0;
    (void)!read(seconds_.get(), &seconds, sizeof seconds);
    // A measuring thread that hangs is what the watchdog is for: it is not fed then.
    if (service_->tick()) feed_watchdog();
    update_metrics();
  }

  void update_metrics() {
    if (metrics_.is_wanted()) metrics_.publish(format_metrics(*service_, metrics_text_));
  }

  int take_signal() {
    signalfd_siginfo info{};
    const bool is_read = read(signals_.get(), &info, sizeof info) == sizeof info;
    return is_read ? static_cast<int>(info.ssi_signo) : 0;
  }

  Configuration configuration_;
  const Descriptor& signals_;
  std::unique_ptr<Hardware> hardware_ = make_hardware(configuration_);
  Descriptor state_lock_;
  hal::linux_os::FileCalls file_calls_;
  std::optional<hal::linux_os::FileStorage> storage_;
  std::optional<NodeService> service_;
  MetricsBuffer metrics_text_{};
  MetricsEndpoint metrics_{configuration_.metrics};
  Descriptor seconds_ = open_seconds();
};

/// The next run: as the file says now, or as before where that cannot be.
void reload(const std::string& file, const Descriptor& signals, Configuration& configuration,
            std::optional<Run>& run) {
  run.reset();  // what it holds may be asked for again
  try {
    Configuration changed = read_configuration(file);
    run.emplace(changed, signals);
    configuration = std::move(changed);
  } catch (const std::exception& error) {
    log_to_journal(fmt::format("not reloaded: {}", error.what()));
    run.emplace(configuration, signals);
  }
}

}  // namespace

void run_daemon(const std::string& configuration_file) {
  Configuration configuration = read_configuration(configuration_file);
  const Descriptor signals = open_signals();
  (void)std::signal(SIGPIPE, SIG_IGN);  // a reader that went away is an error of write()
  prepare_process(configuration.user, configuration.real_time, log_to_journal);
  std::optional<Run> run{std::in_place, configuration, signals};
  while (run->until_signalled() == SIGHUP) {
    notify_service_manager(fmt::format("RELOADING=1\nMONOTONIC_USEC={}",
                                       hal::linux_os::KernelClock::now().ns() / 1000));
    reload(configuration_file, signals, configuration, run);
  }
  notify_service_manager("STOPPING=1");
}

}  // namespace zerorate::linux_node
