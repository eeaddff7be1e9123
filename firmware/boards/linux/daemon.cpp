#include "firmware/boards/linux/daemon.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/signalfd.h>
#include <sys/timerfd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <ctime>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/metrics_text.hpp"
#include "firmware/boards/linux/node_service.hpp"
#include "firmware/boards/linux/outputs/metrics_endpoint.hpp"
#include "firmware/boards/linux/outputs/sinks.hpp"
#include "firmware/boards/linux/process/error_stream.hpp"
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
  static ErrorStream stream;
  stream.write_line(hal::linux_os::printable(line));
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

/// Says of which node a line is, where there are several.
Log log_of(const std::string& name) {
  if (name.empty()) return log_to_journal;
  return [name](std::string_view line) { log_to_journal(fmt::format("{}: {}", name, line)); };
}

/// One node, for as long as its configuration lasts. It measures in a thread of its own.
class Run {
 public:
  /// Descriptors that the publishing thread waits for: of a message, and of a reader of the
  /// metrics.
  using Sources = std::array<int, 2>;

  /// Throws what the configuration leads to that cannot be, such as a file in no folder.
  /// @param learnt  record of a run before, for a node without a state of its own; may be empty
  Run(Configuration configuration, std::span<const std::uint8_t> learnt)
      : configuration_(std::move(configuration)), log_(log_of(configuration_.name)) {
    if (configuration_.state) {
      state_lock_ = lock_state(configuration_.state->file);
      storage_.emplace(configuration_.state->file, file_calls_);
    }
    service_.emplace(configuration_, *hardware_, storage_ ? &*storage_ : nullptr, read_boot_id(),
                     log_);
    log_(describe(configuration_));
    if (!service_->restore() && !configuration_.state && !learnt.empty()) {
      (void)service_->restore(learnt);
    }
  }

  void start() {
    update_metrics();  // for readers before the first second is over
    thread_.emplace(
        configuration_.real_time.priority, [this] { service_->measure(); },
        [this] { hardware_->wake(); }, log_);
  }
  void finish() {
    thread_.reset();
    service_->finish();
    update_metrics();
  }

  [[nodiscard]] const std::string& name() const { return configuration_.name; }
  /// Record of what the node has learnt; after finish().
  [[nodiscard]] std::vector<std::uint8_t> learnt() const { return service_->record(); }

  [[nodiscard]] Sources sources() const {
    return {service_->queue().waiting().descriptor(), metrics_.descriptor()};
  }
  void serve(const pollfd& message, const pollfd& reader) {
    if (message.revents != 0) service_->publish_waiting();
    if (reader.revents != 0) metrics_.serve();
  }
  /// Does what is due each second.
  /// @return whether the measuring thread is alive
  bool tick() {
    const bool is_alive = service_->tick();
    update_metrics();
    return is_alive;
  }

 private:
  void update_metrics() {
    if (!metrics_.is_wanted()) return;
    metrics_.publish(format_metrics(*service_, metrics_text_));
    if (metrics_.error_number() == told_error_) return;
    told_error_ = metrics_.error_number();
    log_(told_error_ == 0 ? fmt::format("metrics: {} is written again", configuration_.metrics.file)
                          : fmt::format("metrics: {}: {}; the file stays as it is",
                                        configuration_.metrics.file, std::strerror(told_error_)));
  }

  Configuration configuration_;
  Log log_;
  std::unique_ptr<Hardware> hardware_ = make_hardware(configuration_);
  Descriptor state_lock_;
  hal::linux_os::FileCalls file_calls_;
  std::optional<hal::linux_os::FileStorage> storage_;
  std::optional<NodeService> service_;
  MetricsBuffer metrics_text_{};
  MetricsEndpoint metrics_{configuration_.metrics};
  int told_error_ = 0;                     ///< file of the metrics
  std::optional<MeasuringThread> thread_;  ///< last: ends before what it uses
};

/// Records of nodes by their names.
using Memory = std::map<std::string, std::vector<std::uint8_t>>;

/// All nodes, published, watched and saved by one thread.
class Daemon {
 public:
  /// @param signals  must outlive the daemon
  Daemon(const std::vector<Configuration>& configurations, const Descriptor& signals,
         const Memory& memory = {})
      : signals_(signals) {
    for (const Configuration& one : configurations) {
      const auto learnt = memory.find(one.name);
      runs_.push_back(std::make_unique<Run>(one, learnt != memory.end()
                                                     ? std::span{learnt->second}
                                                     : std::span<const std::uint8_t>{}));
      for (const int source : runs_.back()->sources()) sources_.push_back({source, POLLIN, 0});
    }
    for (const int source : {seconds_.get(), signals_.get()}) {
      sources_.push_back({source, POLLIN, 0});
    }
  }

