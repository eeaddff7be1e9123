/** @file Sensor model: STMicroelectronics LSM6DSO.
 *  Made by `zerorate export --c`; change the model and make it again. */
#ifndef FRONT_GYRO_H
#define FRONT_GYRO_H

#include "firmware/c_api/zerorate.h"

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
};
// clang-format on

#endif
