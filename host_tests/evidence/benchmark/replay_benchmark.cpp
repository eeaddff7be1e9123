// How long a replay takes, in units of what merely unpacking the recording and counting its lines
// takes; and how much memory it needs.
//
//     replay_benchmark RECORDING.csv.gz      (sampled at 100 Hz or more)
//
// Both times are processor times of this machine in the same run, the least of three.

#include <fmt/core.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "firmware/model/catalogue.hpp"
#include "host_tools/lib/evaluate/replay.hpp"

namespace {

using namespace zerorate;

constexpr int kRuns = 3;

double processor_seconds(int who) {
  rusage usage{};
  getrusage(who, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// The least processor time of several runs of an action, in this process or its children.
template <class Action>
double least_seconds(int who, Action action) {
  double least = std::numeric_limits<double>::infinity();
  for (int run = 0; run < kRuns; ++run) {
    const double before = processor_seconds(who);
    action();
    least = std::min(least, processor_seconds(who) - before);
  }
  return least;
}

void unpack_and_count(const std::string& path) {
  const std::string command = fmt::format("zcat '{}' | wc -l >/dev/null", path);
  // NOLINTNEXTLINE(cert-env33-c,concurrency-mt-unsafe): this comparison is the benchmark
  if (std::system(command.c_str()) != 0) throw std::runtime_error("zcat failed on " + path);
}

/// @param filter_rate_hz nullopt: the default
std::uint64_t replayed_rows(const std::string& path, std::optional<double> filter_rate_hz) {
  recording::Reader reader{path};
  const evaluate::ReplayOptions options{
      .model = model::find_model("adis16405"),
      .filter_rate_hz = filter_rate_hz,
      .schedule = evaluate::ScheduleParams{.still_s = 60.0, .drive_s = 300.0, .seed = 1}};
  return evaluate::replay(reader, options).rows;
}

long peak_kib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

void compare(const std::string& path) {
  const double unpacking_s = least_seconds(RUSAGE_CHILDREN, [&] { unpack_and_count(path); });
  fmt::print("unpack and count      {:6.3f} s\n", unpacking_s);
  const auto report = [&](const char* what, std::optional<double> filter_rate_hz) {
    std::uint64_t rows = 0;
    const double seconds =
        least_seconds(RUSAGE_SELF, [&] { rows = replayed_rows(path, filter_rate_hz); });
    fmt::print("{:20}  {:6.3f} s, {:4.1f} times as long, {} rows\n", what, seconds,
               seconds / unpacking_s, rows);
  };
  report("replay, filter 10 Hz", 10.0);
  report("replay, filter 100 Hz", 100.0);
  fmt::print("peak memory           {} KiB\n", peak_kib());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: replay_benchmark RECORDING.csv.gz\n");
    return 2;
  }
  try {
    compare(argv[1]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "replay_benchmark: {}\n", error.what());
    return 1;
  }
}
