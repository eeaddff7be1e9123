/// @file
/// Jumps of a reference's heading: places where reference and gyro part and the gyro is not at
/// fault.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_tools/lib/truth/track.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace zerorate::truth {

/// Looks for places where reference and gyro part for good, not only for a latency: by more than
/// 5 deg and 20 times what is usual, within 6 s. A gyro that repeats one value, or has a wild one,
/// parts from its reference as well. Such a place is no jump of the reference.
class HeadingJumps {
 public:
  /// @param heading of the track, with its whole turns
  HeadingJumps(const Track& track, const Series& heading, const VerticalAxis& vertical);

  [[nodiscard]] bool has_between(std::int64_t from_ns, std::int64_t to_ns) const;

 private:
  /// Turns between two headings of the reference [rad].
  struct Step {
    double reference_rad;
    double gyro_rad;
    double length_s;
  };
  [[nodiscard]] Step step(std::size_t k) const;
  [[nodiscard]] bool is_spike(std::size_t k) const;
  [[nodiscard]] bool repeats(std::size_t k) const;
  [[nodiscard]] bool is_fault_of_gyro(std::size_t k, double parted_rad) const;
  void find(const Series& parted);

  const Series& heading_;
  std::vector<double> turned_rad_;  ///< turn about the vertical axis
  std::int64_t longest_ns_;
  std::vector<std::int64_t> jumps_ns_;
};

}  // namespace zerorate::truth
