// The world of the emulated node, the same in every run.
//
// usage: zerorate_world node|drivers|drivers_on_busy_host|relatives SECONDS
// Goes through the scenarios of the node, the undisturbed one for so long, or compares the drivers
// of the kernel with ours, each for so long; on a busy host without the stamps and the chips'
// relatives, or these alone. Prints one line a finding and a last line "WORLD n passed, m failed".

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "host_tests/emulated/linux/guest/scenarios.hpp"

int main(int argc, char** argv) {
  using namespace zerorate::emulated;
  if (argc != 3) return 2;
  const double seconds = std::atof(argv[2]);
  DeviceWorld world;
  Verdict verdict;
  const std::string_view what = argv[1];
  if (what == "relatives") {
    compare_kernel_drivers_of_relatives(world, verdict, seconds);
  } else if (what.starts_with("drivers")) {
    compare_kernel_drivers(world, verdict, seconds, what == "drivers");
  } else {
    drive_undisturbed(world, verdict, seconds);
    measure_cost(world, verdict);
    break_the_bus(world, verdict);
    break_the_lines(world, verdict);
    break_the_system(world, verdict);
  }
  const int result = verdict.report();
  std::fflush(stdout);
  std::_Exit(result);  // the thread that plays the bus never ends
}
