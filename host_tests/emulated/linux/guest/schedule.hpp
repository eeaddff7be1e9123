/// @file
/// Stops and drives on a fixed schedule, the same in every run.
#pragma once

#include <cstdint>
#include <ctime>
#include <functional>

#include "host_tests/emulated/linux/guest/device_world.hpp"
#include "host_tests/emulated/linux/guest/witness.hpp"

namespace zerorate::emulated {

inline constexpr std::int64_t kSecond_ns = 1'000'000'000;
inline constexpr std::int64_t kSample104Hz_ns = 9'615'385;

inline void sleep_until(std::int64_t time_ns) {
  // On 32 bits the fields are narrower than the count; its seconds fit.
  const std::timespec until{.tv_sec = static_cast<std::time_t>(time_ns / kSecond_ns),
                            .tv_nsec = static_cast<long>(time_ns % kSecond_ns)};
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

/// 25 s of rest, 15 s of driving in a bend of 12 deg/s, and so on.
class Schedule {
 public:
  static constexpr std::int64_t kPulse_ns = 4'000'000;  // 250 Hz
  static constexpr float kNoise_dps = 0.028F;           // one sample of an LSM6DSO
  static constexpr std::int64_t kStop_s = 25;
  static constexpr std::int64_t kDrive_s = 15;

  /// @param axes  of the gyro: with one, the same rate is expected on all three
  /// @param lead_ns  until the first sample
  /// @param after_each_sample  is called then
  Schedule(DeviceWorld& world, Witness& witness, std::size_t axes, std::int64_t sample_ns,
           std::int64_t lead_ns, std::function<void()> after_each_sample)
      : world_(world),
        witness_(witness),
        axes_(axes),
        sample_ns_(sample_ns),
        after_each_sample_(std::move(after_each_sample)),
        start_(hal::linux_os::KernelClock::now().ns() + lead_ns) {}

  /// @param with_pulses  whether the odometer gives any
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
        next_sample_ += sample_ns_;
      }
    }
    witness_.receive();
  }

  /// The gyro goes on measuring, the same again and again.
  void set_frozen(bool is_frozen) { is_frozen_ = is_frozen; }

  [[nodiscard]] core::Instant start() const { return core::Instant::from_ns(start_); }
  [[nodiscard]] long samples() const { return samples_; }
  [[nodiscard]] long pulses() const { return pulses_; }

 private:
  [[nodiscard]] bool is_moving(std::int64_t time_ns) const {
    return (time_ns - start_) / kSecond_ns % (kStop_s + kDrive_s) >= kStop_s;
  }

  void sample() {
    if (!is_frozen_) rate_ = next_rate();
    witness_.expect(rate_);
    world_.measure(rate_);
    ++samples_;
    witness_.receive();
    after_each_sample_();
  }

  std::array<core::AngularRate, 3> next_rate() {
    const float turn_dps = is_moving(next_sample_) ? 12.0F : 0.0F;
    std::array rate{core::deg_per_s(0.35F + kNoise_dps * noise_.next()),
                    core::deg_per_s(-0.2F + kNoise_dps * noise_.next()),
                    core::deg_per_s(turn_dps + 0.1F + kNoise_dps * noise_.next())};
    if (axes_ == 1) rate.fill(rate[2]);
    return rate;
  }

  DeviceWorld& world_;
  Witness& witness_;
  std::size_t axes_;
  std::int64_t sample_ns_;
  std::function<void()> after_each_sample_;
  Noise noise_;
  bool is_frozen_ = false;
  std::array<core::AngularRate, 3> rate_{};
  std::int64_t start_;
  std::int64_t next_sample_ = start_;
  std::int64_t next_pulse_ = start_;
  long samples_ = 0;
  long pulses_ = 0;
};

}  // namespace zerorate::emulated
