#include "host_tools/lib/identify/levels_near_zero.hpp"

#include <cmath>
#include <iterator>

namespace zerorate::identify {

void LevelsNearZero::take(float value) {
  if (counts_.size() == kMost) {
    // A value farther away than all that are kept never comes back among the nearest.
    const auto lowest = counts_.begin();
    const auto highest = std::prev(counts_.end());
    const auto farthest = std::abs(lowest->first) > std::abs(highest->first) ? lowest : highest;
    if (std::abs(value) > std::abs(farthest->first)) return;
    if (!counts_.contains(value)) counts_.erase(farthest);
  }
  ++counts_[value];
}

}  // namespace zerorate::identify
