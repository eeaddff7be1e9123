/// @file
/// How often a sensor gives each of the values nearest zero.
#pragma once

#include <cstddef>
#include <map>

namespace zerorate::identify {

/// Counts of the distinct values nearest zero; those farther away are forgotten. Memory: fixed.
class LevelsNearZero {
 public:
  static constexpr std::size_t kMost = 65;  ///< distinct values that are kept

  /// @param value  finite
  void take(float value);
  /// Values in ascending order, with their counts, which are complete.
  [[nodiscard]] const std::map<float, std::size_t>& counts() const { return counts_; }

 private:
  std::map<float, std::size_t> counts_;
};

}  // namespace zerorate::identify
