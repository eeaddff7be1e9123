// The world of the emulated node: stops, drives and faults on a fixed schedule, the same in every
// run.
//
// usage: world CONFIGURATION SOCKET SECONDS
// Starts when zerorated has taken the gyro into operation; prints one line a finding and a last
// line "WORLD n passed, m failed".

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "host_tests/emulated/linux/guest/device_world.hpp"
#include "host_tests/emulated/linux/guest/witness.hpp"

namespace zerorate::emulated {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kSample_ns = 9'615'385;  // 104 Hz
constexpr std::int64_t kPulse_ns = 4'000'000;   // 250 Hz
constexpr std::int64_t kStop_s = 25;
constexpr std::int64_t kDrive_s = 15;

void sleep_until(std::int64_t time_ns) {
  const std::timespec until{.tv_sec = time_ns / kSecond_ns, .tv_nsec = time_ns % kSecond_ns};
  (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

/// Noise of about normal shape from a generator that is the same everywhere.
class Noise {
 public:
  float next() {
    float sum = -6.0F;
    for (int i = 0; i < 12; ++i) {
      state_ = state_ * 6364136223846793005U + 1442695040888963407U;
      sum += static_cast<float>(state_ >> 40U) / 16777216.0F;
    }
    return sum;
  }

 private:
  std::uint64_t state_ = 1;
};

class Schedule {
 public:
  Schedule(DeviceWorld& world, Witness& witness) : world_(world), witness_(witness) {}

  /// Samples at 104 Hz, and pulses at 250 Hz in the drives unless somebody else gives them.
  void run(double seconds, bool with_pulses = true) {
    const std::int64_t end = next_sample_ + static_cast<std::int64_t>(seconds * 1e9);
    while (next_sample_ < end) {
      if (next_pulse_ < next_sample_) {
        sleep_until(next_pulse_);
        if (with_pulses && is_moving(next_pulse_)) {
          witness_.pulsed(world_.pulse());
          ++pulses_;
        }
        next_pulse_ += kPulse_ns;
      } else {
        sleep_until(next_sample_);
        sample();
        next_sample_ += kSample_ns;
      }
    }
    witness_.receive();
  }

  [[nodiscard]] long samples() const { return samples_; }
  [[nodiscard]] long pulses() const { return pulses_; }

 private:
  [[nodiscard]] bool is_moving(std::int64_t time_ns) const {
    return (time_ns - start_) / kSecond_ns % (kStop_s + kDrive_s) >= kStop_s;
  }

  void sample() {
    const float turn_dps = is_moving(next_sample_) ? 12.0F : 0.0F;
    const std::array rate{core::deg_per_s(0.35F + 0.1F * noise_.next()),
                          core::deg_per_s(-0.2F + 0.1F * noise_.next()),
                          core::deg_per_s(turn_dps + 0.1F + 0.1F * noise_.next())};
    witness_.expect(rate);
    world_.measure(rate);
    ++samples_;
    witness_.receive();
  }

  DeviceWorld& world_;
  Witness& witness_;
  Noise noise_;
  std::int64_t start_ = hal::linux_os::KernelClock::now().ns() + kSecond_ns;
  std::int64_t next_sample_ = start_;
  std::int64_t next_pulse_ = start_;
  long samples_ = 0;
  long pulses_ = 0;
};

/// Counts findings and prints them.
class Verdict {
 public:
  void check(const char* what, bool is_right, double value) {
    std::printf("%s: %s (%.4g)\n", is_right ? "ok" : "FAILED", what, value);
    (is_right ? passed_ : failed_) += 1;
  }
  int report() const {
    std::printf("WORLD %d passed, %d failed\n", passed_, failed_);
    return failed_ == 0 ? 0 : 1;
  }

 private:
  int passed_ = 0;
  int failed_ = 0;
};

void undisturbed(Schedule& schedule, const Witness& witness, double seconds, Verdict& verdict) {
  schedule.run(seconds);
  const Tally& tally = witness.tally();
  std::printf("samples given %ld, with rate %ld, pulses %ld\n", schedule.samples(), tally.with_rate,
              schedule.pulses());
  // The driver drops what the chip gives in its first 100 ms; the newest may still be on its way.
  const long missing = schedule.samples() - tally.with_rate;
  verdict.check("every sample is published", missing >= 0 && missing <= 14,
                static_cast<double>(missing));
  verdict.check("no message is lost", tally.number_gaps == 0,
                static_cast<double>(tally.number_gaps));
  verdict.check("every sample is the one that was next", tally.wrong_samples == 0,
                static_cast<double>(tally.wrong_samples));
  verdict.check("corrected rate within one LSB of the node beside it",
                tally.largest_difference_lsb <= 1.0, tally.largest_difference_lsb);
  verdict.check("stops are seen", tally.still > 0, static_cast<double>(tally.still));
  verdict.check("nothing is called faulty once it runs", tally.odometer_faulty == 0,
                static_cast<double>(tally.odometer_faulty));
}

/// A fault of the bus for five seconds: said, and recovered from.
void bus_fault(DeviceWorld& world, Schedule& schedule, Witness& witness, BusFault fault,
               const char* name, Verdict& verdict) {
  world.set_fault(fault);
  schedule.run(1.0);
  const Tally before = witness.tally();
  schedule.run(4.0);
  const Tally during = witness.tally();
  world.set_fault(BusFault::none);
  std::printf("fault: %s\n", name);
  verdict.check("it is said again and again", during.faulty - before.faulty >= 12,
                static_cast<double>(during.faulty - before.faulty));
  verdict.check("no rate is published", during.with_rate == before.with_rate,
                static_cast<double>(during.with_rate - before.with_rate));
  verdict.check("standstill is not claimed", during.still == before.still,
                static_cast<double>(during.still - before.still));
  schedule.run(3.0);
  witness.forget_given();
  const Tally recovered = witness.tally();
  schedule.run(2.0);
  const Tally after = witness.tally();
  verdict.check("samples come again", after.with_rate - recovered.with_rate >= 200,
                static_cast<double>(after.with_rate - recovered.with_rate));
  verdict.check("and nothing is faulty", after.faulty == recovered.faulty,
                static_cast<double>(after.faulty - recovered.faulty));
}

void data_ready_lost(DeviceWorld& world, Schedule& schedule, const Witness& witness,
                     Verdict& verdict) {
  world.set_data_ready_broken(true);
  schedule.run(1.0);
  const Tally before = witness.tally();
  schedule.run(4.0);
  const Tally after = witness.tally();
  world.set_data_ready_broken(false);
  std::printf("fault: data-ready line broken\n");
  verdict.check("the gyro is read by the clock", after.with_rate - before.with_rate >= 400,
                static_cast<double>(after.with_rate - before.with_rate));
  verdict.check("and is not faulty", after.faulty == before.faulty,
                static_cast<double>(after.faulty - before.faulty));
  schedule.run(1.0);
}

/// 10 000 pulses in one second, a hundred at a time.
void odometer_bounces(DeviceWorld& world, Schedule& schedule, const Witness& witness,
                      Verdict& verdict) {
  const Tally before = witness.tally();
  for (int burst = 0; burst < 100; ++burst) {
    for (int i = 0; i < 100; ++i) (void)world.pulse();
    schedule.run(0.01, false);
  }
  const Tally after = witness.tally();
  std::printf("fault: odometer bounces at 10 kHz\n");
  verdict.check("samples go on", after.with_rate - before.with_rate >= 90,
                static_cast<double>(after.with_rate - before.with_rate));
  verdict.check("it counts as moving", witness.newest()->message.motion == core::Motion::moving,
                static_cast<double>(witness.newest()->message.motion));
}

int run(const char* configuration_file, const char* socket, double seconds) {
  const linux_node::Configuration configuration =
      linux_node::read_configuration(configuration_file);
  DeviceWorld world;
  Witness witness{configuration, socket};
  std::printf("WORLD ready\n");
  std::fflush(stdout);
  while (world.spi_mode() < 0) sleep_until(hal::linux_os::KernelClock::now().ns() + 1'000'000);
  Verdict verdict;
  Schedule schedule{world, witness};
  verdict.check("spidev was set to mode 3", world.spi_mode() == 3, world.spi_mode());
  undisturbed(schedule, witness, seconds, verdict);
  std::printf("PULSES %ld\n", schedule.pulses());
  std::fflush(stdout);
  schedule.run(4.0, false);  // zerorated's counters are read now
  bus_fault(world, schedule, witness, BusFault::unplugged, "unplugged for five seconds", verdict);
  bus_fault(world, schedule, witness, BusFault::no_answer, "bus hangs for five seconds", verdict);
  bus_fault(world, schedule, witness, BusFault::stuck_high, "data line stuck high", verdict);
  data_ready_lost(world, schedule, witness, verdict);
  odometer_bounces(world, schedule, witness, verdict);
  return verdict.report();
}

}  // namespace
}  // namespace zerorate::emulated

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const int result = zerorate::emulated::run(argv[1], argv[2], std::atof(argv[3]));
  std::fflush(stdout);
  std::_Exit(result);  // the server thread never ends
}
