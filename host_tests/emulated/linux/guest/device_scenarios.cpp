#include <cmath>

#include "host_tests/emulated/linux/guest/bench.hpp"
#include "host_tests/emulated/linux/guest/scenarios.hpp"

namespace zerorate::emulated {
namespace {

/// Five seconds without a gyro.
void lose_the_gyro(DeviceWorld& world, Verdict& verdict, BusFault fault, const char* name) {
  Bench bench{world, verdict, name, {}};
  bench.schedule->run(2.0);
  world.set_fault(fault);
  check_silence(bench);
  if (fault == BusFault::unplugged)
    world.insert(on_spi<hal::sim::SimulatedLsm6dso>());  // it comes back unconfigured
  world.set_fault(BusFault::none);
  check_recovery(bench);
}

void frozen_chip(DeviceWorld& world, Verdict& verdict) {
  Bench bench{world, verdict, "the gyro freezes at a plausible rate", {}};
  bench.schedule->run(2.0);
  bench.schedule->set_frozen(true);
  bench.schedule->run(10.0);  // it has not stood for long enough to show its noise
  check_silence(bench);
  verdict.check("the log names it", DaemonProcess::has_logged(": frozen"), 0);
  bench.schedule->set_frozen(false);
  check_recovery(bench);
}

void wrong_chip(DeviceWorld& world, Verdict& verdict) {
  Bench bench{
      world, verdict, "another chip's WHO_AM_I", {.make = on_spi<hal::sim::SimulatedIcm42688>}};
  check_silence(bench);
  verdict.check("the log names it",
                DaemonProcess::has_logged(", lsm6dso answers 0x6c: is it another chip?"), 0);
  world.insert(on_spi<hal::sim::SimulatedLsm6dso>());
  check_recovery(bench);
}

void nack_bursts(DeviceWorld& world, Verdict& verdict) {
  Bench bench{world,
              verdict,
              "bursts of missing acknowledges on I2C",
              {.make = on_i2c<hal::sim::SimulatedLsm6dso, 0x6A>,
               .toml = "chip = \"lsm6dso\"\nbus = \"i2c\"\ndevice = \"/dev/i2c-7\"\n"
                       "rate_hz = 104\nfull_scale_dps = 250\n"}};
  bench.schedule->run(3.0);
  const Tally before = bench.tally();
  verdict.check("it runs over I2C", before.with_rate >= 250, before.with_rate);
  world.set_fault(BusFault::nack_bursts);
  bench.schedule->run(10.0);
  world.set_fault(BusFault::none);
  const Tally& during = bench.tally();
  verdict.check("samples come between the bursts", during.with_rate > before.with_rate,
                during.with_rate - before.with_rate);
  verdict.check("the log names it", DaemonProcess::has_logged("not acknowledged"), 0);
  check_recovery(bench);
}

void bit_errors(DeviceWorld& world, Verdict& verdict) {
  Bench bench{world,
              verdict,
              "bit errors on the ADXRS453's bus",
              {.make = on_frames<hal::sim::SimulatedAdxrs453>,
               .toml = "chip = \"adxrs453\"\nbus = \"spi\"\ndevice = \"/dev/spidev0.0\"\n"
                       "rate_hz = 200\nfull_scale_dps = 300\n",
               .has_data_ready = false,
               .axes = 1,
               .lsb_dps = 1.0F / 80.0F}};
  bench.schedule->run(3.0);
  const Tally before = bench.tally();
  verdict.check("it runs", before.with_rate >= 300, before.with_rate);
  world.set_fault(BusFault::bit_errors);
  bench.schedule->run(10.0);
  world.set_fault(BusFault::none);
  const Tally& during = bench.tally();
  verdict.check("samples come between the errors", during.with_rate > before.with_rate,
                during.with_rate - before.with_rate);
  bench.schedule->run(1.5, false);
  const double errors = DaemonProcess::metric("gyro_read_errors_total") +
                        DaemonProcess::metric("gyro_start_errors_total") +
                        DaemonProcess::metric("gyro_configurations_lost_total");
  verdict.check("parity found them", errors >= 5.0, errors);
  check_recovery(bench, 3.0, 180);
}

void full_fifo(DeviceWorld& world, Verdict& verdict) {
  Bench bench{world,
              verdict,
              "FIFO overflow: zerorated is stopped for eight seconds",
              {.toml = GyroSetup{}.toml + "fifo = true\n"}};
  bench.schedule->run(3.0);
  verdict.check("it runs through the FIFO", bench.tally().with_rate >= 200,
                bench.tally().with_rate);
  bench.daemon->send(SIGSTOP);
  bench.schedule->run(8.0);
  bench.daemon->send(SIGCONT);
  check_recovery(bench);
  const double overruns = DaemonProcess::metric("gyro_overruns_total");
  verdict.check("the overflow is counted", overruns >= 1.0, overruns);
}

}  // namespace

void break_the_bus(DeviceWorld& world, Verdict& verdict) {
  wrong_chip(world, verdict);
  lose_the_gyro(world, verdict, BusFault::unplugged, "unplugged for five seconds, and back");
  lose_the_gyro(world, verdict, BusFault::no_answer, "the bus times out");
  lose_the_gyro(world, verdict, BusFault::stuck_high, "data line stuck high");
  lose_the_gyro(world, verdict, BusFault::stuck_low, "data line stuck low");
  frozen_chip(world, verdict);
  nack_bursts(world, verdict);
  bit_errors(world, verdict);
  full_fifo(world, verdict);
}

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
