/// @file
/// Sensor model: Analog Devices ADIS16475-1.
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
                  {.one_minus_phi = 0.63212055F, .noise_variance = 1.2197211e-10F, .initial_variance = 1.4106291e-10F, .initial_mean = 0.0F},
                  {.one_minus_phi = 0.09516258F, .noise_variance = 2.8624767e-11F, .initial_variance = 1.57913e-10F, .initial_mean = 0.0F},
                  {.one_minus_phi = 0.009950167F, .noise_variance = 3.0720457e-12F, .initial_variance = 1.5514343e-10F, .initial_mean = 0.0F},
                  {.one_minus_phi = 0.0009995002F, .noise_variance = 3.1308918e-13F, .initial_variance = 1.5670118e-10F, .initial_mean = 0.0F},
                  {.one_minus_phi = 9.9995e-05F, .noise_variance = 3.070053e-14F, .initial_variance = 1.5351802e-10F, .initial_mean = 0.0F},
                  {.one_minus_phi = 9.99995e-06F, .noise_variance = 3.6309185e-15F, .initial_variance = 1.8154775e-10F, .initial_mean = 0.0F},
              }},
    },
    .white_variance_rad2_s2 = 1.9185093e-07F,
    .measurement_floor_variance_rad2_s2 = 0.0F,
    .turn_on_variance_rad2_s2 = 7.6154356e-07F,
    .gate = {.threshold_sigma = 0.0F, .longest_knock_ticks = 0},
    .motion = {.scale_factor = 0.01F, .asymmetry = 0.0F},
    .sample_period = core::Duration::nanoseconds(10000000),
}};
// clang-format on

}  // namespace zerorate::exported
