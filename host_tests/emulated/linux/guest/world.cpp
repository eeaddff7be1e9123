// The world of the emulated node, the same in every run.
//
// usage: zerorate_world node|drivers SECONDS
// Goes through the scenarios of the node, the undisturbed one for so long, or compares the drivers
// of the kernel with ours, each for so long. Prints one line a finding and a last line "WORLD n
// passed, m failed".

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
  if (std::string_view{argv[1]} == "drivers") {
    compare_kernel_drivers(world, verdict, seconds);
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
