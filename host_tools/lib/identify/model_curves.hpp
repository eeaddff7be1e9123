/// @file
/// Curves of a sensor model, beside those that are drawn of recordings.
#pragma once

#include "firmware/model/sensor_model.hpp"

namespace zerorate::identify {

/// Two-sided density of a model's white and flicker noise, N^2 + B^2 (2 pi nu)^(-2d).
[[nodiscard]] double model_density(const model::SensorModel& model, double frequency_hz);

/// Allan deviation of a model's white noise and flicker decades, which the node stands for the
/// flicker noise with [rad/s]. Each decade of stationary variance q and time constant T adds, with
/// a = tau / T (IEEE Std 952, annex C: exponentially correlated noise),
///
///     sigma^2(tau) = 2 q / a (1 - (3 - 4 e^(-a) + e^(-2a)) / (2a)).
///
/// Other parts of the model are left out.
[[nodiscard]] double model_allan_deviation(const model::SensorModel& model, double tau_s);

/// Where the densities of white and flicker noise are equal [Hz]: averages much longer than its
/// inverse are dominated by flicker noise. The model has flicker noise.
[[nodiscard]] double corner_frequency_hz(const model::SensorModel& model);

}  // namespace zerorate::identify
