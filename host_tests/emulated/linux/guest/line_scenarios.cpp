#include <cmath>

#include "host_tests/emulated/linux/guest/bench.hpp"
#include "host_tests/emulated/linux/guest/scenarios.hpp"

namespace zerorate::emulated {
namespace {

void data_ready_lost(DeviceWorld& world, Verdict& verdict) {
  Bench bench{world, verdict, "data-ready line broken", {}};
  bench.schedule->run(2.0);
  world.set_data_ready_broken(true);
  bench.schedule->run(1.0);
  const Tally before = bench.tally();
  bench.schedule->run(4.0);
  const Tally& during = bench.tally();
  const auto samples = during.with_rate - before.with_rate;
  verdict.check("the gyro is read by the clock", samples >= 400, samples);
  verdict.check("and is not faulty", during.faulty == before.faulty, during.faulty - before.faulty);
  world.set_data_ready_broken(false);
  check_recovery(bench);
}

/// 10 000 pulses in one second, a hundred at a time.
void odometer_bounces(DeviceWorld& world, Verdict& verdict) {
  Bench bench{world, verdict, "odometer bounces at 10 kHz", {}};
  bench.schedule->run(5.0);
  const Tally before = bench.tally();
  for (int burst = 0; burst < 100; ++burst) {
    for (int i = 0; i < 100; ++i) (void)world.pulse();
    bench.schedule->run(0.01, false);
  }
  const Tally& during = bench.tally();
  const auto samples = during.with_rate - before.with_rate;
  verdict.check("samples go on", samples >= 90, samples);
  verdict.check("it counts as moving",
                bench.witness->newest()->message.motion == core::Motion::moving, 0);
  bench.schedule->run(3.0);
  verdict.check("standstill is seen again",
                bench.witness->newest()->message.motion == core::Motion::still, 0);
  check_recovery(bench);
}

/// The vehicle drives through its bend and no pulse comes: the change of the rate tells, by its
/// means over half a second.
void odometer_dead(DeviceWorld& world, Verdict& verdict) {
  constexpr double kNoticed_s = 1.0;
  Bench bench{world, verdict, "odometer wire dead in a bend of 12 deg/s", {}};
  bench.schedule->run(Schedule::kStop_s);
  bench.schedule->run(kNoticed_s, false);
  const Tally before = bench.tally();
  bench.schedule->run(static_cast<double>(Schedule::kDrive_s) - kNoticed_s, false);
  const Tally& during = bench.tally();
  const auto fine = during.fine - before.fine;
  verdict.check("one second into it nothing is called healthy", fine == 0, fine);
  bench.schedule->run(Schedule::kStop_s);
  const app::RateMessage& after = bench.witness->newest()->message;
  const double bias_dps = double{after.axes[2].bias.in(core::deg_per_s)};
  verdict.check("the bend was not learnt: bias z is 0.1 deg/s", std::abs(bias_dps - 0.1) < 0.01,
                bias_dps);
  check_recovery(bench);
}

}  // namespace

void break_the_lines(DeviceWorld& world, Verdict& verdict) {
  data_ready_lost(world, verdict);
  odometer_bounces(world, verdict);
  odometer_dead(world, verdict);
}

}  // namespace zerorate::emulated
