#include <fmt/format.h>
#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <stdexcept>

#include "hal/linux/descriptor.hpp"
#include "host_tools/cli/commands.hpp"
#include "host_tools/lib/live/source.hpp"
#include "host_tools/lib/live/view.hpp"

namespace zerorate::cli {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::duration_cast;
using std::chrono::milliseconds;

struct MonitorFlags {
  std::string udp = "127.0.0.1:24680";
  std::string unix_path;
  std::string serial;
  unsigned baud = 115'200;
  std::string json;
  double interval_s = 1.0;
  std::uint64_t count = 0;
};

/// "ADDRESS:PORT" or "PORT".
std::unique_ptr<live::Source> listen_udp(const std::string& where) {
  const std::size_t colon = where.rfind(':');
  const bool has_address = colon != std::string::npos;
  const std::string port = has_address ? where.substr(colon + 1) : where;
  const bool is_number =
      !port.empty() && port.size() <= 5 && std::ranges::all_of(port, [](unsigned char character) {
        return std::isdigit(character) != 0;
      });
  const unsigned long number = is_number ? std::stoul(port) : 0;
  if (number < 1 || number > 65535) {
    throw std::invalid_argument("--udp: \"" + where + "\" does not end in a port, 1 to 65535");
  }
  return live::listen_udp(has_address ? where.substr(0, colon) : "127.0.0.1",
                          static_cast<std::uint16_t>(number));
}

std::unique_ptr<live::Source> open_source(const MonitorFlags& flags) {
  if (!flags.serial.empty()) return live::open_serial(flags.serial, flags.baud);
  if (!flags.unix_path.empty()) return live::listen_unix(flags.unix_path);
  if (!flags.json.empty()) return live::open_json_lines(flags.json);
  return listen_udp(flags.udp);
}

/// Shows the tally: on a terminal by painting over the last picture, elsewhere line by line.
class Display {
 public:
  explicit Display(std::string source)
      : source_(std::move(source)), is_terminal_(isatty(STDOUT_FILENO) == 1) {
    if (!is_terminal_) fmt::print("{}", live::line_header());
  }

  void show(const live::Tally& tally, milliseconds silence) {
    if (is_terminal_) {
      paint(live::format_screen(tally, source_, silence));
    } else if (tally.messages > shown_) {
      fmt::print("{}", live::format_line(tally));
    }
    shown_ = tally.messages;
    std::fflush(stdout);
  }

 private:
  void paint(std::string_view screen) {
    if (lines_ > 0) fmt::print("\033[{}A\033[J", lines_);
    fmt::print("{}", screen);
    lines_ = std::ranges::count(screen, '\n');
  }

  std::string source_;
  bool is_terminal_;
  std::uint64_t shown_ = 0;
  std::ptrdiff_t lines_ = 0;
};

/// SIGINT and SIGTERM as something to read: the source is closed properly.
hal::linux_os::Descriptor open_end_signals() {
  sigset_t signals{};
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM}) sigaddset(&signals, signal);
  sigprocmask(SIG_BLOCK, &signals, nullptr);
  return hal::linux_os::checked_descriptor(signalfd(-1, &signals, SFD_CLOEXEC), "signalfd");
}

ExitCode run_monitor(const MonitorFlags& flags) {
  const auto interval =
      duration_cast<milliseconds>(std::chrono::duration<double>(flags.interval_s));
  const auto signals = open_end_signals();
  const auto source = open_source(flags);
  Display display{source->name()};
  live::Tally tally;
  Clock::time_point heard_at = Clock::now();
  Clock::time_point show_at = heard_at + interval;
  bool goes_on = true;
  while (goes_on && (flags.count == 0 || tally.messages < flags.count)) {
    std::array<pollfd, 2> events{{{.fd = signals.get(), .events = POLLIN, .revents = 0},
                                  {.fd = source->descriptor(), .events = POLLIN, .revents = 0}}};
    const auto pause = duration_cast<milliseconds>(show_at - Clock::now()).count() + 1;
    (void)poll(events.data(), events.size(), static_cast<int>(std::max<std::int64_t>(pause, 0)));
    const std::uint64_t before = tally.messages;
    if (events[1].revents != 0) goes_on = source->receive(tally);
    if (events[0].revents != 0) goes_on = false;
    const auto now = Clock::now();
    if (tally.messages > before) heard_at = now;
    if (now >= show_at) {
      display.show(tally, duration_cast<milliseconds>(now - heard_at));
      show_at = now + interval;
    }
  }
  display.show(tally, duration_cast<milliseconds>(Clock::now() - heard_at));
  return tally.messages > 0 ? success : finding;
}

}  // namespace

Command add_monitor(CLI::App& app) {
  const auto flags = std::make_shared<MonitorFlags>();
  auto* command = app.add_subcommand("monitor", "Show what a node publishes, as it comes");
  auto* udp = command->add_option("--udp", flags->udp, "receive datagrams, [ADDRESS:]PORT")
                  ->capture_default_str();
  auto* local =
      command->add_option("--unix", flags->unix_path, "receive on a Unix datagram socket");
  auto* serial = command->add_option("--serial", flags->serial, "read a Pico's serial line");
  command->add_option("--baud", flags->baud, "speed of the serial line")
      ->capture_default_str()
      ->needs(serial);
  auto* json = command->add_option("--json", flags->json, "read JSON lines; - for standard input");
  udp->excludes(local)->excludes(serial)->excludes(json);
  local->excludes(serial)->excludes(json);
  serial->excludes(json);
  command->add_option("--interval", flags->interval_s, "seconds between two updates")
      ->check(CLI::Range(0.01, 3600.0))
      ->capture_default_str();
  command->add_option("--count", flags->count, "end after so many messages; 0: never")
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  zerorate monitor\n"
      "  zerorate monitor --udp 0.0.0.0:24680 --interval 0.2\n"
      "  zerorate monitor --serial /dev/ttyUSB0\n"
      "  tail -n 0 -f rate.jsonl | zerorate monitor --json -\n"
      "Where the output is no terminal it is one line an interval. Ends with the file, at Ctrl-C\n"
      "or SIGTERM; exit code 1 where no message came. A rate without a message for a second is\n"
      "no longer shown.");
  return {command, [flags] { return run_monitor(*flags); }};
}

}  // namespace zerorate::cli
