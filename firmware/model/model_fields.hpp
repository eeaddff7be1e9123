/// @file
/// The one list of what a model file may hold. Reading, writing and validation are visitors of it,
/// so that a key cannot be known to one of them and unknown to another.
#pragma once

#include <cmath>
#include <concepts>
#include <string_view>
#include <type_traits>

#include "firmware/model/decimal.hpp"
#include "firmware/model/sensor_model.hpp"

namespace zerorate::model {

enum class Presence { required, optional };

/// What a number must satisfy, in code and in words.
struct Rule {
  bool (*holds)(double);
  std::string_view words;
};

inline constexpr Rule kPositive{[](double x) { return x > 0.0 && std::isfinite(x); },
                                "a positive number"};
inline constexpr Rule kNotNegative{[](double x) { return x >= 0.0 && std::isfinite(x); },
                                   "a number, zero or more"};
inline constexpr Rule kOrder{[](double x) { return x > 0.0 && x < 1.0; },
                             "a number between 0 and 1, both excluded"};
inline constexpr Rule kDecades{[](double x) { return x >= 1.0 && x <= 8.0; },
                               "a whole number from 1 to 8"};

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
  visitor.number("bias_instability_dph", flicker.bias_instability_rad_s,
                 FileUnit::degree_per_hour_floor, kPositive, Presence::required);
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
  visitor.number("frequency_hz", line.frequency_hz, FileUnit::si, kPositive, Presence::required);
  visitor.number("coherence_time_s", line.coherence_time_s, FileUnit::si, kPositive,
                 Presence::required);
  visitor.text("source", line.source, Presence::optional);
}

void visit_fields(auto& visitor, MaybeConst<Node> auto& node) {
  visitor.start("start", node.start);
}

/// Visits a whole model: `name`, then every table. std::optional tables may be absent.
void visit_fields(auto& visitor, MaybeConst<SensorModel> auto& model) {
  visitor.text("name", model.name, Presence::required);
  visitor.table("white", model.white, Presence::required);
  visitor.table("flicker", model.flicker);
  visitor.table("rate_random_walk", model.rate_random_walk);
  visitor.table("gauss_markov", model.gauss_markov);
  visitor.table("harmonic", model.harmonic);
  visitor.table("node", model.node, Presence::optional);
}

}  // namespace zerorate::model
