/// @file
/// Accelerometer of a simulated chip.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "hal/sim/conversion.hpp"

namespace zerorate::hal::sim {

/// The accelerometer of a simulated chip: specific force, noise and losses as the test sets them,
/// the error after power-up, rounding and clipping.
class SimulatedAccelerometer {
 public:
  using Force = std::array<core::Acceleration, 3>;

  /// Acts from the next conversion on; before the first call, 1 g along z.
  /// @param noise  standard deviation of each axis of a conversion: normal, white, seeded
  void set_specific_force(const Force& force, core::Acceleration noise = {}) {
    force_ = force;
    noise_ = noise;
  }

  /// Loses the acceleration of the next conversions: the chip gives the rates alone.
  void lose_accelerations(int conversions) { lost_ = conversions; }

 protected:
  using Counts = std::array<std::int16_t, 3>;

  /// @param age  time since the accelerometer was switched on
  /// @param turn_on_time  end of an error that falls from 0.5 g to 0; of our choosing
  /// @param lowest, highest  end of the range; the chip clips
  [[nodiscard]] Counts convert_force(double g_per_lsb, core::Duration age,
                                     core::Duration turn_on_time, double lowest = -32768.0,
                                     double highest = 32767.0) {
    constexpr double kTransientG_per_dps = 0.5 / 20.0;
    const double transient_g = kTransientG_per_dps * start_up_transient_dps(age, turn_on_time);
    Counts counts{};
    for (std::size_t axis = 0; axis < counts.size(); ++axis) {
      const double noise_g = normal_(random_) * in_g(noise_);
      counts.at(axis) =
          to_counts((in_g(force_.at(axis)) + noise_g + transient_g) / g_per_lsb, lowest, highest);
    }
    return counts;
  }

  /// Counts of convert_force(); -32768 on each axis where the accelerometer is off or the
  /// conversion is lost.
  [[nodiscard]] Counts convert_force_if(bool is_on, double g_per_lsb, core::Duration age,
                                        core::Duration turn_on_time, double lowest,
                                        double highest) {
    constexpr std::int16_t kNoSample = -32768;
    if (!is_on || take_loss()) return {kNoSample, kNoSample, kNoSample};
    return convert_force(g_per_lsb, age, turn_on_time, lowest, highest);
  }

  /// True if this conversion is one of those that are lost.
  [[nodiscard]] bool take_loss() { return lost_ > 0 && lost_-- > 0; }

 private:
  static double in_g(core::Acceleration force) {
    return static_cast<double>(force.in(core::m_per_s2)) / 9.80665;
  }

  Force force_{core::Acceleration{}, core::Acceleration{}, core::standard_gravity(1.0F)};
  core::Acceleration noise_;
  std::mt19937_64 random_{20261127};
  std::normal_distribution<double> normal_;
  int lost_ = 0;
};

}  // namespace zerorate::hal::sim
