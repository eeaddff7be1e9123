/// @file
/// A watch for odometer pulses that no motion belongs to.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/common/gyro_source.hpp"

namespace zerorate::app {

/// Finds a wheel sensor that stands on the edge of a tooth and chatters: pulses come, and the gyro
/// shows its own noise and nothing else on all axes. A vehicle that drives shakes and sways.
///
/// Windows of five seconds are judged. In a quiet one the variance of each axis is at most 1.5
/// times that of the white noise: 500 samples show it to 6 %, and the learnt white noise is known
/// to 9 %. Its mean is the bias, within 0.25 deg/s: a steady turn is a drive. Two quiet windows
/// with pulses are chatter. A gyro louder than 0.1 deg/s a sample cannot tell, nor one whose noise
/// was not learnt at a stop.
class ChatterWatch {
 public:
  static constexpr std::size_t kAxes = 3;

  constexpr void pulse() { ++pulses_; }

  /// Takes each sample in turn.
  /// @param bias_rad_s, white_rad2_s2  functions of an axis: its bias, and the variance of the
  /// white
  ///   noise of a sample; asked for at the end of a window
  template <class Bias, class White>
  constexpr void take(const drivers::GyroSample& sample, bool is_calibrated, Bias bias_rad_s,
                      White white_rad2_s2) {
    if (samples_ == 0) begin_window(sample);
    ++samples_;
    for (std::size_t i = 0; i < kAxes; ++i) {
      const float rate = sample.rate[i].in(core::rad_per_s)-first_rad_s_[i];
      sum_[i] += rate;
      squares_[i] += rate * rate;
    }
    if (sample.time - began_at_ < kWindow) return;
    const bool is_quiet = is_calibrated && pulses_ > 0 && samples_ >= kFewestSamples &&
                          shows_noise_alone(bias_rad_s, white_rad2_s2);
    chatters_ = is_quiet && was_quiet_;
    was_quiet_ = is_quiet;
    samples_ = 0;
    pulses_ = 0;
  }

  [[nodiscard]] constexpr bool chatters() const { return chatters_; }

 private:
  static constexpr core::Duration kWindow = core::Duration::seconds(5);
  static constexpr std::uint32_t kFewestSamples = 250;

  constexpr void begin_window(const drivers::GyroSample& sample) {
    began_at_ = sample.time;
    for (std::size_t i = 0; i < kAxes; ++i) first_rad_s_[i] = sample.rate[i].in(core::rad_per_s);
    sum_ = {};
    squares_ = {};
  }

  template <class Bias, class White>
  [[nodiscard]] constexpr bool shows_noise_alone(Bias bias_rad_s, White white_rad2_s2) const {
    constexpr float kTurn_rad_s = 0.25F * core::kRadPerDeg;
    constexpr float kLoudest_rad_s = 0.1F * core::kRadPerDeg;
    constexpr float kMost = 1.5F;
    const float samples = core::to_float(samples_);
    for (std::size_t i = 0; i < kAxes; ++i) {
      const float white = white_rad2_s2(i);
      const float mean = sum_[i] / samples;
      const float variance = squares_[i] / samples - mean * mean;
      const float turn = first_rad_s_[i] + mean - bias_rad_s(i);
      if (turn * turn > kTurn_rad_s * kTurn_rad_s) return false;
      if (white > kLoudest_rad_s * kLoudest_rad_s || variance > kMost * white) return false;
    }
    return true;
  }

  core::Instant began_at_;
  std::uint32_t samples_ = 0;
  std::uint32_t pulses_ = 0;
  std::array<float, kAxes> first_rad_s_{};
  std::array<float, kAxes> sum_{};
  std::array<float, kAxes> squares_{};
  bool was_quiet_ = false;
  bool chatters_ = false;
};

}  // namespace zerorate::app
