/** @file Sensor model: STMicroelectronics LSM6DSO.
 *  For 100.000 Hz samples and 2.000 Hz ticks of the filter.
 *  Made by `zerorate export --c`; change the model and make it again. */
#ifndef FRONT_GYRO_H
#define FRONT_GYRO_H

#include <zerorate.h>

#if ZERORATE_DECAYING_MODES < 6
#error "this model needs ZERORATE_DECAYING_MODES of 6 or more"
#endif

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
    .evidence_kept = 0.99769217F,
    .hypotheses = {
        {.strength = {0.0016005534F, 0.0016005534F, 0.0016005534F, 0.0016005534F, 0.0016005534F, 0.0016005534F},
         .log_prior = -1.545F, .level = 0.0016005534F, .order = 0.5F,
         .bias_instability_rad_s = 1.4599136e-06F, .angle_random_walk_rad_per_sqrt_s = 4.7913054e-05F},
        {.strength = {0.012374246F, 0.012374246F, 0.012374246F, 0.012374246F, 0.012374246F, 0.012374246F},
         .log_prior = -1.215F, .level = 0.012374246F, .order = 0.5F,
         .bias_instability_rad_s = 4.0593027e-06F, .angle_random_walk_rad_per_sqrt_s = 4.790276e-05F},
        {.strength = {0.095392205F, 0.095392205F, 0.095392205F, 0.095392205F, 0.095392205F, 0.095392205F},
         .log_prior = -0.885F, .level = 0.095392205F, .order = 0.5F,
         .bias_instability_rad_s = 1.1270638e-05F, .angle_random_walk_rad_per_sqrt_s = 4.782335e-05F},
        {.strength = {0.7193839F, 0.7193839F, 0.7193839F, 0.7193839F, 0.7193839F, 0.7193839F},
         .log_prior = -0.555F, .level = 0.7193839F, .order = 0.5F,
         .bias_instability_rad_s = 3.095084e-05F, .angle_random_walk_rad_per_sqrt_s = 4.7222205e-05F},
        {.strength = {4.6630864F, 4.6630864F, 4.6630864F, 4.6630864F, 4.6630864F, 4.6630864F},
         .log_prior = -0.225F, .level = 4.6630864F, .order = 0.5F,
         .bias_instability_rad_s = 7.880047e-05F, .angle_random_walk_rad_per_sqrt_s = 4.3229982e-05F},
        {.strength = {16.011957F, 16.011957F, 16.011957F, 16.011957F, 16.011957F, 16.011957F},
         .log_prior = 0.105F, .level = 16.011957F, .order = 0.5F,
         .bias_instability_rad_s = 0.00014602065F, .angle_random_walk_rad_per_sqrt_s = 2.8804006e-05F},
        {.strength = {0.0008737008F, 0.0019658175F, 0.004510442F, 0.01045552F, 0.022838015F, 0.065685555F},
         .log_prior = -1.005F, .level = 0.0044515613F, .order = 0.68F,
         .bias_instability_rad_s = 1.3199772e-06F, .angle_random_walk_rad_per_sqrt_s = 4.7914407e-05F},
        {.strength = {0.006757354F, 0.015203975F, 0.03488454F, 0.0808648F, 0.17663316F, 0.5080235F},
         .log_prior = -0.675F, .level = 0.034429148F, .order = 0.68F,
         .bias_instability_rad_s = 3.670907e-06F, .angle_random_walk_rad_per_sqrt_s = 4.7913232e-05F},
        {.strength = {0.052245285F, 0.11755134F, 0.26971397F, 0.6252159F, 1.3656604F, 3.9278443F},
         .log_prior = -0.345F, .level = 0.26619306F, .order = 0.68F,
         .bias_instability_rad_s = 1.0207247e-05F, .angle_random_walk_rad_per_sqrt_s = 4.7904145e-05F},
        {.strength = {0.4029118F, 0.9065473F, 2.0800142F, 4.821619F, 10.531873F, 30.291246F},
         .log_prior = -0.015F, .level = 2.0528612F, .order = 0.68F,
         .bias_instability_rad_s = 2.8345887e-05F, .angle_random_walk_rad_per_sqrt_s = 4.7834023e-05F},
        {.strength = {3.0473905F, 6.856597F, 15.732018F, 36.467922F, 79.65696F, 229.10538F},
         .log_prior = 0.315F, .level = 15.5266485F, .order = 0.68F,
         .bias_instability_rad_s = 7.795593e-05F, .angle_random_walk_rad_per_sqrt_s = 4.7301877e-05F},
        {.strength = {20.125956F, 45.283188F, 103.89935F, 240.84596F, 526.0804F, 1513.0862F},
         .log_prior = 0.645F, .level = 102.54302F, .order = 0.68F,
         .bias_instability_rad_s = 0.00020033799F, .angle_random_walk_rad_per_sqrt_s = 4.370941e-05F},
    },
#endif
};
// clang-format on

#endif
