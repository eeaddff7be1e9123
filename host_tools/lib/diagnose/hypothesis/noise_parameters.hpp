/// @file
/// The table of the parameters of a noise spectrum: which term each belongs to, on which scale it
/// is fitted and within which limits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

#include "host_tools/lib/diagnose/hypothesis/noise_spectrum.hpp"

namespace zerorate::diagnose {

/// Index into kNoiseParameters.
enum class NoiseParameterId : std::uint8_t {
  white_variance,
  flicker_variance,
  flicker_order,
  walk_variance,
  markov_variance,
  markov_samples,
  line_variance,
  line_angle,
  line_samples,
  low_pass_share,
};

/// A parameter of a noise spectrum.
struct NoiseParameter {
  /// Quantity: decides the scale of the fit and the reference of the limits.
  enum class Kind : std::uint8_t {
    strength,   ///< a variance: its logarithm is fitted, over that of the weakest noise that counts
    time,       ///< samples: its logarithm is fitted; `highest` is a share of the record
    line_time,  ///< samples: as `time`, with limits that depend on the angle of the line
    share,      ///< between 0 and `unit`: its logit is fitted
    order,      ///< fitted as it is
  };
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  NoiseParameterId id;
  double NoiseSpectrum::*value;
  bool NoiseTerms::*term = nullptr;  ///< term that has the parameter; none: fitted always
  Kind kind;
  double unit = 1.0;           ///< largest value of a share
  double lowest = -kInfinity;  ///< limits of the fit, on its scale for strengths and shares
  double highest = kInfinity;
  /// Limits of a start, by value (of a strength: over the weakest noise that counts). They lie
  /// inside the limits of the fit, since at the edge of a scale a parameter has no slope.
  double lowest_start = 0.0;
  double highest_start = kInfinity;
};

/// All parameters, in the order of NoiseParameterId.
inline constexpr std::array<NoiseParameter, 10> kNoiseParameters{{
    {.id = NoiseParameterId::white_variance,
     .value = &NoiseSpectrum::white_variance,
     .kind = NoiseParameter::Kind::strength,
     .lowest = 0.0,
     .lowest_start = 1.0},
    {.id = NoiseParameterId::flicker_variance,
     .value = &NoiseSpectrum::flicker_variance,
     .kind = NoiseParameter::Kind::strength,
     .lowest = 0.0,
     .lowest_start = 1.0},
    {.id = NoiseParameterId::flicker_order,
     .value = &NoiseSpectrum::flicker_order,
     .term = &NoiseTerms::free_order,
     .kind = NoiseParameter::Kind::order,
     .lowest = 0.05,
     .highest = 0.97},
    {.id = NoiseParameterId::walk_variance,
     .value = &NoiseSpectrum::walk_variance,
     .term = &NoiseTerms::random_walk,
     .kind = NoiseParameter::Kind::strength,
     .lowest = -14.0,
     .lowest_start = 1e-6},
    {.id = NoiseParameterId::markov_variance,
     .value = &NoiseSpectrum::markov_variance,
     .term = &NoiseTerms::gauss_markov,
     .kind = NoiseParameter::Kind::strength,
     .lowest = 0.0,
     .lowest_start = 1.0},
    {.id = NoiseParameterId::markov_samples,
     .value = &NoiseSpectrum::markov_samples,
     .term = &NoiseTerms::gauss_markov,
     .kind = NoiseParameter::Kind::time,
     .lowest = 0.5,
     .highest = 0.25},
    {.id = NoiseParameterId::line_variance,
     .value = &NoiseSpectrum::line_variance,
     .term = &NoiseTerms::line,
     .kind = NoiseParameter::Kind::strength,
     .lowest = 0.0,
     .lowest_start = 1.0},
    {.id = NoiseParameterId::line_angle,
     .value = &NoiseSpectrum::line_angle,
     .term = &NoiseTerms::line,
     .kind = NoiseParameter::Kind::share,
     .unit = std::numbers::pi,
     .lowest = -14.0,
     .highest = 14.0,
     .lowest_start = 1e-6,
     .highest_start = 1.0 - 1e-6},
    {.id = NoiseParameterId::line_samples,
     .value = &NoiseSpectrum::line_samples,
     .term = &NoiseTerms::line,
     .kind = NoiseParameter::Kind::line_time},
    {.id = NoiseParameterId::low_pass_share,
     .value = &NoiseSpectrum::low_pass_share,
     .term = &NoiseTerms::low_pass,
     .kind = NoiseParameter::Kind::share,
     .lowest = -8.0,
     .highest = 8.0,
     .lowest_start = 1e-3,
     .highest_start = 0.999},
}};

/// True if every parameter stands at the place of its id.
consteval bool are_in_order(const std::array<NoiseParameter, 10>& parameters) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (static_cast<std::size_t>(parameters[i].id) != i) return false;
  }
  return true;
}
static_assert(are_in_order(kNoiseParameters));

/// True if a fit of these terms fits the parameter.
[[nodiscard]] constexpr bool is_fitted(const NoiseParameter& parameter, const NoiseTerms& terms) {
  return parameter.term == nullptr || terms.*parameter.term;
}

}  // namespace zerorate::diagnose
