#include "firmware/boards/linux/gyro.hpp"

#include <algorithm>
#include <array>

#include "firmware/boards/linux/gyro_descriptions.hpp"

namespace zerorate::linux_node {

std::span<const ChipDescription> chips() {
  static const std::array kChips{describe_adxrs453(), describe_bmi088(), describe_icm42688(),
                                 describe_lsm6dso()};
  return kChips;
}

const ChipDescription* find_chip(std::string_view name) {
  const auto found = std::ranges::find(chips(), name, &ChipDescription::name);
  return found == chips().end() ? nullptr : &*found;
}

}  // namespace zerorate::linux_node
