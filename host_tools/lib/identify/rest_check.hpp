/// @file
/// Whether rates look like those of a gyro at rest, in the unit that their columns name.
#pragma once

#include <string>
#include <vector>

#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// A reason to doubt a recording at rest.
struct RestDoubt {
  std::string sentence;    ///< with the figure that shows it, and what to do
  bool is_certain = true;  ///< results would mean nothing
};

/// Looks for a sensor that was turned, raw counts, and radians named degrees or the reverse. The
/// limits are wider than any MEMS gyro sold: at rest none changes by 1 deg/s from one half-second
/// mean to the next beyond its white noise, none leaves its median by 15 deg/s, and none is noisier
/// than 2 deg/s/sqrt(Hz). Linear in the samples. Empty: nothing speaks against rest.
[[nodiscard]] std::vector<RestDoubt> doubts_of_rest(const RestSamples& samples);

/// Throws recording::DataError with the first certain doubt; returns the sentences of the others.
[[nodiscard]] std::vector<std::string> require_rest(const RestSamples& samples);

}  // namespace zerorate::identify
