/// @file
/// Sensor model: TDK InvenSense ICM-20689.
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
                  {.one_minus_phi = 0.63212055F, .noise_variance = 6.8609314e-09F, .initial_variance = 7.934789e-09F, .initial_mean = 0.0F},
                  {.one_minus_phi = 0.09516258F, .noise_variance = 1.6101431e-09F, .initial_variance = 8.882606e-09F, .initial_mean = 0.0F},
                  {.one_minus_phi = 0.009950167F, .noise_variance = 1.7280256e-10F, .initial_variance = 8.7268175e-09F, .initial_mean = 0.0F},
                  {.one_minus_phi = 0.0009995002F, .noise_variance = 1.7611267e-11F, .initial_variance = 8.814442e-09F, .initial_mean = 0.0F},
                  {.one_minus_phi = 9.9995e-05F, .noise_variance = 1.7269049e-12F, .initial_variance = 8.635388e-09F, .initial_mean = 0.0F},
                  {.one_minus_phi = 9.99995e-06F, .noise_variance = 2.0423919e-13F, .initial_variance = 1.0212061e-08F, .initial_mean = 0.0F},
              }},
    },
    .white_variance_rad2_s2 = 1.6050357e-06F,
    .measurement_floor_variance_rad2_s2 = 0.0F,
    .turn_on_variance_rad2_s2 = 3.0461742e-06F,
    .largest_bias_rad_s = 0.43633232F,
    .gate = {.threshold_sigma = 0.0F, .longest_knock_ticks = 0},
    .motion = {.scale_factor = 0.01F, .asymmetry = 0.0F},
    .sample_period = core::Duration::nanoseconds(10000000),
}};
// clang-format on

}  // namespace zerorate::exported
