/// @file
/// What this board's node computes with, free of the board: a replay on a PC includes it too.
#pragma once

#include "drivers/lsm6dso/driver.hpp"
#include "firmware/app/gyro_node.hpp"
#include "firmware/boards/pico/model.hpp"

namespace zerorate::pico {

/// At ticks of 0.5 s the hold-back of 0.5 s needs 3 of 8 places, and thirteen hours of one stop are
/// remembered (core::SuffixSums). More does not fit into the memory that pico.ld grants.
inline constexpr app::NodeCapacity kNodeCapacity{.held_ticks = 8, .average_levels = 12};
using Node = app::GyroNode<exported::kDecayingModes, exported::kRotatingModes,
                           exported::kTemperatureWeights, kNodeCapacity>;
static_assert(Node::check(exported::kNodeParams).has_value());

/// A sample raises data-ready, and is read within its period: no FIFO is needed at 104 Hz.
inline constexpr drivers::lsm6dso::Settings kGyroSettings{
    .full_scale = drivers::lsm6dso::FullScale::dps_250,
    .rate = drivers::lsm6dso::OutputDataRate::hz_104,
    .mode = drivers::lsm6dso::Mode::data_ready};

}  // namespace zerorate::pico
