/// @file
/// Types of this board's node, free of the board: a replay on a PC includes them too.
#pragma once

#include "firmware/app/gyro_node.hpp"
#include "firmware/boards/pico/chip.hpp"

namespace zerorate::pico {

/// At ticks of 0.5 s the hold-back of 0.5 s needs 3 of 8 places, and a moving average would
/// remember thirteen hours of one stop (core::SuffixSums). Only what is published runs beside the
/// Kalman predictor. More does not fit into the memory that pico.ld.in grants; where samples are
/// screened each place is larger and there are fewer.
inline constexpr bool kScreens = exported::kNodeParams.samples.is_on();
inline constexpr app::NodeCapacity kNodeCapacity{
    .held_ticks = kScreens ? 4 : 8,
    .average_levels = 12,
    .screens_samples = kScreens,
    .runs_moving_average = exported::kNodeParams.published == app::Predictor::moving_average,
    .runs_calibration_mean = exported::kNodeParams.published == app::Predictor::calibration_mean};
using Node = app::GyroNode<exported::kModelShape, kNodeCapacity>;
static_assert(Node::check(exported::kNodeParams).has_value());

}  // namespace zerorate::pico
