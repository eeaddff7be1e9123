/// @file
/// Sensor model: STMicroelectronics LSM6DSO.
/// For 104.172 Hz samples and 2.000 Hz ticks of the filter.
/// Made by `zerorate export --cpp`; change the model and make it again.
#pragma once

#include "core/base/time.hpp"
#include "core/noise/model_shape.hpp"
#include "firmware/app/node_params.hpp"

namespace zerorate::exported {

// clang-format off
inline constexpr core::ModelShape kModelShape{.decaying = 6, .rotating = 0, .inputs = 0, .has_accelerometer = false, .hypotheses = 12};

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
    .white_variance_rad2_s2 = 2.3915854e-07F,
    .measurement_floor_variance_rad2_s2 = 0.0F,
    .turn_on_variance_rad2_s2 = 3.0461742e-06F,
    .largest_bias_rad_s = 0.08726646F,
    .gate = {.threshold_sigma = 0.0F, .longest_knock_ticks = 0},
    .motion = {.scale_factor = 0.01F, .asymmetry = 0.0F},
    .sample_period = core::Duration::nanoseconds(9599520),
    .hypotheses = {.count = 12, .kept = 0.99769217F, .all = {{
        {.strength = {0.015977569F, 0.015977569F, 0.015977569F, 0.015977569F, 0.015977569F, 0.015977569F},
         .log_prior = -1.17375F, .level = 0.015977569F, .order = 0.5F,
         .bias_instability_rad_s = 4.6126174e-06F, .angle_random_walk_rad_per_sqrt_s = 4.7899313e-05F},
        {.strength = {0.20453808F, 0.20453808F, 0.20453808F, 0.20453808F, 0.20453808F, 0.20453808F},
         .log_prior = -0.76125F, .level = 0.20453808F, .order = 0.5F,
         .bias_instability_rad_s = 1.6503618e-05F, .angle_random_walk_rad_per_sqrt_s = 4.7718746e-05F},
        {.strength = {2.4048364F, 2.4048364F, 2.4048364F, 2.4048364F, 2.4048364F, 2.4048364F},
         .log_prior = -0.34875F, .level = 2.4048364F, .order = 0.5F,
         .bias_instability_rad_s = 5.6589368e-05F, .angle_random_walk_rad_per_sqrt_s = 4.555884e-05F},
        {.strength = {14.486516F, 14.486516F, 14.486516F, 14.486516F, 14.486516F, 14.486516F},
         .log_prior = 0.06375F, .level = 14.486516F, .order = 0.5F,
         .bias_instability_rad_s = 0.00013889099F, .angle_random_walk_rad_per_sqrt_s = 3.1134354e-05F},
        {.strength = {0.0008737008F, 0.0019658175F, 0.004510442F, 0.01045552F, 0.022838015F, 0.065685555F},
         .log_prior = -1.005F, .level = 0.0044515613F, .order = 0.68F,
         .bias_instability_rad_s = 1.3199772e-06F, .angle_random_walk_rad_per_sqrt_s = 4.7914407e-05F},
        {.strength = {0.0112685785F, 0.025354182F, 0.058173534F, 0.13485032F, 0.29455388F, 0.84718114F},
         .log_prior = -0.5925F, .level = 0.057414122F, .order = 0.68F,
         .bias_instability_rad_s = 4.7404505e-06F, .angle_random_walk_rad_per_sqrt_s = 4.791233e-05F},
        {.strength = {0.14518704F, 0.3266693F, 0.7495217F, 1.7374437F, 3.7951021F, 10.915283F},
         .log_prior = -0.18F, .level = 0.7397372F, .order = 0.68F,
         .bias_instability_rad_s = 1.7015667e-05F, .angle_random_walk_rad_per_sqrt_s = 4.788557e-05F},
        {.strength = {1.8461217F, 4.153754F, 9.530521F, 22.092415F, 48.25651F, 138.79297F},
         .log_prior = 0.2325F, .level = 9.406108F, .order = 0.68F,
         .bias_instability_rad_s = 6.067576e-05F, .angle_random_walk_rad_per_sqrt_s = 4.7544345e-05F},
        {.strength = {20.125956F, 45.283188F, 103.89935F, 240.84596F, 526.0804F, 1513.0862F},
         .log_prior = 0.645F, .level = 102.54302F, .order = 0.68F,
         .bias_instability_rad_s = 0.00020033799F, .angle_random_walk_rad_per_sqrt_s = 4.370941e-05F},
        {.strength = {0.004362568F, 0.04404013F, 0.4365106F, 0.0F, 0.0F, 7603.0107F},
         .log_prior = -6.67F, .level = 8.05585F, .order = 0.99F,
         .bias_instability_rad_s = 1.9564031e-05F, .angle_random_walk_rad_per_sqrt_s = 4.7914582e-05F},
        {.strength = {0.06673021F, 0.6736416F, 6.6769032F, 0.0F, 0.0F, 116296.305F},
         .log_prior = -6.23F, .level = 123.22296F, .order = 0.99F,
         .bias_instability_rad_s = 7.651534e-05F, .angle_random_walk_rad_per_sqrt_s = 4.7914582e-05F},
        {.strength = {1.0207111F, 10.304079F, 102.130486F, 0.0F, 0.0F, 1778878.2F},
         .log_prior = -5.79F, .level = 1884.829F, .order = 0.99F,
         .bias_instability_rad_s = 0.0002992531F, .angle_random_walk_rad_per_sqrt_s = 4.7914582e-05F},
    }}},
}};
// clang-format on

}  // namespace zerorate::exported