  void start() {
    for (const auto& run : runs_) run->start();
  }
  /// @return the signal that came
  int until_signalled() {
    int signal = 0;
    while (signal == 0) signal = turn();
    return signal;
  }
  /// Ends the measuring.
  void finish() {
    for (const auto& run : runs_) run->finish();
  }
  /// Knowledge of the nodes, after finish().
  [[nodiscard]] Memory memory() const {
    Memory memory;
    for (const auto& run : runs_) memory[run->name()] = run->learnt();
    return memory;
  }

 private:
  int turn() {
    (void)poll(sources_.data(), sources_.size(), -1);
    auto source = sources_.begin();
    for (const auto& run : runs_) {
      const pollfd& message = *source++;
      const pollfd& reader = *source++;
      run->serve(message, reader);
    }
    if ((source++)->revents != 0) each_second();
    return source->revents != 0 ? take_signal() : 0;
  }

  void each_second() {
    std::uint64_t seconds = 0;
    (void)!read(seconds_.get(), &seconds, sizeof seconds);
    // A measuring thread that hangs is what the watchdog is for: it is not fed then.
    bool are_alive = true;
    for (const auto& run : runs_) are_alive = run->tick() && are_alive;
    if (are_alive) feed_watchdog();
  }

  int take_signal() {
    signalfd_siginfo info{};
    const bool is_read = read(signals_.get(), &info, sizeof info) == sizeof info;
    return is_read ? static_cast<int>(info.ssi_signo) : 0;
  }

  const Descriptor& signals_;
  Descriptor seconds_ = open_seconds();
  std::vector<std::unique_ptr<Run>> runs_;
  std::vector<pollfd> sources_;  ///< those of each run, the seconds, the signals
};

/// Whether something can be made; what keeps it from that is logged.
template <class Make>
bool can_be(const Log& log, Make make) {
  try {
    (void)make();
    return true;
  } catch (const std::exception& error) {
    log(fmt::format("left out until the next SIGHUP: {}", error.what()));
    return false;
  }
}

/// Leaves out what has gone since the start, such as the folder of a file, so that on the way back
/// the node measures and publishes to all other receivers.
void leave_out_what_has_gone(Configuration& configuration) {
  const Log log = log_of(configuration.name);
  std::erase_if(configuration.sinks, [&](const SinkSettings& sink) {
    return !can_be(log, [&] { return make_sink(sink); });
  });
  if (!can_be(log, [&] { return MetricsEndpoint{configuration.metrics}; })) {
    configuration.metrics.socket.clear();
  }
}

/// Run with the files as they are now. Wrong files leave the present run as it is; files that
/// cannot be followed lead to a new run of the configuration before.
void reload(const std::vector<std::string>& files, const Descriptor& signals,
            std::vector<Configuration>& configurations, std::optional<Daemon>& daemon) {
  std::vector<Configuration> changed;
  try {
    changed = read_configurations(files);
  } catch (const std::exception& error) {
    return log_to_journal(fmt::format("not reloaded: {}", error.what()));
  }
  daemon->finish();
  const Memory memory = daemon->memory();
  daemon.reset();  // the next run may ask for what this one holds
  try {
    daemon.emplace(changed, signals, memory);
    configurations = std::move(changed);
  } catch (const std::exception& error) {
    log_to_journal(fmt::format("not reloaded: {}", error.what()));
    std::ranges::for_each(configurations, leave_out_what_has_gone);
    daemon.emplace(configurations, signals, memory);
  }
  daemon->start();
}

}  // namespace

void run_daemon(const std::vector<std::string>& configuration_files) {
  std::vector<Configuration> configurations = read_configurations(configuration_files);
  const Descriptor signals = open_signals();
  (void)std::signal(SIGPIPE, SIG_IGN);  // a reader that went away is an error of write()
  const Configuration& first = configurations.front();
  become_user(first.user, first.real_time);
  std::optional<Daemon> daemon{std::in_place, configurations, signals};
  lock_memory(first.real_time, log_to_journal);
  daemon->start();
  notify_service_manager("READY=1");
  while (daemon->until_signalled() == SIGHUP) {
    notify_service_manager(fmt::format("RELOADING=1\nMONOTONIC_USEC={}",
                                       hal::linux_os::KernelClock::now().ns() / 1000));
    reload(configuration_files, signals, configurations, daemon);
    notify_service_manager("READY=1");
  }
  daemon->finish();
  notify_service_manager("STOPPING=1");
}

}  // namespace zerorate::linux_node
