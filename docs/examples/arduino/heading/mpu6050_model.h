/** @file Sensor model: InvenSense MPU-6050, MPU-6000.
 *  For 100.000 Hz samples and 2.000 Hz ticks of the filter.
 *  Made by `zerorate export --c`; change the model and make it again. */
#ifndef MPU6050_MODEL_H
#define MPU6050_MODEL_H

#include <zerorate.h>

#if ZERORATE_DECAYING_MODES < 6
#error "this model needs ZERORATE_DECAYING_MODES of 6 or more"
#endif

// clang-format off
static const zerorate_model mpu6050_model = {
    .sample_period_ns = INT64_C(10000000),
    .tick_ns = INT64_C(500000000),
    .starts_stationary = true,
    .is_stationary = true,
    .walk_variance_rad2_s2 = 0.0F,
    .white_variance_rad2_s2 = 4.183604e-07F,
    .measurement_floor_variance_rad2_s2 = 0.0F,
    .turn_on_variance_rad2_s2 = 7.6154356e-05F,
    .largest_bias_rad_s = 0.6981317F,
    .scale_factor_sigma = 0.03F,
    .scale_factor_sigma_per_k = 3e-04F,
    .asymmetry_sigma = 0.0F,
    .gate_threshold_sigma = 0.0F,
    .gate_longest_knock_ticks = 0,
    .decaying = {
        {.one_minus_phi = 0.63212055F, .noise_variance = 3.049303e-09F, .initial_variance = 3.5265728e-09F, .initial_mean = 0.0F},
        {.one_minus_phi = 0.09516258F, .noise_variance = 7.156191e-10F, .initial_variance = 3.9478247e-09F, .initial_mean = 0.0F},
        {.one_minus_phi = 0.009950167F, .noise_variance = 7.6801135e-11F, .initial_variance = 3.8785855e-09F, .initial_mean = 0.0F},
        {.one_minus_phi = 0.0009995002F, .noise_variance = 7.827229e-12F, .initial_variance = 3.9175294e-09F, .initial_mean = 0.0F},
        {.one_minus_phi = 9.9995e-05F, .noise_variance = 7.675133e-13F, .initial_variance = 3.8379504e-09F, .initial_mean = 0.0F},
        {.one_minus_phi = 9.99995e-06F, .noise_variance = 9.077297e-14F, .initial_variance = 4.538694e-09F, .initial_mean = 0.0F},
    },
#if ZERORATE_HYPOTHESES >= 12
    .hypothesis_count = 12,
    .evidence_kept = 0.99769217F,
    .hypotheses = {
        {.strength = {0.016798155F, 0.016798155F, 0.016798155F, 0.016798155F, 0.016798155F, 0.016798155F},
         .log_prior = -1.17375F, .level = 0.016798155F, .order = 0.5F,
         .bias_instability_rad_s = 9.459166e-06F, .angle_random_walk_rad_per_sqrt_s = 6.4633205e-05F},
        {.strength = {0.21294717F, 0.21294717F, 0.21294717F, 0.21294717F, 0.21294717F, 0.21294717F},
         .log_prior = -0.76125F, .level = 0.21294717F, .order = 0.5F,
         .bias_instability_rad_s = 3.367891e-05F, .angle_random_walk_rad_per_sqrt_s = 6.407504e-05F},
        {.strength = {2.2480564F, 2.2480564F, 2.2480564F, 2.2480564F, 2.2480564F, 2.2480564F},
         .log_prior = -0.34875F, .level = 2.2480564F, .order = 0.5F,
         .bias_instability_rad_s = 0.0001094273F, .angle_random_walk_rad_per_sqrt_s = 5.7967492e-05F},
        {.strength = {8.677105F, 8.677105F, 8.677105F, 8.677105F, 8.677105F, 8.677105F},
         .log_prior = 0.06375F, .level = 8.677105F, .order = 0.5F,
         .bias_instability_rad_s = 0.00021498566F, .angle_random_walk_rad_per_sqrt_s = 3.1710002e-05F},
        {.strength = {0.00091933075F, 0.0020684844F, 0.004746004F, 0.01100157F, 0.024030754F, 0.069116056F},
         .log_prior = -1.005F, .level = 0.0046840487F, .order = 0.68F,
         .bias_instability_rad_s = 2.7080143e-06F, .angle_random_walk_rad_per_sqrt_s = 6.4680244e-05F},
        {.strength = {0.011855746F, 0.026675303F, 0.06120476F, 0.14187692F, 0.30990207F, 0.8913249F},
         .log_prior = -0.5925F, .level = 0.06040578F, .order = 0.68F,
         .bias_instability_rad_s = 9.724773e-06F, .angle_random_walk_rad_per_sqrt_s = 6.467377e-05F},
        {.strength = {0.1525292F, 0.34318906F, 0.78742516F, 1.8253067F, 3.9870214F, 11.467272F},
         .log_prior = -0.18F, .level = 0.7771459F, .order = 0.68F,
         .bias_instability_rad_s = 3.488121e-05F, .angle_random_walk_rad_per_sqrt_s = 6.459043e-05F},
        {.strength = {1.9041637F, 4.2843485F, 9.830161F, 22.787F, 49.773697F, 143.15663F},
         .log_prior = 0.2325F, .level = 9.701836F, .order = 0.68F,
         .bias_instability_rad_s = 0.0001232444F, .angle_random_walk_rad_per_sqrt_s = 6.35436e-05F},
        {.strength = {17.361208F, 39.06254F, 89.62647F, 207.76044F, 453.81158F, 1305.2302F},
         .log_prior = 0.645F, .level = 88.45647F, .order = 0.68F,
         .bias_instability_rad_s = 0.00037213886F, .angle_random_walk_rad_per_sqrt_s = 5.342415e-05F},
        {.strength = {0.0045904513F, 0.046340615F, 0.4593122F, 0.0F, 0.0F, 8000.1626F},
         .log_prior = -6.67F, .level = 8.476656F, .order = 0.99F,
         .bias_instability_rad_s = 4.0137e-05F, .angle_random_walk_rad_per_sqrt_s = 6.468078e-05F},
        {.strength = {0.07021593F, 0.70883F, 7.0256786F, 0.0F, 0.0F, 122371.17F},
         .log_prior = -6.23F, .level = 129.65965F, .order = 0.99F,
         .bias_instability_rad_s = 0.00015697666F, .angle_random_walk_rad_per_sqrt_s = 6.468078e-05F},
        {.strength = {1.074029F, 10.842324F, 107.465385F, 0.0F, 0.0F, 1871799.9F},
         .log_prior = -5.79F, .level = 1983.285F, .order = 0.99F,
         .bias_instability_rad_s = 0.000613939F, .angle_random_walk_rad_per_sqrt_s = 6.468078e-05F},
    },
#endif
};
// clang-format on

#endif
