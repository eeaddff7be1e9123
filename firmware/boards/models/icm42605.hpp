/// @file
/// Sensor model: TDK InvenSense ICM-42605.
/// For 100.000 Hz samples and 2.000 Hz ticks of the filter.
/// Made by `zerorate export --cpp`; change the model and make it again.
#pragma once

#include "core/base/time.hpp"
#include "core/noise/model_shape.hpp"
#include "firmware/app/node_params.hpp"

namespace zerorate::exported {

// clang-format off
inline constexpr core::ModelShape kModelShape{.decaying = 6, .rotating = 0, .inputs = 0, .has_accelerometer = false, .hypotheses = 1};

inline constexpr app::NodeParams<kModelShape> kNodeParams{.model = {
    .modes = {.tick = core::Duration::nanoseconds(500000000),
              .start = core::Start::stationary,
              .is_stationary = true,
              .walk_variance = 0.0F,
              .decaying = {{
                  {.one_minus_phi = 0.63212055F, .noise_variance = 7.6232576e-10F, .initial_variance = 8.816432e-10F, .initial_mean = 0.0F},
                  {.one_minus_phi = 0.09516258F, .noise_variance = 1.7890478e-10F, .initial_variance = 9.869562e-10F, .initial_mean = 0.0F},
                  {.one_minus_phi = 0.009950167F, .noise_variance = 1.9200284e-11F, .initial_variance = 9.696464e-10F, .initial_mean = 0.0F},
                  {.one_minus_phi = 0.0009995002F, .noise_variance = 1.9568073e-12F, .initial_variance = 9.793824e-10F, .initial_mean = 0.0F},
                  {.one_minus_phi = 9.9995e-05F, .noise_variance = 1.9187832e-13F, .initial_variance = 9.594876e-10F, .initial_mean = 0.0F},
                  {.one_minus_phi = 9.99995e-06F, .noise_variance = 2.2693243e-14F, .initial_variance = 1.1346735e-09F, .initial_mean = 0.0F},
              }},
    },
    .white_variance_rad2_s2 = 2.2958072e-07F,
    .measurement_floor_variance_rad2_s2 = 0.0F,
    .turn_on_variance_rad2_s2 = 3.0461742e-06F,
    .largest_bias_rad_s = 0.04363323F,
    .gate = {.threshold_sigma = 0.0F, .longest_knock_ticks = 0},
    .motion = {.scale_factor = 0.01F, .asymmetry = 0.0F},
    .sample_period = core::Duration::nanoseconds(10000000),
}};
// clang-format on

}  // namespace zerorate::exported
