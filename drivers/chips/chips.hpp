/// @file
/// The table of chips: the one list from which boards, the probe and the replay know every gyro.
#pragma once

#include "core/base/compile_time.hpp"
#include "drivers/adis16475/chip.hpp"
#include "drivers/adxrs453/chip.hpp"
#include "drivers/bmi088/chip.hpp"
#include "drivers/bmi160/chip.hpp"
#include "drivers/bmi270/chip.hpp"
#include "drivers/icm20948/chip.hpp"
#include "drivers/icm42688/chip.hpp"
#include "drivers/icm45686/chip.hpp"
#include "drivers/l3gd20h/chip.hpp"
#include "drivers/lsm6dso/chip.hpp"
#include "drivers/mpu6500/chip.hpp"

namespace zerorate::drivers {

/// ChipEntries; each driver lists its own.
using AllChips = core::Joined<adis16475::Chips, adxrs453::Chips, bmi088::Chips, bmi160::Chips,
                              bmi270::Chips, icm20948::Chips, icm42688::Chips, icm45686::Chips,
                              l3gd20h::Chips, lsm6dso::Chips, mpu6500::Chips>;

}  // namespace zerorate::drivers
