/// @file
/// The catalogue: one line an effect.
#pragma once

#include <array>
#include <memory>

#include "host_tools/lib/diagnose/effects/effect.hpp"

namespace zerorate::diagnose {

std::unique_ptr<Effect> make_bias_jump();
std::unique_ptr<Effect> make_correlated_noise();
std::unique_ptr<Effect> make_dropped_samples();
std::unique_ptr<Effect> make_fractional_order();
std::unique_ptr<Effect> make_motion_contamination();
std::unique_ptr<Effect> make_outliers();
std::unique_ptr<Effect> make_periodic_disturbance();
std::unique_ptr<Effect> make_quantization();
std::unique_ptr<Effect> make_random_telegraph_noise();
std::unique_ptr<Effect> make_rate_ramp();
std::unique_ptr<Effect> make_rate_random_walk();
std::unique_ptr<Effect> make_relaxation();
std::unique_ptr<Effect> make_saturation();
std::unique_ptr<Effect> make_sensor_bandwidth();
std::unique_ptr<Effect> make_temperature_drift();
std::unique_ptr<Effect> make_temperature_rate();
std::unique_ptr<Effect> make_variable_noise();
std::unique_ptr<Effect> make_warm_up_transient();

/// The longest searches come first, so that none is left to one thread while the others are done.
inline constexpr std::array kEffects = {
    &make_random_telegraph_noise,
    &make_periodic_disturbance,
    &make_relaxation,
    &make_temperature_drift,
    &make_temperature_rate,
    &make_warm_up_transient,
    &make_sensor_bandwidth,
    &make_variable_noise,
    &make_bias_jump,
    &make_correlated_noise,
    &make_rate_random_walk,
    &make_fractional_order,
    &make_rate_ramp,
    &make_motion_contamination,
    &make_outliers,
    &make_dropped_samples,
    &make_saturation,
    &make_quantization,
};

}  // namespace zerorate::diagnose
