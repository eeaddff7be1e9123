#include <cstdio>
#include <filesystem>
#include <fstream>

#include "host_tests/emulated/linux/guest/bench.hpp"
#include "host_tests/emulated/linux/guest/scenarios.hpp"

namespace zerorate::emulated {
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
              {.make = icm42688_on_spi,
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
