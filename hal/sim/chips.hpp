/// @file
/// Every simulated chip, each of the same name as its line in the table of chips (drivers/chips).
#pragma once

#include "core/base/compile_time.hpp"
#include "hal/sim/adis16475.hpp"
#include "hal/sim/adxrs453.hpp"
#include "hal/sim/bmi088.hpp"
#include "hal/sim/bmi160.hpp"
#include "hal/sim/bmi270.hpp"
#include "hal/sim/icm20948.hpp"
#include "hal/sim/icm42688.hpp"
#include "hal/sim/icm45686.hpp"
#include "hal/sim/l3gd20h.hpp"
#include "hal/sim/lsm6dsl.hpp"
#include "hal/sim/lsm6dso.hpp"
#include "hal/sim/lsm6dsv16x.hpp"
#include "hal/sim/mpu6500.hpp"

namespace zerorate::hal::sim {

using AllSimulatedChips = core::TypeList<
    SimulatedAdis16470, SimulatedAdis16475Part1, SimulatedAdis16475Part2, SimulatedAdis16475Part3,
    SimulatedAdxrs453, SimulatedAsm330lhh, SimulatedBmi088, SimulatedBmi160, SimulatedBmi270,
    SimulatedIcm20602, SimulatedIcm20689, SimulatedIcm20948, SimulatedIcm42605, SimulatedIcm42688,
    SimulatedIcm45686, SimulatedIim42652, SimulatedIsm330dhcx, SimulatedL3g4200d, SimulatedL3gd20,
    SimulatedL3gd20h, SimulatedLsm6ds3trC, SimulatedLsm6dsl, SimulatedLsm6dso, SimulatedLsm6dsox,
    SimulatedLsm6dsr, SimulatedLsm6dsv16x, SimulatedMpu6500, SimulatedMpu6886>;

}  // namespace zerorate::hal::sim
