#include <fmt/chrono.h>
#include <fmt/format.h>
#include <poll.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "hal/linux/standard_output.hpp"
#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/live_options.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/lib/live/recorder.hpp"

namespace zerorate::cli {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::duration_cast;
using std::chrono::milliseconds;

/// An interruption of the power costs at most this much.
constexpr std::chrono::seconds kFlushInterval{10};

struct RecordFlags {
  LiveOptions live;
  ChipOptions chip;
  std::string output;
  std::string axis = "all";
  double hours = 0.0;
  double duration_s = 0.0;
  bool resumes = false;
  std::string summary;

  /// Recorded time of the whole file that is wanted; 0: until it is ended.
  [[nodiscard]] double wanted_s() const { return hours > 0.0 ? hours * 3600.0 : duration_s; }
};

std::int64_t utc_ns() {
  return duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::optional<std::size_t> chosen_axis(const std::string& name) {
  if (name == "all") return std::nullopt;
  return std::string{"xyz"}.find(name);
}

double recorded_s(const live::Recorder& recorder) {
  return static_cast<double>(recorder.recorded_ns()) * 1e-9;
}

/// Says on the error stream, at most once a second, what went wrong since the last time.
class Complaints {
 public:
  void tell(const live::RecorderCounts& now, std::uint64_t damaged) {
    const auto time = Clock::now();
    if (time - told_at_ < std::chrono::seconds(1)) return;
    told_at_ = time;
    tell("messages lost", now.lost, told_.lost);
    tell("messages without a rate", now.without_rate, told_.without_rate);
    tell("restarts of the node", now.restarts, told_.restarts);
    tell("pauses of more than a second", now.pauses, told_.pauses);
    tell("times the clock stood before the newest row, which is followed after 2 s then",
         now.set_back, told_.set_back);
    tell("damaged frames or lines", damaged, damaged_);
    told_ = now;
    damaged_ = damaged;
  }

 private:
  static void tell(const char* what, std::uint64_t now, std::uint64_t before) {
    if (now != before) fmt::print(stderr, "zerorate: {} {}, {} in all\n", now - before, what, now);
  }
  live::RecorderCounts told_;
  std::uint64_t damaged_ = 0;
  Clock::time_point told_at_;
};

std::string to_json(const RecordFlags& flags, const live::Recorder& recorder,
                    std::uint64_t damaged) {
  const live::RecorderCounts& counts = recorder.counts();
  const nlohmann::ordered_json json{{"schema", "zerorate.record/1"},
                                    {"recording", flags.output},
                                    {"rows", recorder.rows()},
                                    {"recorded_s", recorded_s(recorder)},
                                    {"rows_added", counts.rows},
                                    {"lost", counts.lost},
                                    {"without_rate", counts.without_rate},
                                    {"out_of_order", counts.out_of_order},
                                    {"restarts", counts.restarts},
                                    {"pauses", counts.pauses},
                                    {"clock_set_back", counts.set_back},
                                    {"damaged", damaged},
                                    {"torn_bytes", recorder.torn_bytes()}};
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void print_summary(const RecordFlags& flags, const live::Recorder& recorder) {
  const live::RecorderCounts& counts = recorder.counts();
  fmt::print("{}: {:.1f} s in {} rows; {} messages lost, {} without a rate, {} pauses\n",
             hal::linux_os::printable(flags.output), recorded_s(recorder), recorder.rows(),
             counts.lost, counts.without_rate, counts.pauses);
}

/// The loop of the command: from the source to the file until one of them ends.
class Session {
 public:
  Session(const RecordFlags& flags, live::Source& source)
      : flags_(flags),
        source_(source),
        recorder_({.path = flags.output,
                   .resumes = flags.resumes,
                   .axis = chosen_axis(flags.axis),
                   .comment = fmt::format("zerorate record, from {}, begun {:%FT%TZ}",
                                          hal::linux_os::printable(source.name()),
                                          fmt::gmtime(std::time(nullptr)))}),
        progress_("recording"),
        silence_(source.name()) {
    tally_.every = &messages_;
    if (recorder_.torn_bytes() > 0) {
      fmt::print(stderr, "zerorate: {}: cut off {} bytes of an unfinished part\n",
                 hal::linux_os::printable(flags.output), recorder_.torn_bytes());
    }
  }

  /// @param signals  readable when the recording is to end
  void run(const hal::linux_os::Descriptor& signals) {
    Clock::time_point flush_at = Clock::now() + kFlushInterval;
    while (!is_complete()) {
      std::array<pollfd, 2> events{{{.fd = signals.get(), .events = POLLIN, .revents = 0},
                                    {.fd = source_.descriptor(), .events = POLLIN, .revents = 0}}};
      constexpr int kPause_ms = 200;
      (void)poll(events.data(), events.size(), kPause_ms);
      const bool goes_on = events[1].revents == 0 || receive();
      if (Clock::now() >= flush_at) {
        recorder_.flush();
        flush_at = Clock::now() + kFlushInterval;
      }
      tell();
      if (!goes_on || events[0].revents != 0) break;
    }
    recorder_.finish();
  }

  [[nodiscard]] const live::Recorder& recorder() const { return recorder_; }
  [[nodiscard]] std::uint64_t damaged() const { return tally_.damaged; }
  /// Whether all that should be in the file is in it.
  [[nodiscard]] bool is_flawless() const {
    const live::RecorderCounts& counts = recorder_.counts();
    return recorder_.rows() > 0 && is_long_enough() &&
           counts.lost + counts.without_rate + counts.restarts + counts.set_back + tally_.damaged ==
               0;
  }

 private:
  [[nodiscard]] bool is_long_enough() const {
    return flags_.wanted_s() == 0.0 || recorded_s(recorder_) >= flags_.wanted_s();
  }
  [[nodiscard]] bool is_complete() const { return flags_.wanted_s() > 0.0 && is_long_enough(); }

  bool receive() {
    const bool goes_on = source_.receive(tally_);
    for (const wire::NumberedMessage& message : messages_) {
      if (is_complete()) break;
      recorder_.take(message, utc_ns());
    }
    if (!messages_.empty()) heard_at_ = Clock::now();
    messages_.clear();
    return goes_on;
  }

  void tell() {
    silence_.tell(tally_.messages, duration_cast<milliseconds>(Clock::now() - heard_at_));
    complaints_.tell(recorder_.counts(), tally_.damaged);
    const double wanted_s = flags_.wanted_s();
    progress_.update(wanted_s > 0.0 ? std::optional{recorded_s(recorder_) / wanted_s}
                                    : std::nullopt);
  }

  const RecordFlags& flags_;
  live::Source& source_;
  live::Recorder recorder_;
  live::Tally tally_;
  std::vector<wire::NumberedMessage> messages_;
  ProgressBar progress_;
  SilenceNotice silence_;
  Complaints complaints_;
  Clock::time_point heard_at_ = Clock::now();
};

ExitCode run_record(const RecordFlags& flags) {
  const auto signals = open_end_signals();  // before any thread: all inherit that they are blocked
  const auto source = flags.chip.is_given() ? open_chip(flags.chip) : open_source(flags.live);
  std::optional<Session> session{std::in_place, flags, *source};
  session->run(signals);
  const std::string summary = to_json(flags, session->recorder(), session->damaged());
  if (flags.summary != "-") print_summary(flags, session->recorder());
  if (!flags.summary.empty()) write_text(flags.summary, summary);
  return session->is_flawless() ? success : finding;
}

}  // namespace

Command add_record(CLI::App& app) {
  const auto flags = std::make_shared<RecordFlags>();
  auto* command = app.add_subcommand("record", "Record a gyro, for characterize and diagnose");
  command->add_option("-o,--output", flags->output, "the recording, NAME.csv.gz or NAME.csv")
      ->required();
  add_live_options(*command, flags->live);
  add_chip_options(*command, flags->chip);
  auto* hours =
      command->add_option("--hours", flags->hours, "end when the file holds so many hours")
          ->check(CLI::PositiveNumber);
  command->add_option("--duration", flags->duration_s, "the same with a unit: 90s, 30min, 3h")
      ->transform(CLI::AsNumberWithUnit(
          std::map<std::string, double>{{"s", 1.0}, {"min", 60.0}, {"h", 3600.0}},
          CLI::AsNumberWithUnit::CASE_SENSITIVE))
      ->check(CLI::PositiveNumber)
      ->excludes(hours);
  command->add_flag("--resume", flags->resumes, "go on with a file that was interrupted");
  command->add_option("--axis", flags->axis, "record one axis only")
      ->check(CLI::IsMember({"all", "x", "y", "z"}))
      ->capture_default_str();
  command->add_option("--summary", flags->summary,
                      "write the figures as JSON; - for standard output");
  command->footer(
      "Examples:\n"
      "  zerorate record -o rest.csv.gz --hours 3\n"
      "  zerorate record --serial /dev/ttyUSB0 -o rest.csv.gz --duration 90min\n"
      "  zerorate record --chip lsm6dso --i2c /dev/i2c-1 --rate 104 --full-scale 250 -o "
      "rest.csv.gz\n"
      "  zerorate record --config /etc/zerorate/zerorated.toml -o drive.csv.gz\n"
      "  zerorate record -o rest.csv.gz --hours 3 --resume\n"
      "The file holds the measured rate, and temperature and odometer pulses where there are any.\n"
      "What was recorded more than ten seconds ago stays, whatever happens; --resume goes on with\n"
      "it. Ends at Ctrl-C too. Exit code 1 where messages were lost or the time was not reached.");
  return {command, [flags] { return run_record(*flags); }};
}

}  // namespace zerorate::cli
