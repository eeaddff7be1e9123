#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include "firmware/model/model_file.hpp"
#include "hal/linux/named_socket.hpp"
#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/live_options.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/lib/live/source.hpp"
#include "host_tools/lib/live/view.hpp"

namespace zerorate::cli {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::duration_cast;
using std::chrono::milliseconds;

struct MonitorFlags {
  LiveOptions live;
  std::string model_out;
  std::string http;
  bool is_http_remote = false;
  double interval_s = 1.0;
  std::uint64_t count = 0;
};

/// Shows the tally: on its page, and on a terminal by painting over the last picture, elsewhere
/// line by line.
class Display {
 public:
  Display(std::string source, ShowTally page)
      : source_(std::move(source)),
        silence_(source_),
        page_(std::move(page)),
        is_terminal_(isatty(STDOUT_FILENO) == 1) {
    if (!is_terminal_) fmt::print("{}", live::line_header());
  }

  void show(const live::Tally& tally, milliseconds silence) {
    silence_.tell(tally.messages, silence);
    if (page_) page_(tally, source_, silence);
    if (is_terminal_) {
      paint(live::format_screen(tally, source_, silence));
    } else if (tally.messages > shown_) {
      fmt::print("{}", live::format_line(tally));
    }
    shown_ = tally.messages;
    std::fflush(stdout);
  }

  /// Tells the page from where it is to come.
  void begin(const live::Tally& tally) const {
    if (page_) page_(tally, source_, milliseconds{0});
  }
  /// Prints what was learnt, where lines have no room for it.
  void end(const live::Tally& tally) const {
    if (!is_terminal_) fmt::print("{}", live::format_learnt(tally));
  }

 private:
  void paint(std::string_view screen) {
    if (lines_ > 0) fmt::print("\033[{}A\033[J", lines_);
    fmt::print("{}", screen);
    lines_ = std::ranges::count(screen, '\n');
  }

  std::string source_;
  SilenceNotice silence_;
  ShowTally page_;
  bool is_terminal_;
  std::uint64_t shown_ = 0;
  std::ptrdiff_t lines_ = 0;
};

/// Model of an axis as a model file holds it.
model::SensorModel to_model(const wire::LearntModel& learnt, std::size_t axis) {
  const app::LearntNoise& noise = learnt.axes.at(axis);
  const auto relative_sigma = [](const app::LearntFigure& figure) {
    return fmt::format("learnt; relative standard deviation {:.1f} %",
                       100.0F * figure.sigma / figure.value);
  };
  model::SensorModel model{.name = fmt::format("learnt by a node in {:.1f} stops, axis {}",
                                               learnt.stops(), "xyz"[axis])};
  const auto& white = noise.angle_random_walk_rad_per_sqrt_s;
  const auto& flicker = noise.bias_instability_rad_s;
  model.white = {.angle_random_walk_rad_per_sqrt_s = white.value, .source = relative_sigma(white)};
  model.flicker = model::Flicker{
      .bias_instability_rad_s = flicker.value,
      .order = noise.order.value,
      .source = fmt::format("{}; d +- {:.2g}", relative_sigma(flicker), noise.order.sigma)};
  return model;
}

/// The axis with the median slow noise, as characterize takes it.
std::size_t middle_axis(const wire::LearntModel& learnt) {
  constexpr double kSlow_rad_s = 1.0 / 30.0;  // a stop and a drive weigh noise of half a minute
  const auto slow_noise = [&](std::size_t axis) {
    const app::LearntNoise& noise = learnt.axes.at(axis);
    return static_cast<double>(noise.bias_instability_rad_s.value) *
           std::pow(kSlow_rad_s, -static_cast<double>(noise.order.value));
  };
  std::array<std::size_t, 3> axes{0, 1, 2};
  std::ranges::sort(axes, {}, slow_noise);
  return axes[1];
}

void write_model(const live::Tally& tally, const std::string& file) {
  if (!tally.learnt || !tally.learnt->is_learnt()) {
    throw std::runtime_error(
        file +
        ": not written: the node has sent no learnt model. It does so once a "
        "second, from its first stop on, over UDP, Unix sockets and JSON lines");
  }
  const std::size_t axis = middle_axis(*tally.learnt);
  write_text(file, model::format_model(to_model(*tally.learnt, axis)));
  if (file != "-") {
    fmt::print("{}: the model of axis {}, the one with the median slow noise\n", file, "xyz"[axis]);
  }
}

ShowTally page_of(const MonitorFlags& flags, const OpenPage& open_page) {
  if (flags.http.empty()) return nullptr;
  const Endpoint endpoint = parse_endpoint("--http", flags.http, 0);
  if (!flags.is_http_remote && !hal::linux_os::is_loopback(endpoint.address)) {
    throw std::invalid_argument(fmt::format(
        "--http: whoever reaches {} could look, and it is not an address of this machine alone. "
        "Add --http-remote where that is meant, or leave the address out",
        endpoint.address));
  }
  return open_page(endpoint.address, endpoint.port);
}

ExitCode run_monitor(const MonitorFlags& flags, const OpenPage& open_page) {
  const auto interval =
      duration_cast<milliseconds>(std::chrono::duration<double>(flags.interval_s));
  const auto signals = open_end_signals();
  const auto source = open_source(flags.live);
  Display display{source->name(), page_of(flags, open_page)};
  live::Tally tally;
  display.begin(tally);
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
  display.end(tally);
  if (!flags.model_out.empty()) write_model(tally, flags.model_out);
  return tally.messages > 0 ? success : finding;
}

}  // namespace

Command add_monitor(CLI::App& app, const OpenPage& open_page) {
  const auto flags = std::make_shared<MonitorFlags>();
  auto* command = app.add_subcommand("monitor", "Show what a node publishes, as it comes");
  add_live_options(*command, flags->live);
  command->add_option("--interval", flags->interval_s, "seconds between two updates")
      ->check(CLI::Range(0.01, 3600.0))
      ->capture_default_str();
  command->add_option("--count", flags->count, "end after so many messages; 0: never")
      ->capture_default_str();
  command->add_option(
      "--model-out", flags->model_out,
      "at the end, write what the node has learnt of its sensor as a model file; of "
      "the axis with the median slow noise");
  if (open_page) {
    command->add_option("--http", flags->http,
                        "serve a page for browsers, [ADDRESS:]PORT; the address is 127.0.0.1 "
                        "unless given, port 0 is one that is free");
    command->add_flag("--http-remote", flags->is_http_remote,
                      "allow an address of --http that other machines reach; they can look, and "
                      "change nothing");
  }
  const std::string page_example = open_page ? "  zerorate monitor --http 8080\n" : "";
  command->footer(
      "Examples:\n"
      "  zerorate monitor\n"
      "  zerorate monitor --udp 0.0.0.0:24680 --interval 0.2\n"
      "  zerorate monitor --serial /dev/ttyUSB0\n" +
      page_example +
      "  zerorate monitor --count 500 --model-out mine.toml\n"
      "  tail -n 0 -f rate.jsonl | zerorate monitor --json -\n"
      "Where the output is no terminal it is one line an interval. Ends with the file, at Ctrl-C\n"
      "or SIGTERM; exit code 1 where no message came, 3 where a model was to be written and\n"
      "nothing had been learnt. A rate without a message for a second is no longer shown.");
  return {command, [flags, open_page] { return run_monitor(*flags, open_page); }};
}

}  // namespace zerorate::cli
