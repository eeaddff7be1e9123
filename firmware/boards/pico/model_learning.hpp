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
    .largest_bias_rad_s = 0.08726646F,
    .gate = {.threshold_sigma = 0.0F, .longest_knock_ticks = 0},
    .sample_period = core::Duration::nanoseconds(9599520),
    .hypotheses = {.count = 12, .kept = 0.99769217F, .all = {{
        {.strength = {0.0016005534F, 0.0016005534F, 0.0016005534F, 0.0016005534F, 0.0016005534F, 0.0016005534F},
         .log_prior = -1.165F, .level = 0.0016005534F, .order = 0.5F,
         .bias_instability_rad_s = 1.4599136e-06F, .angle_random_walk_rad_per_sqrt_s = 4.7913054e-05F},
        {.strength = {0.03438387F, 0.03438387F, 0.03438387F, 0.03438387F, 0.03438387F, 0.03438387F},
         .log_prior = -0.85F, .level = 0.03438387F, .order = 0.5F,
         .bias_instability_rad_s = 6.7665837e-06F, .angle_random_walk_rad_per_sqrt_s = 4.7881716e-05F},
        {.strength = {0.7193839F, 0.7193839F, 0.7193839F, 0.7193839F, 0.7193839F, 0.7193839F},
         .log_prior = -0.535F, .level = 0.7193839F, .order = 0.5F,
         .bias_instability_rad_s = 3.095084e-05F, .angle_random_walk_rad_per_sqrt_s = 4.7222205e-05F},
        {.strength = {9.741615F, 9.741615F, 9.741615F, 9.741615F, 9.741615F, 9.741615F},
         .log_prior = -0.22F, .level = 9.741615F, .order = 0.5F,
         .bias_instability_rad_s = 0.00011389576F, .angle_random_walk_rad_per_sqrt_s = 3.7467522e-05F},
        {.strength = {0.0015630784F, 0.0026861469F, 0.0046763215F, 0.008170539F, 0.013875178F, 0.027295575F},
         .log_prior = -0.56F, .level = 0.004451482F, .order = 0.62F,
         .bias_instability_rad_s = 1.6187875e-06F, .angle_random_walk_rad_per_sqrt_s = 4.791398e-05F},
        {.strength = {0.0336055F, 0.05775098F, 0.10053887F, 0.17566301F, 0.29831025F, 0.5868429F},
         .log_prior = -0.245F, .level = 0.09570491F, .order = 0.62F,
         .bias_instability_rad_s = 7.5059324e-06F, .angle_random_walk_rad_per_sqrt_s = 4.790167e-05F},
        {.strength = {0.71497226F, 1.2286783F, 2.13901F, 3.73731F, 6.346686F, 12.485349F},
         .log_prior = 0.07F, .level = 2.0361655F, .order = 0.62F,
         .bias_instability_rad_s = 3.4621356e-05F, .angle_random_walk_rad_per_sqrt_s = 4.763911e-05F},
        {.strength = {12.451389F, 21.397686F, 37.2513F, 65.08602F, 110.52884F, 217.43492F},
         .log_prior = 0.385F, .level = 35.46024F, .order = 0.62F,
         .bias_instability_rad_s = 0.00014448022F, .angle_random_walk_rad_per_sqrt_s = 4.286487e-05F},
        {.strength = {0.0012921279F, 0.0038056101F, 0.011489002F, 0.03551244F, 0.09797476F, 0.43190962F},
         .log_prior = -0.955F, .level = 0.012380316F, .order = 0.74F,
         .bias_instability_rad_s = 1.7949354e-06F, .angle_random_walk_rad_per_sqrt_s = 4.7914506e-05F},
        {.strength = {0.027792623F, 0.08185559F, 0.24711913F, 0.7638438F, 2.1073575F, 9.290026F},
         .log_prior = -0.64F, .level = 0.26629055F, .order = 0.74F,
         .bias_instability_rad_s = 8.324551e-06F, .angle_random_walk_rad_per_sqrt_s = 4.7912916e-05F},
        {.strength = {0.5969846F, 1.7582552F, 5.30811F, 16.40734F, 45.265972F, 199.54944F},
         .log_prior = -0.325F, .level = 5.719912F, .order = 0.74F,
         .bias_instability_rad_s = 3.858137e-05F, .angle_random_walk_rad_per_sqrt_s = 4.787877e-05F},
        {.strength = {12.459626F, 36.696426F, 110.78522F, 342.43646F, 944.74304F, 4164.7827F},
         .log_prior = -0.01F, .level = 119.3799F, .order = 0.74F,
         .bias_instability_rad_s = 0.00017625789F, .angle_random_walk_rad_per_sqrt_s = 4.7161488e-05F},
    }}},
};
// clang-format on

}  // namespace zerorate::exported
