/// @file
/// Scenarios that the emulated machine goes through. Each scenario has a zerorated of its own.
#pragma once

#include "host_tests/emulated/linux/guest/device_world.hpp"
#include "host_tests/emulated/linux/guest/verdict.hpp"

namespace zerorate::emulated {

/// Stops and drives without a fault; leaves /run/recording.csv and /run/monitor.txt.
void drive_undisturbed(DeviceWorld& world, Verdict& verdict, double seconds);

/// Measures the cost of zerorated at 1 kHz.
void measure_cost(DeviceWorld& world, Verdict& verdict);

/// Wrong chip, unplugged, hanging, stuck and noisy buses, a full FIFO.
void break_the_bus(DeviceWorld& world, Verdict& verdict);

/// Data-ready and the odometer.
void break_the_lines(DeviceWorld& world, Verdict& verdict);

/// The wall clock, the disk, the receivers, and ends at a bad moment.
void break_the_system(DeviceWorld& world, Verdict& verdict);

}  // namespace zerorate::emulated
