/// @file
/// Sensor model: STMicroelectronics LSM6DSO.
/// Made by `zerorate export --cpp`; change the model and make it again.
#pragma once

#include "core/base/time.hpp"
#include "core/noise/model_shape.hpp"
#include "firmware/app/node_params.hpp"

namespace zerorate::exported {

// clang-format off
inline constexpr core::ModelShape kModelShape{.decaying = 6, .rotating = 0, .temperature_weights = 0, .hypotheses = 12};

inline constexpr app::NodeParams<kModelShape> kNodeParams{
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
    .white_variance_rad2_s2 = 2.3915854e-07F,
    .measurement_floor_variance_rad2_s2 = 0.0F,
    .turn_on_variance_rad2_s2 = 3.0461742e-06F,
    .gate = {.threshold_sigma = 0.0F, .longest_knock_ticks = 0},
    .sample_period = core::Duration::nanoseconds(9599520),
    .hypotheses = {.count = 12, .kept = 0.99654025F, .all = {{
        {.strength = {0.0028492906F, 0.0028492906F, 0.0028492906F, 0.0028492906F, 0.0028492906F, 0.0028492906F},
         .log_prior = -1.4166666F, .level = 0.0028492906F, .order = 0.5F,
         .bias_instability_rad_s = 1.947872e-06F, .angle_random_walk_rad_per_sqrt_s = 4.791186e-05F},
        {.strength = {0.071038514F, 0.071038514F, 0.071038514F, 0.071038514F, 0.071038514F, 0.071038514F},
         .log_prior = -0.9166667F, .level = 0.071038514F, .order = 0.5F,
         .bias_instability_rad_s = 9.726106e-06F, .angle_random_walk_rad_per_sqrt_s = 4.7846657e-05F},
        {.strength = {1.6628889F, 1.6628889F, 1.6628889F, 1.6628889F, 1.6628889F, 1.6628889F},
         .log_prior = -0.41666666F, .level = 1.6628889F, .order = 0.5F,
         .bias_instability_rad_s = 4.7056943e-05F, .angle_random_walk_rad_per_sqrt_s = 4.629843e-05F},
        {.strength = {16.040346F, 16.040346F, 16.040346F, 16.040346F, 16.040346F, 16.040346F},
         .log_prior = 0.083333336F, .level = 16.040346F, .order = 0.5F,
         .bias_instability_rad_s = 0.00014615004F, .angle_random_walk_rad_per_sqrt_s = 2.875885e-05F},
        {.strength = {0.0029256465F, 0.0050277174F, 0.00875277F, 0.015292969F, 0.02597046F, 0.051089697F},
         .log_prior = -0.75F, .level = 0.008331932F, .order = 0.62F,
         .bias_instability_rad_s = 2.214677e-06F, .angle_random_walk_rad_per_sqrt_s = 4.7913458e-05F},
        {.strength = {0.0730589F, 0.12555157F, 0.21857312F, 0.3818942F, 0.64853126F, 1.275806F},
         .log_prior = -0.25F, .level = 0.20806403F, .order = 0.62F,
         .bias_instability_rad_s = 1.1067156e-05F, .angle_random_walk_rad_per_sqrt_s = 4.7886508e-05F},
        {.strength = {1.7765203F, 3.0529463F, 5.314884F, 9.286244F, 15.769864F, 31.022846F},
         .log_prior = 0.25F, .level = 5.059342F, .order = 0.62F,
         .bias_instability_rad_s = 5.4573844e-05F, .angle_random_walk_rad_per_sqrt_s = 4.7227142e-05F},
        {.strength = {26.377808F, 45.330208F, 78.915504F, 137.88234F, 234.15126F, 460.62784F},
         .log_prior = 0.75F, .level = 75.12121F, .order = 0.62F,
         .bias_instability_rad_s = 0.00021029009F, .angle_random_walk_rad_per_sqrt_s = 3.639619e-05F},
        {.strength = {0.002542829F, 0.007489208F, 0.022609655F, 0.06988631F, 0.19280834F, 0.8499718F},
         .log_prior = -1.0833334F, .level = 0.024363706F, .order = 0.74F,
         .bias_instability_rad_s = 2.5179938e-06F, .angle_random_walk_rad_per_sqrt_s = 4.791443e-05F},
        {.strength = {0.063561015F, 0.1872016F, 0.565155F, 1.746891F, 4.8194723F, 21.246048F},
         .log_prior = -0.5833333F, .level = 0.6089996F, .order = 0.74F,
         .bias_instability_rad_s = 1.2589007e-05F, .angle_random_walk_rad_per_sqrt_s = 4.791077e-05F},
        {.strength = {1.5829809F, 4.662238F, 14.075131F, 43.50615F, 120.028496F, 529.1308F},
         .log_prior = -0.083333336F, .level = 15.167076F, .order = 0.74F,
         .bias_instability_rad_s = 6.28252e-05F, .angle_random_walk_rad_per_sqrt_s = 4.781956e-05F},
        {.strength = {36.137905F, 106.43434F, 321.3215F, 993.20294F, 2740.1333F, 12079.539F},
         .log_prior = 0.41666666F, .level = 346.24954F, .order = 0.74F,
         .bias_instability_rad_s = 0.0003001771F, .angle_random_walk_rad_per_sqrt_s = 4.569611e-05F},
    }}},
};
// clang-format on

}  // namespace zerorate::exported
