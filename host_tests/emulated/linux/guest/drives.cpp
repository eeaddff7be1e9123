#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string_view>

#include "host_tests/emulated/linux/guest/bench.hpp"
#include "host_tests/emulated/linux/guest/scenarios.hpp"

namespace zerorate::emulated {
namespace {

using Messages = std::vector<wire::NumberedMessage>;

double in_dps(core::AngularRate rate) {
  return double{rate.in(core::deg_per_s)};
}

void judge_samples(Bench& bench) {
  const Tally& tally = bench.tally();
  std::printf("  samples given %ld, with rate %ld, pulses %ld\n", bench.schedule->samples(),
              tally.with_rate, bench.schedule->pulses());
  // The driver drops what the chip gives in its first 100 ms; the newest may still be on its way.
  const auto missing = bench.schedule->samples() - tally.with_rate;
  Verdict& verdict = bench.verdict;
  verdict.check("spidev was set to mode 3", bench.world.spi_mode() == 3, bench.world.spi_mode());
  verdict.check("every sample is published", missing >= 0 && missing <= 14, missing);
  verdict.check("no message is lost", tally.number_gaps == 0, tally.number_gaps);
  verdict.check("every sample is the one that was next", tally.out_of_order == 0,
                tally.out_of_order);
  verdict.check("corrected rate within one LSB of the node beside it",
                tally.largest_difference_lsb <= 1.0, tally.largest_difference_lsb);
  verdict.check("stops are seen", tally.still > 0, tally.still);
  verdict.check("the odometer is never called faulty", tally.odometer_faulty == 0,
                tally.odometer_faulty);
}

/// Errors of the corrected rate and of the bias, in LSB of the gyro; infinite where a message is
/// missing. A receiver may have more than was published when the comparison began.
template <class Receiver>
double largest_difference(const Messages& published, std::size_t received, Receiver rates_dps) {
  if (received < published.size()) return std::numeric_limits<double>::infinity();
  double largest = 0.0;
  for (std::size_t i = 0; i < published.size(); ++i) {
    const app::RateMessage& message = published[i].message;
    if (!message.has_rate()) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto [rate_dps, bias_dps] = rates_dps(i, axis);
      const app::AxisRate& here = message.axes.at(axis);
      largest = std::max({largest, std::abs(rate_dps - in_dps(here.corrected)),
                          std::abs(bias_dps - in_dps(here.bias))});
    }
  }
  return largest / double{kLsbDps};
}

/// CAN, UDP and JSON say the same as the Unix socket.
void judge_receivers(Bench& bench) {
  using Pair = std::pair<double, double>;
  const Messages& published = bench.witness->published();
  const auto of_messages = [](const Messages& messages) {
    return [&messages](std::size_t i, std::size_t axis) {
      const app::AxisRate& rate = messages[i].message.axes.at(axis);
      return Pair{in_dps(rate.corrected), in_dps(rate.bias)};
    };
  };
  const Messages& udp = bench.receivers.udp();
  const double by_udp = largest_difference(published, udp.size(), of_messages(udp));
  bench.verdict.check("UDP says the same within one LSB", by_udp <= 1.0, by_udp);
  const auto& can = bench.receivers.can();
  const double by_can =
      largest_difference(published, can.size(), [&](std::size_t i, std::size_t axis) {
        return Pair{can[i].rate_dps.at(axis), can[i].bias_dps.at(axis)};
      });
  bench.verdict.check("CAN says the same within one LSB", by_can <= 1.0, by_can);
  const Messages json = Receivers::json();
  const double by_json = largest_difference(published, json.size(), of_messages(json));
  bench.verdict.check("JSON says the same within one LSB", by_json <= 1.0, by_json);
}

/// A recording (docs/reference/recording-format.md) of what was measured, and beside it, in columns
/// that a replay passes over, the bias and its deviation that were published.
void write_recording(const Bench& bench) {
  const std::vector<core::Instant>& pulses = bench.witness->pulses_given();
  std::FILE* const file = std::fopen("/run/recording.csv", "w");
  if (file == nullptr) give_up("/run/recording.csv");
  std::fputs(
      "t_s,gx_radps,gy_radps,gz_radps,odometer_pulses,bias_x,bias_y,bias_z,sigma_x,sigma_y,sigma_"
      "z\n",
      file);
  std::size_t counted = 0;
  for (const wire::NumberedMessage& numbered : bench.witness->published()) {
    const app::RateMessage& message = numbered.message;
    if (!message.has_rate()) continue;
    while (counted < pulses.size() && pulses[counted] <= message.time) ++counted;
    std::fprintf(file, "%lld.%09lld", static_cast<long long>(message.time.ns() / kSecond_ns),
                 static_cast<long long>(message.time.ns() % kSecond_ns));
    const auto write = [&](core::AngularRate app::AxisRate::*member, auto unit) {
      for (const app::AxisRate& axis : message.axes) {
        std::fprintf(file, ",%.9g", static_cast<double>((axis.*member).in(unit)));
      }
    };
    write(&app::AxisRate::measured, core::rad_per_s);
    std::fprintf(file, ",%zu", counted);
    write(&app::AxisRate::bias, core::deg_per_s);
    write(&app::AxisRate::sigma, core::deg_per_s);
    std::fputc('\n', file);
  }
  (void)std::fclose(file);
}

}  // namespace

