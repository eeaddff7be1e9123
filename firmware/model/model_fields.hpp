/// @file
/// List of all fields of a model file. Reading, writing and validation visit it, so that each of
/// them has every key. A new member of a table does not compile until it stands in the list.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <string_view>
#include <type_traits>

#include "firmware/model/decimal.hpp"
#include "firmware/model/sensor_model.hpp"
#include "firmware/toml/strict_table.hpp"

namespace zerorate::model {

using toml_file::Presence;
using toml_file::Rule;

// Rules hold for the number as it stands in the file.
inline constexpr Rule kPositive{[](double x) { return x > 0.0 && std::isfinite(x); },
                                "a positive number"};
inline constexpr Rule kFrequency{[](double x) { return x > 0.0 && x <= 1e5; },
                                 "a positive frequency, at most 100 000 Hz"};
inline constexpr Rule kNotNegative{[](double x) { return x >= 0.0 && std::isfinite(x); },
                                   "a number, zero or more"};
inline constexpr Rule kAnyNumber{[](double x) { return std::isfinite(x); }, "a number"};
inline constexpr Rule kOrder{[](double x) { return x > 0.0 && x < 1.0; },
                             "a number between 0 and 1, both excluded"};
inline constexpr Rule kProbability{[](double x) { return x > 0.0 && x < 0.5; },
                                   "a number between 0 and 0.5, both excluded"};
inline constexpr Rule kDecades{[](double x) { return x >= 1.0 && x <= 8.0; },
                               "a whole number from 1 to 8"};

inline constexpr Rule kTolerance{[](double x) { return x >= 0.0 && x <= 20.0; },
                                 "a tolerance from 0 to 20 %"};
inline constexpr Rule kTemperature{[](double x) { return x >= -100.0 && x <= 200.0; },
                                   "a temperature from -100 to 200 deg C"};
inline constexpr Rule kScaleError{[](double x) { return x > -20.0 && x < 20.0; },
                                  "three numbers, of x, y and z, each between -20 and 20 %"};
inline constexpr Rule kCoefficients{[](double x) { return std::isfinite(x); },
                                    "three numbers, of x, y and z"};
inline constexpr Rule kTilt{[](double x) { return x >= 0.0 && x <= 45.0; },
                            "an angle from 0 to 45 deg"};
inline constexpr Rule kHypotheses{[](double x) { return x == 1.0 || x == 4.0 || x == 12.0; },
                                  "1 (nothing is learnt), 4 or 12"};
inline constexpr Rule kFactor{[](double x) { return x > 1.0 && x <= 1000.0; },
                              "a factor above 1, at most 1000"};

/// Names of core::Start in a file, in the order of the enumeration.
inline constexpr std::array<std::string_view, 2> kStarts{"zero", "stationary"};

/// Names of the quantities in a file, in the order of the enumeration.
inline constexpr std::array<std::string_view, 6> kInputQuantities{
    "acceleration",   "acceleration_x", "acceleration_y",
    "acceleration_z", "vibration",      "temperature_rate"};

/// Names of WithoutAccelerometer in a file, in the order of the enumeration.
inline constexpr std::array<std::string_view, 2> kWithoutAccelerometer{"flag", "ignore"};

/// Names of QuantizationMethod in a file, in the order of the enumeration.
inline constexpr std::array<std::string_view, 2> kQuantizationMethods{"rounding", "truncation"};

/// T or const T.
template <class Type, class T>
concept MaybeConst = std::same_as<std::remove_const_t<Type>, T>;

void visit_fields(auto& visitor, MaybeConst<WhiteNoise> auto& white) {
  auto& [angle_random_walk_rad_per_sqrt_s, source] = white;
  visitor.number("angle_random_walk_dps_per_sqrt_hz", angle_random_walk_rad_per_sqrt_s,
                 FileUnit::degree, kNotNegative, Presence::required);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Flicker> auto& flicker) {
  auto& [bias_instability_rad_s, order, decades, shortest_time_constant_s, source] = flicker;
  visitor.bias_instability(bias_instability_rad_s, kPositive);
  visitor.number("order", order, FileUnit::si, kOrder, Presence::optional);
  visitor.number("decades", decades, FileUnit::si, kDecades, Presence::optional);
  visitor.number("shortest_time_constant_s", shortest_time_constant_s, FileUnit::si, kPositive,
                 Presence::optional);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<RateRandomWalk> auto& walk) {
  auto& [coefficient_rad_s_per_sqrt_s, source] = walk;
  visitor.number("coefficient_dps_per_sqrt_s", coefficient_rad_s_per_sqrt_s, FileUnit::degree,
                 kPositive, Presence::required);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<GaussMarkov> auto& process) {
  auto& [sigma_rad_s, time_constant_s, source] = process;
  visitor.number("sigma_dps", sigma_rad_s, FileUnit::degree, kPositive, Presence::required);
  visitor.number("time_constant_s", time_constant_s, FileUnit::si, kPositive, Presence::required);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Harmonic> auto& line) {
  auto& [rms_rad_s, frequency_hz, coherence_time_s, source] = line;
  visitor.number("rms_dps", rms_rad_s, FileUnit::degree, kPositive, Presence::required);
  visitor.number("frequency_hz", frequency_hz, FileUnit::si, kFrequency, Presence::required);
  visitor.number("coherence_time_s", coherence_time_s, FileUnit::si, kPositive, Presence::required);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<TemperatureDrift> auto& drift) {
  auto& [reference_degc, slope_rad_s_per_k, slope_sigma_rad_s_per_k, curvature_rad_s_per_k2,
         curvature_sigma_rad_s_per_k2, lag_s, source] = drift;
  visitor.number("reference_degc", reference_degc, FileUnit::si, kAnyNumber, Presence::required);
  visitor.number("slope_dps_per_degc", slope_rad_s_per_k, FileUnit::degree, kAnyNumber,
                 Presence::optional);
  visitor.number("slope_sigma_dps_per_degc", slope_sigma_rad_s_per_k, FileUnit::degree,
                 kNotNegative, Presence::required);
  visitor.number("curvature_dps_per_degc2", curvature_rad_s_per_k2, FileUnit::degree, kAnyNumber,
                 Presence::optional);
  visitor.number("curvature_sigma_dps_per_degc2", curvature_sigma_rad_s_per_k2, FileUnit::degree,
                 kNotNegative, Presence::optional);
  visitor.number("lag_s", lag_s, FileUnit::si, kNotNegative, Presence::optional);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Input> auto& input) {
  auto& [quantity, without_accelerometer, sigma_rad_s_per_unit, coefficient_rad_s_per_unit,
         source] = input;
  visitor.name("quantity", quantity, kInputQuantities);
  visitor.name("without_accelerometer", without_accelerometer, kWithoutAccelerometer);
  visitor.number("sigma_dps_per_unit", sigma_rad_s_per_unit, FileUnit::degree, kNotNegative,
                 Presence::required);
  visitor.axes("coefficient_dps_per_unit", coefficient_rad_s_per_unit, FileUnit::degree,
               kCoefficients);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<WarmUp> auto& transient) {
  auto& [amplitude_rad_s, amplitude_sigma_rad_s, time_constant_s, source] = transient;
  visitor.number("amplitude_dps", amplitude_rad_s, FileUnit::degree, kAnyNumber,
                 Presence::optional);
  visitor.number("amplitude_sigma_dps", amplitude_sigma_rad_s, FileUnit::degree, kNotNegative,
                 Presence::required);
  visitor.number("time_constant_s", time_constant_s, FileUnit::si, kPositive, Presence::required);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<RateRamp> auto& ramp) {
  auto& [slope_rad_s2, slope_sigma_rad_s2, source] = ramp;
  visitor.number("slope_dps_per_s", slope_rad_s2, FileUnit::degree, kAnyNumber, Presence::optional);
  visitor.number("slope_sigma_dps_per_s", slope_sigma_rad_s2, FileUnit::degree, kNotNegative,
                 Presence::required);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Quantization> auto& quantization) {
  auto& [step_rad_s, method, source] = quantization;
  visitor.number("step_dps", step_rad_s, FileUnit::degree, kPositive, Presence::required);
  visitor.name("method", method, kQuantizationMethods);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Outliers> auto& outliers) {
  auto& [probability, sigma_rad_s, source] = outliers;
  visitor.number("probability", probability, FileUnit::si, kProbability, Presence::required);
  visitor.number("sigma_dps", sigma_rad_s, FileUnit::degree, kPositive, Presence::required);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<MotionContamination> auto& motion) {
  auto& [interval_s, duration_s, sigma_rad_s, source] = motion;
  visitor.number("interval_s", interval_s, FileUnit::si, kPositive, Presence::required);
  visitor.number("duration_s", duration_s, FileUnit::si, kPositive, Presence::required);
  visitor.number("sigma_dps", sigma_rad_s, FileUnit::degree, kPositive, Presence::required);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<VariableNoise> auto& noise) {
  auto& [variance_sigma, time_constant_s, source] = noise;
  visitor.number("variance_sigma", variance_sigma, FileUnit::si, kPositive, Presence::required);
  visitor.number("time_constant_s", time_constant_s, FileUnit::si, kPositive, Presence::required);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Saturation> auto& range) {
  auto& [lower_rad_s, upper_rad_s, source] = range;
  visitor.number("lower_dps", lower_rad_s, FileUnit::degree, kAnyNumber, Presence::required);
  visitor.number("upper_dps", upper_rad_s, FileUnit::degree, kAnyNumber, Presence::required);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Gate> auto& gate) {
  auto& [threshold_sigma, longest_knock_s, source] = gate;
  visitor.number("threshold_sigma", threshold_sigma, FileUnit::si, kPositive, Presence::required);
  visitor.number("longest_knock_s", longest_knock_s, FileUnit::si, kPositive, Presence::optional);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<TurnOn> auto& turn_on) {
  auto& [sigma_rad_s, source] = turn_on;
  visitor.number("sigma_dps", sigma_rad_s, FileUnit::degree, kNotNegative, Presence::required);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<ZeroRate> auto& zero_rate) {
  auto& [limit_rad_s, source] = zero_rate;
  visitor.number("limit_dps", limit_rad_s, FileUnit::degree, kPositive, Presence::required);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<ScaleFactor> auto& scale_factor) {
  auto& [sigma, asymmetry_sigma, sigma_per_k, reference_degc, error, source] = scale_factor;
  visitor.number("sigma_percent", sigma, FileUnit::percent, kTolerance, Presence::required);
  visitor.number("asymmetry_percent", asymmetry_sigma, FileUnit::percent, kTolerance,
                 Presence::optional);
  visitor.number("temperature_percent_per_degc", sigma_per_k, FileUnit::percent, kTolerance,
                 Presence::optional);
  visitor.number("reference_degc", reference_degc, FileUnit::si, kTemperature, Presence::optional);
  visitor.axes("error_percent", error, FileUnit::percent, kScaleError);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Mounting> auto& mounting) {
  auto& [tilt_sigma_rad, slope_sigma, source] = mounting;
  visitor.number("tilt_sigma_deg", tilt_sigma_rad, FileUnit::degree, kTilt, Presence::required);
  visitor.number("slope_percent", slope_sigma, FileUnit::percent, kTolerance, Presence::optional);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Learning> auto& learning) {
  auto& [hypotheses, half_life_s] = learning;
  visitor.number("hypotheses", hypotheses, FileUnit::si, kHypotheses, Presence::optional);
  visitor.number("half_life_s", half_life_s, FileUnit::si, kPositive, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Prior> auto& prior) {
  auto& [order, order_sigma, amplitude_factor, source] = prior;
  visitor.number("order", order, FileUnit::si, kOrder, Presence::optional);
  visitor.number("order_sigma", order_sigma, FileUnit::si, kPositive, Presence::optional);
  visitor.number("amplitude_factor", amplitude_factor, FileUnit::si, kFactor, Presence::optional);
  visitor.text("source", source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Node> auto& node) {
  auto& [start] = node;
  visitor.name("start", start, kStarts);
}

/// Visits a whole model: `name`, then every table. std::optional tables may be absent; of a
/// std::vector there may be any number, as [[table]].
void visit_fields(auto& visitor, MaybeConst<SensorModel> auto& model) {
  auto& [name, white, flicker, rate_random_walk, gauss_markov, harmonic, temperature, inputs,
         warm_up, rate_ramp, quantization, outliers, motion_contamination, variable_noise,
         saturation, gate, turn_on, zero_rate, scale_factor, mounting, learning, prior, node] =
      model;
  visitor.text("name", name, Presence::required);
  visitor.table("white", white, Presence::required);
  visitor.table("flicker", flicker);
  visitor.table("rate_random_walk", rate_random_walk);
  visitor.tables("gauss_markov", gauss_markov);
  visitor.tables("harmonic", harmonic);
  visitor.table("temperature", temperature);
  visitor.tables("input", inputs);
  visitor.table("warm_up", warm_up);
  visitor.table("rate_ramp", rate_ramp);
  visitor.table("quantization", quantization);
  visitor.table("outliers", outliers);
  visitor.table("motion_contamination", motion_contamination);
  visitor.table("variable_noise", variable_noise);
  visitor.table("saturation", saturation);
  visitor.table("gate", gate);
  visitor.table("turn_on", turn_on);
  visitor.table("zero_rate", zero_rate);
  visitor.table("scale_factor", scale_factor);
  visitor.table("mounting", mounting);
  visitor.table("learning", learning);
  visitor.table("prior", prior);
  visitor.table("node", node, Presence::optional);
}

}  // namespace zerorate::model
