/// @file
/// Pieces of source that the exported headers of C and C++ share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "core/noise/hypotheses.hpp"
#include "core/standstill/hold_back_line.hpp"
#include "core/standstill/standstill.hpp"
#include "firmware/model/source_headers.hpp"

namespace zerorate::model::source {

/// One line for each of the first modes, which have an effect. C makes zeros of the others, and
/// that is what unused means.
template <class Modes>
[[nodiscard]] inline std::string mode_lines(const std::string& indent, const Modes& modes,
                                            std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    text += indent + "{.one_minus_phi = " + literal(modes[i].one_minus_phi) +
            ", .noise_variance = " + literal(modes[i].noise_variance) +
            ", .initial_variance = " + literal(modes[i].initial_variance) +
            ", .initial_mean = " + literal(modes[i].initial_mean) + "},\n";
  }
  return text;
}

/// A list of the first numbers in braces.
[[nodiscard]] inline std::string numbers(const float* first, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += (i == 0 ? "" : ", ") + literal(first[i]);
  return "{" + text + "}";
}

/// Places of the hold-back line that a node with the default hold-back needs.
[[nodiscard]] inline std::int64_t places_needed(core::Duration filter_tick) {
  return core::places_needed(core::Standstill::Params{}.hold_back, filter_tick);
}

/// Refusal of a filter rate whose ticks find no place in the line.
/// @param capacity  what the firmware names the number of places
inline void require_places(core::Duration filter_tick, std::int64_t held_ticks,
                           const std::string& capacity) {
  constexpr core::Duration kHoldBack = core::Standstill::Params{}.hold_back;
  const std::int64_t needed = places_needed(filter_tick);
  if (needed <= held_ticks) return;
  const std::int64_t slowest_refused = held_ticks - core::kPlacesOfWork + 1;
  const std::string most =
      slowest_refused > 0
          ? "lower the filter rate (--filter-rate) below " +
                rate_of(core::Duration::nanoseconds(kHoldBack.ns() / slowest_refused)) + ", or "
          : std::string{};
  throw std::invalid_argument(
      "a filter of " + rate_of(filter_tick) + " needs " + std::to_string(needed) +
      " places for the ticks that the default configuration holds back, and the firmware has " +
      std::to_string(held_ticks) + ": " + most + "compile it with " + capacity + " of " +
      std::to_string(needed) + " and export with --held-ticks " + std::to_string(needed));
}

template <core::ModelShape Shape>
[[nodiscard]] inline std::string hypothesis_lines(const core::Hypotheses<Shape>& hypotheses,
                                                  std::size_t decaying) {
  std::string text;
  for (std::size_t m = 0; m < hypotheses.count; ++m) {
    const auto& one = hypotheses.all[m];
    text +=
        "        {.strength = " + numbers(one.strength.data(), decaying) +
        ",\n         .log_prior = " + literal(one.log_prior) + ", .level = " + literal(one.level) +
        ", .order = " + literal(one.order) +
        ",\n         .bias_instability_rad_s = " + literal(one.bias_instability_rad_s) +
        ", .angle_random_walk_rad_per_sqrt_s = " + literal(one.angle_random_walk_rad_per_sqrt_s) +
        "},\n";
  }
  return text;
}

}  // namespace zerorate::model::source
