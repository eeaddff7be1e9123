/// @file
/// Published rates, biases and deviations as a CSV file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/output/output_file.hpp"

namespace zerorate::evaluate {

/// Writes t_s, then for each axis the corrected rate, the bias and its standard deviation [deg/s],
/// the turn since departure, the heading, the motion (moving, settling, still), whether the rate
/// may be used, and the names of the health flags that are set, as `calibrated|saturated`. The
/// rate's columns carry the names that a recording has, so that the file can be replayed. A refused
/// sample leaves its rate empty, a bias that is not known yet its bias and sigma.
class CorrectedWriter {
 public:
  /// Opens an output::OutputFile. All members throw std::system_error.
  CorrectedWriter(const std::filesystem::path& path, std::size_t axis_count);

  void write(const ReplayedSample& sample);
  /// Gives the file its name.
  void finish();

 private:
  void append_flags(const app::Health& health);
  void flush();

  output::OutputFile file_;
  std::size_t axis_count_;
  std::string text_;  ///< formatted but not yet written
};

}  // namespace zerorate::evaluate
