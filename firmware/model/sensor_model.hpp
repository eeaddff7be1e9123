/// @file
/// What is known about the noise of one gyro axis: physical, and independent of any sampling rate.
///
/// A SensorModel is what a data sheet or an identification gives. The filter's coefficients are
/// derived from it and a sampling rate; nothing here knows about samples. Units are SI throughout;
/// spectra are two-sided. docs/reference/model-format.md describes the file it is kept in.
#pragma once

#include <optional>
#include <string>

#include "core/noise/modes.hpp"

namespace zerorate::model {

/// Angle random walk: white rate noise, S(nu) = N^2.
struct WhiteNoise {
  /// N in rad/s/sqrt(Hz). Averaging over T seconds leaves the variance N^2 / T.
  double angle_random_walk_rad_per_sqrt_s = 0.0;
  std::string source{};  ///< where the figures come from, for humans

  bool operator==(const WhiteNoise&) const = default;
};

/// Bias instability: 1/f noise and its neighbours, S(nu) = B^2 (2 pi nu)^(-2d), with 2 pi nu in
/// rad/s.
///
/// The filter approximates it by first-order lags, one a decade of time constants (Keshner; the
/// paper's section IV-A), so its band is finite: `decades` and `shortest_time_constant_s` say
/// which.
struct Flicker {
  /// B in rad/s: the spectrum's square root at 2 pi nu = 1 rad/s, whatever the order. For d = 1/2
  /// it is the coefficient of IEEE Std 952, and the Allan deviation's floor is
  /// sqrt(2 ln 2 / pi) B = .664 B.
  double bias_instability_rad_s = 0.0;
  /// d in (0, 1). 1/2 is 1/f noise; larger wanders farther (1 would be a random walk).
  double order = 0.5;
  /// How many lags, 1 to 8. More reach longer horizons: the slowest lag has the time constant
  /// shortest_time_constant_s 10^(decades - 1).
  int decades = 6;
  /// Smaller models quicker flicker, which drowns in the white noise first.
  double shortest_time_constant_s = 0.5;
  std::string source{};

  bool operator==(const Flicker&) const = default;
};

/// Rate random walk: S(nu) = K^2 / (2 pi nu)^2.
struct RateRandomWalk {
  double coefficient_rad_s_per_sqrt_s = 0.0;  ///< K; the variance grows by K^2 a second
  std::string source{};

  bool operator==(const RateRandomWalk&) const = default;
};

/// Exponentially correlated noise (a first-order Gauss-Markov process), at its steady state.
struct GaussMarkov {
  double sigma_rad_s = 0.0;
  double time_constant_s = 0.0;
  std::string source{};

  bool operator==(const GaussMarkov&) const = default;
};

/// A line: vibration or a beat, whose phase and amplitude wander over `coherence_time_s`.
struct Harmonic {
  double rms_rad_s = 0.0;
  double frequency_hz = 0.0;
  double coherence_time_s = 0.0;
  std::string source{};

  bool operator==(const Harmonic&) const = default;
};

/// What the model tells the node besides the noise.
struct Node {
  core::Start start = core::Start::stationary;

  bool operator==(const Node&) const = default;
};

/// The noise model of one gyro axis. The constant part of the bias is not in it: nothing is known
/// about it before the first standstill.
struct SensorModel {
  std::string name{};
  WhiteNoise white;
  std::optional<Flicker> flicker;
  std::optional<RateRandomWalk> rate_random_walk;
  std::optional<GaussMarkov> gauss_markov;
  std::optional<Harmonic> harmonic;
  Node node;

  bool operator==(const SensorModel&) const = default;
};

}  // namespace zerorate::model
