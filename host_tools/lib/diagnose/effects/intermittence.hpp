/// @file
/// A tone that is there in a part of the time only.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace zerorate::diagnose {

/// Oscillation about a frequency.
struct Tone {
  double frequency_hz = 0.0;
  std::optional<double> coherence_time_s;  ///< time after which its phase is another; none: a sine
};

struct Intermittence {
  double share = 0.0;  ///< stretches in which the tone is there, as a share
  double share_lo = 0.0;
  double share_hi = 0.0;         ///< 95 % interval (Clopper and Pearson 1934)
  double amplitude_rad_s = 0.0;  ///< amplitude while it is there
  double from_s = 0.0;           ///< beginning of the first stretch with it, in the series
  double to_s = 0.0;             ///< end of the last one
};

/// Looks at the power of a tone in 8 to 24 stretches of equal length, beside that at frequencies
/// around it. Nothing where the tone is too weak or the recording too short to tell, or where as
/// many stretches without it would be no surprise: a steady sine has less than a quarter of the
/// mean power in 5 % of them, a resonance, whose power has an exponential law, in 22 %. O(n).
/// @param values  one a period [rad/s]
[[nodiscard]] std::optional<Intermittence> find_intermittence(const std::vector<double>& values,
                                                              double period_s, const Tone& tone);

}  // namespace zerorate::diagnose
