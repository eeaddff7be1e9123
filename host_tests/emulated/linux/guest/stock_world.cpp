// The world of the emulated node on a kernel without a module of ours: what there is works
// together. Prints one line a finding and a last line "WORLD n passed, m failed".

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "host_tests/emulated/linux/guest/bench.hpp"
#include "host_tests/emulated/linux/guest/stock_wires.hpp"

namespace {

using namespace zerorate;
using namespace zerorate::emulated;

/// Four seconds of rest, two at 50 pulses a second, and four of rest.
void stop_drive_stop(DeviceWorld& world, Verdict& verdict, const char* name,
                     const GyroSetup& gyro) {
  constexpr int kPulses = 100;
  Bench bench{world, verdict, name, gyro};
  bench.schedule->run(4.0);
  verdict.check("stops are seen", bench.witness->newest()->message.motion == core::Motion::still,
                bench.tally().still);
  for (int i = 0; i < kPulses; ++i) {
    bench.witness->pulsed(world.pulse());
    bench.schedule->run(0.02, false);
  }
  verdict.check("drives are seen", bench.witness->newest()->message.motion == core::Motion::moving,
                0);
  bench.schedule->run(4.0, false);
  const Tally& tally = bench.tally();
  // Lines are driven by a process outside, which may be late: then the next sample is there first.
  const long given = bench.schedule->samples();
  verdict.check("nearly every sample is published", tally.with_rate >= given * 19 / 20,
                given - tally.with_rate);
  verdict.check("no message is lost", tally.number_gaps == 0, tally.number_gaps);
  verdict.check("corrected rate within one LSB of the node beside it",
                tally.largest_difference_lsb <= 1.0, tally.largest_difference_lsb);
  const double pulses = DaemonProcess::metric("pulses_total");
  verdict.check("every pulse is counted", pulses == kPulses, pulses);
}

}  // namespace

int main() {
  Verdict verdict;
  DeviceWorld world{std::make_unique<StockWires>()};
  const int probed = std::system("zerorate probe");
  verdict.check("zerorate probe finds the gyro", probed == 0, probed);
  stop_drive_stop(world, verdict, "spidev by CUSE, lines by a PL061", {});
  stop_drive_stop(world, verdict, "i2c-dev by CUSE, lines by a PL061",
                  {.make = on_i2c<hal::sim::SimulatedLsm6dso, 0x6A>,
                   .toml = "chip = \"lsm6dso\"\nbus = \"i2c\"\ndevice = \"/dev/i2c-7\"\n"
                           "rate_hz = 104\nfull_scale_dps = 250\n"});
  const int result = verdict.report();
  std::fflush(stdout);
  std::_Exit(result);  // the thread that plays the buses never ends
}
