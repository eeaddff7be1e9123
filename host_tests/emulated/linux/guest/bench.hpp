/// @file
/// One zerorated with its hardware, its receivers and its judge.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>

#include "host_tests/emulated/linux/guest/daemon_process.hpp"
#include "host_tests/emulated/linux/guest/device_world.hpp"
#include "host_tests/emulated/linux/guest/receivers.hpp"
#include "host_tests/emulated/linux/guest/scenarios.hpp"
#include "host_tests/emulated/linux/guest/schedule.hpp"
#include "host_tests/emulated/linux/guest/witness.hpp"

namespace zerorate::emulated {

/// A gyro as the world plays it and as zerorated is told of it.
struct GyroSetup {
  std::unique_ptr<PlayedChip> (*make)() = on_spi<hal::sim::SimulatedLsm6dso>;
  /// Empty: what `zerorate probe` prints.
  std::string toml =
      "chip = \"lsm6dso\"\nbus = \"spi\"\ndevice = \"/dev/spidev0.0\"\nspeed_hz = 8_000_000\n"
      "rate_hz = 104\nfull_scale_dps = 250\n";
  bool has_data_ready = true;
  std::size_t axes = 3;
  float lsb_dps = kLsbDps;
  std::int64_t sample_ns = kSample104Hz_ns;
  /// Device that the test bus shows, and with it the driver of the kernel: "spi lsm6dso 0 0" (see
  /// kernel/zerorate_bus.c). Empty: that of before.
  std::string binding;
};

class Bench {
 public:
  /// Starts zerorated and waits until it talks to the gyro.
  Bench(DeviceWorld& devices, Verdict& judge, const char* scenario, const GyroSetup& gyro)
      : world(devices), verdict(judge) {
    verdict.begin(scenario);
    world.set_fault(BusFault::none);
    plug_in(gyro);
    write_configuration(gyro);
    witness.emplace(linux_node::read_configuration(configuration_), gyro.lsb_dps);
    if (!gyro.has_data_ready) {  // it is read before the schedule begins
      std::array<core::AngularRate, 3> rest;
      rest.fill(core::deg_per_s(0.1F));
      witness->expect(rest);
      world.measure(rest);
    }
    const unsigned before = world.transactions();
    daemon.emplace(configuration_);
    const std::int64_t started = hal::linux_os::KernelClock::now().ns();
    for (std::int64_t waited_ms = 0; world.transactions() == before; ++waited_ms) {
      if (waited_ms > 10'000) give_up("zerorated does not ask for the gyro");
      sleep_until(started + waited_ms * 1'000'000);
    }
    // Where no line signals a new sample, the gyro must not seem frozen until then.
    schedule.emplace(world, *witness, gyro.axes, gyro.sample_ns,
                     gyro.has_data_ready ? kSecond_ns : 0, [this] { receivers.receive(); });
  }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  /// Checks what holds at the end of every scenario.
  ~Bench() {
    schedule->run(0.1);
    verdict.check("no rate was published that was not measured", tally().never_given == 0,
                  tally().never_given);
    verdict.check("zerorated ends by itself", daemon->stop(SIGTERM) == 0, 0);
  }

  [[nodiscard]] const Tally& tally() const { return witness->tally(); }

  DeviceWorld& world;
  Verdict& verdict;
  Receivers receivers;
  std::optional<Witness> witness;
  std::optional<DaemonProcess> daemon;
  std::optional<Schedule> schedule;

 private:
  /// A driver of the kernel asks for its chip at once, and must not speak to the next one.
  void plug_in(const GyroSetup& gyro) const {
    if (!gyro.binding.empty()) bind_driver("none");
    world.insert(gyro.make());
    if (!gyro.binding.empty()) bind_driver(gyro.binding);
  }
  static void bind_driver(const std::string& device) {
    constexpr const char* kParameter = "/sys/module/zerorate_bus/parameters/chip";
    std::ofstream parameter{kParameter};
    if (!(parameter << device << std::flush)) give_up(kParameter);
  }

  /// Lines of a gyro of the kernel, as a user copies them: those that are indented below [gyro].
  static std::string lines_of_probe() {
    (void)std::system("zerorate probe >/run/probe.txt");
    const std::string text = content_of("/run/probe.txt");
    std::fputs(text.c_str(), stdout);
    const std::string header = "[gyro]\n";
    const std::size_t begin = text.find(header);
    if (begin == std::string::npos) return text;
    const std::size_t end = text.find("\niio:device", begin);
    return text.substr(begin + header.size(), end - begin - header.size()) + "\n";
  }

  void write_configuration(const GyroSetup& gyro) const {
    std::string shared = content_of("/zerorated.toml");
    if (!gyro.has_data_ready) shared.resize(shared.find("[data_ready]"));
    std::ofstream{configuration_} << shared << "\n[gyro]\n"
                                  << (gyro.toml.empty() ? lines_of_probe() : gyro.toml);
  }

  std::string configuration_ = "/run/zerorated.toml";
};

/// Judges four seconds, after one in which the fault is found: it is said, and nothing else is.
inline void check_silence(Bench& bench) {
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

/// Judges that samples come again after a fault, and that nothing is called faulty any more.
inline void check_recovery(Bench& bench, double settling_s = 3.0, long samples_per_s = 100) {
  bench.schedule->run(settling_s);
  bench.witness->forget_given();
  const Tally recovered = bench.tally();
  bench.schedule->run(2.0);
  const Tally& after = bench.tally();
  const auto samples = after.with_rate - recovered.with_rate;
  bench.verdict.check("samples come again", samples >= 2 * samples_per_s, samples);
  bench.verdict.check("and nothing is faulty", after.faulty == recovered.faulty,
                      after.faulty - recovered.faulty);
}

}  // namespace zerorate::emulated
