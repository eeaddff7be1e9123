/// @file
/// A model with a value of its own in every field.
#pragma once

#include "core/base/time.hpp"
#include "firmware/model/model_file.hpp"
#include "firmware/model/sensor_model.hpp"

namespace zerorate::model {

inline constexpr auto kFullPeriod = core::Duration::milliseconds(20);
inline constexpr auto kFullTick = core::Duration::milliseconds(250);

inline constexpr const char* kFullFile = R"(schema = "zerorate.model/2"
name = "A \"gyro\" at 25 °C"

[white]
angle_random_walk_dps_per_sqrt_hz = 0.05
source = "table 1"

[flicker]
bias_instability_dph = 25.2
order = 0.6
decades = 5
shortest_time_constant_s = 0.25
source = "figure 2"

[rate_random_walk]
coefficient_dps_per_sqrt_s = 2.5e-05

[[gauss_markov]]
sigma_dps = 0.01
time_constant_s = 600

[[gauss_markov]]
sigma_dps = 0.003
time_constant_s = 20
source = "figure 3"

[[harmonic]]
rms_dps = 0.002
frequency_hz = 0.55
coherence_time_s = 40

[temperature]
reference_degc = 25
slope_dps_per_degc = -0.03
slope_sigma_dps_per_degc = 0.01
curvature_dps_per_degc2 = 0.0002
curvature_sigma_dps_per_degc2 = 0.0001
lag_s = 30

[[input]]
quantity = "acceleration_x"
without_accelerometer = "ignore"
sigma_dps_per_unit = 0.05
coefficient_dps_per_unit = [0.01, -0.02, 0.03]
source = "tumble test"

[[input]]
quantity = "vibration"
without_accelerometer = "flag"
sigma_dps_per_unit = 0.5
coefficient_dps_per_unit = [0.1, 0.2, -0.3]

[warm_up]
amplitude_dps = 0.05
amplitude_sigma_dps = 0.02
time_constant_s = 600

[rate_ramp]
slope_dps_per_s = 2e-07
slope_sigma_dps_per_s = 1e-06

[quantization]
step_dps = 0.0125
method = "truncation"

[outliers]
probability = 0.001
sigma_dps = 0.5

[motion_contamination]
interval_s = 900
duration_s = 0.8
sigma_dps = 0.3

[variable_noise]
variance_sigma = 0.2
time_constant_s = 120

[saturation]
lower_dps = -240.5
upper_dps = 250

[gate]
threshold_sigma = 5
longest_knock_s = 3

[turn_on]
sigma_dps = 0.04

[zero_rate]
limit_dps = 3

[scale_factor]
sigma_percent = 1.5
asymmetry_percent = 0.25
temperature_percent_per_degc = 0.02
reference_degc = 30
error_percent = [0.5, -1.25, 2]

[mounting]
tilt_sigma_deg = 8
slope_percent = 5

[learning]
hypotheses = 4
half_life_s = 600

[prior]
order = 0.55
order_sigma = 0.1
amplitude_factor = 3
source = "twelve sensors"

[node]
start = "zero"
)";

/// The model of the file, with all hypotheses and steps that averaging does not remove.
inline SensorModel full_model() {
  SensorModel model = parse_model(kFullFile, "full.toml");
  model.learning->hypotheses = 12;
  model.quantization->step_rad_s = 0.02;
  return model;
}

/// Without what the C interface does not take: more than seven decaying modes, models of single
/// samples, and a ramp whose mode has a variance above 1e6.
inline SensorModel full_model_for_c(SensorModel model = full_model()) {
  model.flicker->decades -= 3;
  model.rate_ramp->slope_sigma_rad_s2 *= 0.1;
  model.outliers.reset();
  model.motion_contamination.reset();
  model.variable_noise.reset();
  model.saturation.reset();
  return model;
}

}  // namespace zerorate::model
