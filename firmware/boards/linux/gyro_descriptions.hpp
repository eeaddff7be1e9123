/// @file
/// One function for each chip; what they give is listed in gyro.cpp.
#pragma once

#include "firmware/boards/linux/gyro.hpp"

namespace zerorate::linux_node {

[[nodiscard]] ChipDescription describe_adxrs453();
[[nodiscard]] ChipDescription describe_bmi088();
[[nodiscard]] ChipDescription describe_icm42688();
[[nodiscard]] ChipDescription describe_lsm6dso();

}  // namespace zerorate::linux_node
