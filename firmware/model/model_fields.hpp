/// @file
/// List of all fields of a model file. Reading, writing and validation visit it, so that each of
/// them has every key.
#pragma once

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
inline constexpr Rule kTilt{[](double x) { return x >= 0.0 && x <= 45.0; },
                            "an angle from 0 to 45 deg"};
inline constexpr Rule kHypotheses{[](double x) { return x == 1.0 || x == 4.0 || x == 12.0; },
                                  "1 (nothing is learnt), 4 or 12"};
inline constexpr Rule kFactor{[](double x) { return x > 1.0 && x <= 1000.0; },
                              "a factor above 1, at most 1000"};

[[nodiscard]] constexpr std::string_view start_name(core::Start start) {
  return start == core::Start::zero ? "zero" : "stationary";
}

/// T or const T.
template <class Type, class T>
concept MaybeConst = std::same_as<std::remove_const_t<Type>, T>;

void visit_fields(auto& visitor, MaybeConst<WhiteNoise> auto& white) {
  visitor.number("angle_random_walk_dps_per_sqrt_hz", white.angle_random_walk_rad_per_sqrt_s,
                 FileUnit::degree, kNotNegative, Presence::required);
  visitor.text("source", white.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Flicker> auto& flicker) {
  visitor.bias_instability(flicker.bias_instability_rad_s, kPositive);
  visitor.number("order", flicker.order, FileUnit::si, kOrder, Presence::optional);
  visitor.number("decades", flicker.decades, FileUnit::si, kDecades, Presence::optional);
  visitor.number("shortest_time_constant_s", flicker.shortest_time_constant_s, FileUnit::si,
                 kPositive, Presence::optional);
  visitor.text("source", flicker.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<RateRandomWalk> auto& walk) {
  visitor.number("coefficient_dps_per_sqrt_s", walk.coefficient_rad_s_per_sqrt_s, FileUnit::degree,
                 kPositive, Presence::required);
  visitor.text("source", walk.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<GaussMarkov> auto& process) {
  visitor.number("sigma_dps", process.sigma_rad_s, FileUnit::degree, kPositive, Presence::required);
  visitor.number("time_constant_s", process.time_constant_s, FileUnit::si, kPositive,
                 Presence::required);
  visitor.text("source", process.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Harmonic> auto& line) {
  visitor.number("rms_dps", line.rms_rad_s, FileUnit::degree, kPositive, Presence::required);
  visitor.number("frequency_hz", line.frequency_hz, FileUnit::si, kFrequency, Presence::required);
  visitor.number("coherence_time_s", line.coherence_time_s, FileUnit::si, kPositive,
                 Presence::required);
  visitor.text("source", line.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<TemperatureDrift> auto& drift) {
  visitor.number("reference_degc", drift.reference_degc, FileUnit::si, kAnyNumber,
                 Presence::required);
  visitor.number("slope_dps_per_degc", drift.slope_rad_s_per_k, FileUnit::degree, kAnyNumber,
                 Presence::optional);
  visitor.number("slope_sigma_dps_per_degc", drift.slope_sigma_rad_s_per_k, FileUnit::degree,
                 kNotNegative, Presence::required);
  visitor.number("curvature_dps_per_degc2", drift.curvature_rad_s_per_k2, FileUnit::degree,
                 kAnyNumber, Presence::optional);
  visitor.number("curvature_sigma_dps_per_degc2", drift.curvature_sigma_rad_s_per_k2,
                 FileUnit::degree, kNotNegative, Presence::optional);
  visitor.number("lag_s", drift.lag_s, FileUnit::si, kNotNegative, Presence::optional);
  visitor.text("source", drift.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<WarmUp> auto& transient) {
  visitor.number("amplitude_dps", transient.amplitude_rad_s, FileUnit::degree, kAnyNumber,
                 Presence::optional);
  visitor.number("amplitude_sigma_dps", transient.amplitude_sigma_rad_s, FileUnit::degree,
                 kNotNegative, Presence::required);
  visitor.number("time_constant_s", transient.time_constant_s, FileUnit::si, kPositive,
                 Presence::required);
  visitor.text("source", transient.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<RateRamp> auto& ramp) {
  visitor.number("slope_dps_per_s", ramp.slope_rad_s2, FileUnit::degree, kAnyNumber,
                 Presence::optional);
  visitor.number("slope_sigma_dps_per_s", ramp.slope_sigma_rad_s2, FileUnit::degree, kNotNegative,
                 Presence::required);
  visitor.text("source", ramp.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Quantization> auto& quantization) {
  visitor.number("step_dps", quantization.step_rad_s, FileUnit::degree, kPositive,
                 Presence::required);
  visitor.text("source", quantization.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Outliers> auto& outliers) {
  visitor.number("probability", outliers.probability, FileUnit::si, kProbability,
                 Presence::required);
  visitor.number("sigma_dps", outliers.sigma_rad_s, FileUnit::degree, kPositive,
                 Presence::required);
  visitor.text("source", outliers.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<MotionContamination> auto& motion) {
  visitor.number("interval_s", motion.interval_s, FileUnit::si, kPositive, Presence::required);
  visitor.number("duration_s", motion.duration_s, FileUnit::si, kPositive, Presence::required);
  visitor.number("sigma_dps", motion.sigma_rad_s, FileUnit::degree, kPositive, Presence::required);
  visitor.text("source", motion.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<VariableNoise> auto& noise) {
  visitor.number("variance_sigma", noise.variance_sigma, FileUnit::si, kPositive,
                 Presence::required);
  visitor.number("time_constant_s", noise.time_constant_s, FileUnit::si, kPositive,
                 Presence::required);
  visitor.text("source", noise.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Saturation> auto& range) {
  visitor.number("lower_dps", range.lower_rad_s, FileUnit::degree, kAnyNumber, Presence::required);
  visitor.number("upper_dps", range.upper_rad_s, FileUnit::degree, kAnyNumber, Presence::required);
  visitor.text("source", range.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Gate> auto& gate) {
  visitor.number("threshold_sigma", gate.threshold_sigma, FileUnit::si, kPositive,
                 Presence::required);
  visitor.number("longest_knock_s", gate.longest_knock_s, FileUnit::si, kPositive,
                 Presence::optional);
  visitor.text("source", gate.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<TurnOn> auto& turn_on) {
  visitor.number("sigma_dps", turn_on.sigma_rad_s, FileUnit::degree, kNotNegative,
                 Presence::required);
  visitor.text("source", turn_on.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<ZeroRate> auto& zero_rate) {
  visitor.number("limit_dps", zero_rate.limit_rad_s, FileUnit::degree, kPositive,
                 Presence::required);
  visitor.text("source", zero_rate.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<ScaleFactor> auto& scale_factor) {
  visitor.number("sigma_percent", scale_factor.sigma, FileUnit::percent, kTolerance,
                 Presence::required);
  visitor.number("asymmetry_percent", scale_factor.asymmetry_sigma, FileUnit::percent, kTolerance,
                 Presence::optional);
  visitor.text("source", scale_factor.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Mounting> auto& mounting) {
  visitor.number("tilt_sigma_deg", mounting.tilt_sigma_rad, FileUnit::degree, kTilt,
                 Presence::required);
  visitor.text("source", mounting.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Learning> auto& learning) {
  visitor.number("hypotheses", learning.hypotheses, FileUnit::si, kHypotheses, Presence::optional);
  visitor.number("half_life_s", learning.half_life_s, FileUnit::si, kPositive, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Prior> auto& prior) {
  visitor.number("order", prior.order, FileUnit::si, kOrder, Presence::optional);
  visitor.number("order_sigma", prior.order_sigma, FileUnit::si, kPositive, Presence::optional);
  visitor.number("amplitude_factor", prior.amplitude_factor, FileUnit::si, kFactor,
                 Presence::optional);
  visitor.text("source", prior.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Node> auto& node) {
  visitor.start("start", node.start);
}

/// Visits a whole model: `name`, then every table. std::optional tables may be absent; of a
/// std::vector there may be any number, as [[table]].
void visit_fields(auto& visitor, MaybeConst<SensorModel> auto& model) {
  visitor.text("name", model.name, Presence::required);
  visitor.table("white", model.white, Presence::required);
  visitor.table("flicker", model.flicker);
  visitor.table("rate_random_walk", model.rate_random_walk);
  visitor.tables("gauss_markov", model.gauss_markov);
  visitor.tables("harmonic", model.harmonic);
  visitor.table("temperature", model.temperature);
  visitor.table("warm_up", model.warm_up);
  visitor.table("rate_ramp", model.rate_ramp);
  visitor.table("quantization", model.quantization);
  visitor.table("outliers", model.outliers);
  visitor.table("motion_contamination", model.motion_contamination);
  visitor.table("variable_noise", model.variable_noise);
  visitor.table("saturation", model.saturation);
  visitor.table("gate", model.gate);
  visitor.table("turn_on", model.turn_on);
  visitor.table("zero_rate", model.zero_rate);
  visitor.table("scale_factor", model.scale_factor);
  visitor.table("mounting", model.mounting);
  visitor.table("learning", model.learning);
  visitor.table("prior", model.prior);
  visitor.table("node", model.node, Presence::optional);
}

}  // namespace zerorate::model
