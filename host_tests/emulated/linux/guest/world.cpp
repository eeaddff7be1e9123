// The world of the emulated node, the same in every run.
//
// usage: zerorate_world SECONDS
// Goes through all scenarios, the undisturbed one for so long; prints one line a finding and a last
// line "WORLD n passed, m failed".

#include <cstdio>
#include <cstdlib>

#include "host_tests/emulated/linux/guest/scenarios.hpp"

int main(int argc, char** argv) {
  using namespace zerorate::emulated;
  if (argc != 2) return 2;
  DeviceWorld world;
  Verdict verdict;
  drive_undisturbed(world, verdict, std::atof(argv[1]));
  measure_cost(world, verdict);
  break_the_bus(world, verdict);
  break_the_lines(world, verdict);
  break_the_system(world, verdict);
  const int result = verdict.report();
  std::fflush(stdout);
  std::_Exit(result);  // the thread that plays the bus never ends
}
