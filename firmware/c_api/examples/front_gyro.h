/** @file Sensor model: STMicroelectronics LSM6DSO.
 *  For 100.000 Hz samples and 2.000 Hz ticks of the filter.
 *  Made by `zerorate export --c`; change the model and make it again. */
#ifndef FRONT_GYRO_H
#define FRONT_GYRO_H

#include <zerorate.h>

// clang-format off
static const zerorate_model front_gyro = {
    .sample_period_ns = INT64_C(10000000),
    .tick_ns = INT64_C(500000000),
    .starts_stationary = true,
    .is_stationary = true,
    .walk_variance_rad2_s2 = 0.0F,
    .white_variance_rad2_s2 = 2.2958072e-07F,
    .measurement_floor_variance_rad2_s2 = 0.0F,
    .turn_on_variance_rad2_s2 = 3.0461742e-06F,
    .largest_bias_rad_s = 0.08726646F,
    .gate_threshold_sigma = 0.0F,
    .gate_longest_knock_ticks = 0,
    .decaying = {
        {.one_minus_phi = 0.63212055F, .noise_variance = 7.6232576e-10F, .initial_variance = 8.816432e-10F, .initial_mean = 0.0F},
        {.one_minus_phi = 0.09516258F, .noise_variance = 1.7890478e-10F, .initial_variance = 9.869562e-10F, .initial_mean = 0.0F},
        {.one_minus_phi = 0.009950167F, .noise_variance = 1.9200284e-11F, .initial_variance = 9.696464e-10F, .initial_mean = 0.0F},
        {.one_minus_phi = 0.0009995002F, .noise_variance = 1.9568073e-12F, .initial_variance = 9.793824e-10F, .initial_mean = 0.0F},
        {.one_minus_phi = 9.9995e-05F, .noise_variance = 1.9187832e-13F, .initial_variance = 9.594876e-10F, .initial_mean = 0.0F},
        {.one_minus_phi = 9.99995e-06F, .noise_variance = 2.2693243e-14F, .initial_variance = 1.1346735e-09F, .initial_mean = 0.0F},
    },
#if ZERORATE_HYPOTHESES >= 12
    .hypothesis_count = 12,
    .evidence_kept = 0.99654025F,
    .hypotheses = {
        {.strength = {0.00085667626F, 0.00085667626F, 0.00085667626F, 0.00085667626F, 0.00085667626F, 0.00085667626F, 0.0F},
         .log_prior = -1.3333334F, .level = 0.00085667626F, .order = 0.5F,
         .bias_instability_rad_s = 1.0680718e-06F, .angle_random_walk_rad_per_sqrt_s = 4.7913763e-05F},
        {.strength = {0.025888585F, 0.025888585F, 0.025888585F, 0.025888585F, 0.025888585F, 0.025888585F, 0.0F},
         .log_prior = -0.93333334F, .level = 0.025888585F, .order = 0.5F,
         .bias_instability_rad_s = 5.871462e-06F, .angle_random_walk_rad_per_sqrt_s = 4.788984e-05F},
        {.strength = {0.76017135F, 0.76017135F, 0.76017135F, 0.76017135F, 0.76017135F, 0.76017135F, 0.0F},
         .log_prior = -0.53333336F, .level = 0.76017135F, .order = 0.5F,
         .bias_instability_rad_s = 3.1816166e-05F, .angle_random_walk_rad_per_sqrt_s = 4.7182646e-05F},
        {.strength = {12.187317F, 12.187317F, 12.187317F, 12.187317F, 12.187317F, 12.187317F, 0.0F},
         .log_prior = -0.13333334F, .level = 12.187317F, .order = 0.5F,
         .bias_instability_rad_s = 0.00012739317F, .angle_random_walk_rad_per_sqrt_s = 3.43493e-05F},
        {.strength = {0.00093729503F, 0.0016107395F, 0.0028041415F, 0.0048994375F, 0.008320207F, 0.016367706F, 0.0F},
         .log_prior = -0.7F, .level = 0.0026693172F, .order = 0.62F,
         .bias_instability_rad_s = 1.2535384e-06F, .angle_random_walk_rad_per_sqrt_s = 4.791422e-05F},
        {.strength = {0.028340714F, 0.04870346F, 0.08478801F, 0.14814286F, 0.25157565F, 0.49490547F, 0.0F},
         .log_prior = -0.3F, .level = 0.08071136F, .order = 0.62F,
         .bias_instability_rad_s = 6.8929457e-06F, .angle_random_walk_rad_per_sqrt_s = 4.7903693e-05F},
        {.strength = {0.84605956F, 1.4539516F, 2.531189F, 4.4225307F, 7.510325F, 14.7744875F, 0.0F},
         .log_prior = 0.1F, .level = 2.4094882F, .order = 0.62F,
         .bias_instability_rad_s = 3.7661703e-05F, .angle_random_walk_rad_per_sqrt_s = 4.758843e-05F},
        {.strength = {18.32214F, 31.486559F, 54.815052F, 95.77367F, 162.64249F, 319.9541F, 0.0F},
         .log_prior = 0.5F, .level = 52.17952F, .order = 0.62F,
         .bias_instability_rad_s = 0.00017526191F, .angle_random_walk_rad_per_sqrt_s = 4.0264873e-05F},
        {.strength = {0.0008680699F, 0.0025566628F, 0.0077184746F, 0.023857761F, 0.065820836F, 0.290163F, 0.0F},
         .log_prior = -1.0666667F, .level = 0.008317271F, .order = 0.74F,
         .bias_instability_rad_s = 1.4712058e-06F, .angle_random_walk_rad_per_sqrt_s = 4.791453e-05F},
        {.strength = {0.026257444F, 0.077334136F, 0.23346902F, 0.72165143F, 1.9909537F, 8.776873F, 0.0F},
         .log_prior = -0.6666667F, .level = 0.2515815F, .order = 0.74F,
         .bias_instability_rad_s = 8.091375e-06F, .angle_random_walk_rad_per_sqrt_s = 4.7913007e-05F},
        {.strength = {0.79276365F, 2.334869F, 7.048887F, 21.788069F, 60.110786F, 264.99097F, 0.0F},
         .log_prior = -0.26666668F, .level = 7.595737F, .order = 0.74F,
         .bias_instability_rad_s = 4.4459845e-05F, .angle_random_walk_rad_per_sqrt_s = 4.786702e-05F},
        {.strength = {22.665524F, 66.75511F, 201.53133F, 622.9321F, 1718.5985F, 7576.229F, 0.0F},
         .log_prior = 0.13333334F, .level = 217.16606F, .order = 0.74F,
         .bias_instability_rad_s = 0.00023772725F, .angle_random_walk_rad_per_sqrt_s = 4.6535533e-05F},
    },
#endif
};
// clang-format on

#endif
