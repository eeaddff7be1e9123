/// @file
/// Signal that effects are added to: one axis of a gyro at a constant sample rate.
#pragma once

#include <cstddef>
#include <vector>

namespace zerorate::simulate {

struct Signal {
  Signal(std::size_t samples, double period_s)
      : sample_period_s(period_s), rate_rad_s(samples), missing(samples) {}

  [[nodiscard]] std::size_t size() const { return rate_rad_s.size(); }
  [[nodiscard]] double time_s(std::size_t k) const {
    return sample_period_s * static_cast<double>(k);
  }

  double sample_period_s;
  std::vector<double> rate_rad_s;
  /// Samples that never arrive; their rate is kept, so that the truth stays known.
  std::vector<bool> missing;
  /// Temperature of each sample where it matters; empty otherwise.
  std::vector<double> temperature_degc;
};

}  // namespace zerorate::simulate