void drive_undisturbed(DeviceWorld& world, Verdict& verdict, double seconds) {
  // Whatever it asks goes through spidev and i2c-dev; the gyro is on SPI, and nobody on I2C.
  const int probed = std::system("zerorate probe >/run/probe.txt");
  const std::string probe = content_of("/run/probe.txt");
  std::fputs(probe.c_str(), stdout);
  Bench bench{world, verdict, "stops and drives", {}};
  verdict.check("zerorate probe finds the gyro", probed == 0, probed);
  const int monitor = std::system(
      "zerorate monitor --unix /run/monitor.sock --count 2000 >/run/monitor.txt 2>&1 &");
  verdict.check("zerorate monitor starts", monitor == 0, monitor);
  bench.schedule->run(seconds);
  judge_samples(bench);
  judge_receivers(bench);
  write_recording(bench);
  bench.schedule->run(4.0, false);  // zerorated's counters are a second old
  verdict.check(
      "every pulse is counted",
      DaemonProcess::metric("pulses_total") == static_cast<double>(bench.schedule->pulses()),
      DaemonProcess::metric("pulses_total"));
  verdict.check("none was dropped", DaemonProcess::metric("pulses_lost_total") == 0.0,
                DaemonProcess::metric("pulses_lost_total"));
  const std::string shown = content_of("/run/monitor.txt");
  const std::size_t learnt = shown.find("learnt from ");  // after the last state
  verdict.check("zerorate monitor shows a fine node",
                std::string_view{shown}.substr(0, learnt).ends_with("fine\n"),
                static_cast<double>(std::ranges::count(shown, '\n')));
  verdict.check("and what it has learnt", learnt != std::string::npos, shown.size());
  (void)std::system("grep -E '^Vm(HWM|RSS|Lck)' /proc/$(pidof zerorated)/status");
}

namespace {

/// `-icount shift=1`: each instruction takes two nanoseconds of the machine's time.
constexpr double kInstruction_ns = 2.0;

/// Instructions that all threads of a process have executed, those in the kernel included.
double instructions_of(pid_t process) {
  double computed_ns = 0.0;
  const auto tasks = "/proc/" + std::to_string(process) + "/task";
  for (const auto& task : std::filesystem::directory_iterator{tasks}) {
    double ns = 0.0;
    std::ifstream{task.path() / "schedstat"} >> ns;
    computed_ns += ns;
  }
  return computed_ns / kInstruction_ns;
}

}  // namespace

void measure_cost(DeviceWorld& world, Verdict& verdict) {
  Bench bench{world,
              verdict,
              "three axes at 1 kHz",
              {.make = on_spi<hal::sim::SimulatedIcm42688>,
               .toml = "chip = \"icm42688\"\nbus = \"spi\"\ndevice = \"/dev/spidev0.0\"\n"
                       "speed_hz = 8_000_000\nrate_hz = 1000\nfull_scale_dps = 250\n",
               .lsb_dps = 1.0F / 131.0F,
               .sample_ns = 1'000'000}};
  bench.schedule->run(5.0);
  const long before = bench.tally().with_rate;
  const double computed = instructions_of(bench.daemon->process());
  bench.schedule->run(10.0);
  const long samples = bench.tally().with_rate - before;
  const double each =
      (instructions_of(bench.daemon->process()) - computed) / static_cast<double>(samples);
  verdict.check("nearly every sample arrives", samples >= 9'900, samples);
  // 15 % of a processor that does 10^9 instructions a second.
  verdict.check("instructions per sample, kernel and five sinks included", each < 150'000.0, each);
}

}  // namespace zerorate::emulated
