#include "host_tests/emulated/linux/guest/bench.hpp"
#include "host_tests/emulated/linux/guest/scenarios.hpp"

namespace zerorate::emulated {
namespace {

/// Judges four seconds, after one in which the fault is found: it is said, and nothing else is.
void check_silence(Bench& bench) {
  bench.schedule->run(1.0);
  const Tally before = bench.tally();
  bench.schedule->run(4.0);
  const Tally& during = bench.tally();
  const auto said = during.faulty - before.faulty;
  bench.verdict.check("sensor_fault is said again and again", said >= 12, said);
  bench.verdict.check("no rate is published", during.with_rate == before.with_rate,
                      during.with_rate - before.with_rate);
  bench.verdict.check("standstill is not claimed", during.still == before.still,
                      during.still - before.still);
}

/// Five seconds without a gyro.
void lose_the_gyro(DeviceWorld& world, Verdict& verdict, BusFault fault, const char* name) {
  Bench bench{world, verdict, name, {}};
  bench.schedule->run(2.0);
  world.set_fault(fault);
  check_silence(bench);
  if (fault == BusFault::unplugged) world.insert(lsm6dso_on_spi());  // it comes back unconfigured
  world.set_fault(BusFault::none);
  check_recovery(bench);
}

void frozen_chip(DeviceWorld& world, Verdict& verdict) {
  Bench bench{world, verdict, "the gyro freezes at a plausible rate", {}};
  bench.schedule->run(2.0);
  bench.schedule->set_frozen(true);
  check_silence(bench);
  verdict.check("the log names it", DaemonProcess::has_logged(": frozen"), 0);
  bench.schedule->set_frozen(false);
  check_recovery(bench);
}

void wrong_chip(DeviceWorld& world, Verdict& verdict) {
  Bench bench{world, verdict, "another chip's WHO_AM_I", {.make = icm42688_on_spi}};
  check_silence(bench);
  verdict.check("the log names it",
                DaemonProcess::has_logged(", lsm6dso answers 0x6c: is it another chip?"), 0);
  world.insert(lsm6dso_on_spi());
  check_recovery(bench);
}

void nack_bursts(DeviceWorld& world, Verdict& verdict) {
  Bench bench{world,
              verdict,
              "bursts of missing acknowledges on I2C",
              {.make = lsm6dso_on_i2c,
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
              {.make = adxrs453_on_spi,
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

}  // namespace zerorate::emulated
