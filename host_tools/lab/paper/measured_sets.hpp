/// @file
/// The paper's Table I, measured half: disjoint sets of recordings made at rest.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host_tools/lab/paper/contest.hpp"
#include "host_tools/lab/reference/fractional_noise.hpp"

namespace zerorate::paper {

/// A recording made at rest, complete in memory.
struct RestRecording {
  std::string name;
  double sample_period_s = 0.0;           ///< the median
  std::vector<std::vector<double>> axes;  ///< deg/s, without the rows whose rates were lost
};

/// Reads the recordings of the given files and of the folders' files (*.csv, *.csv.gz), in
/// alphabetical order; those sampled faster than `highest_rate_hz` are left out, unread.
/// Throws recording::Error, and std::invalid_argument if nothing is left.
[[nodiscard]] std::vector<RestRecording> read_rest_recordings(
    const std::vector<std::filesystem::path>& paths, double highest_rate_hz);

/// White and 1/f noise of one axis, by the Whittle likelihood, per sample in deg/s.
struct FittedNoise {
  std::string recording;
  std::size_t axis = 0;
  double sample_period_s = 0.0;
  Figure white;                           ///< sqrt(r)
  Figure flicker;                         ///< s_f at d = 1/2; 0 where none is detectable
  reference::FractionalNoise half_order;  ///< d = 1/2, as the paper takes it
  reference::FractionalNoise free_order;  ///< d fitted too
  Figure order;                           ///< order d with its error
};

/// Table I of all recordings of one sample rate together.
struct MeasuredTable {
  double sample_period_s = 0.0;
  std::vector<FittedNoise> fits;  ///< one for each recording and axis
  std::size_t sets = 0;
  std::vector<Standing> standings;  ///< IE in deg, RSSE in deg/s; the last is the yardstick
};

struct MeasuredOptions {
  Lengths lengths;
  int decades = 5;
  unsigned threads = 0;
};

/// One table a sample rate. Every axis of every recording is cut into disjoint sets; the noise for
/// its predictors is fitted to the same axis of the next recording of that rate, never to its own.
/// Axes without detectable 1/f noise in that fit take no part: nothing would be predicted but the
/// mean. Throws std::invalid_argument if a rate has a single recording or one is shorter than two
/// sets.
[[nodiscard]] std::vector<MeasuredTable> measure_table1(
    const std::vector<RestRecording>& recordings, const MeasuredOptions& options,
    const parallel::Progress& progress);

/// Fits one axis. Throws std::invalid_argument for what cannot be fitted (see fit_white_flicker).
[[nodiscard]] FittedNoise fit_noise(const RestRecording& recording, std::size_t axis);

/// The participants of the measured half, for a sensor that has been on for long.
[[nodiscard]] Predictors measured_predictors(const FittedNoise& fit,
                                             const MeasuredOptions& options);

}  // namespace zerorate::paper
