/// @file
/// The table of chips: the one list from which boards, the probe and the replay know every gyro.
#pragma once

#include "core/base/compile_time.hpp"
#include "drivers/adxrs453/chip.hpp"
#include "drivers/bmi088/chip.hpp"
#include "drivers/icm42688/chip.hpp"
#include "drivers/lsm6dso/chip.hpp"
#include "drivers/mpu6500/chip.hpp"

namespace zerorate::drivers {

/// ChipEntries, by name.
using AllChips =
    core::TypeList<adxrs453::Chip, lsm6dso::Asm330lhh, bmi088::Chip, icm42688::Chip,
                   lsm6dso::Ism330dhcx, lsm6dso::Chip, lsm6dso::Lsm6dsv16x, mpu6500::Chip>;

}  // namespace zerorate::drivers
