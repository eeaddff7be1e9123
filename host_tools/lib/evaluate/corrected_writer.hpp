/// @file
/// What the node published, as a CSV file.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "host_tools/lib/evaluate/replay.hpp"

namespace zerorate::evaluate {

/// Writes t_s, then for each axis the corrected rate, the bias and its standard deviation [deg/s],
/// and the motion (moving, settling, still). The rate's columns carry the names that a recording
/// has, so that the file can be replayed. A refused sample leaves its rate empty, a bias that is
/// not known yet its bias and sigma.
class CorrectedWriter {
 public:
  /// Writes to a temporary name beside `path`. Throws std::system_error.
  CorrectedWriter(const std::filesystem::path& path, std::size_t axis_count);
  ~CorrectedWriter();
  CorrectedWriter(const CorrectedWriter&) = delete;
  CorrectedWriter& operator=(const CorrectedWriter&) = delete;

  void write(const ReplayedSample& sample);
  /// Gives the file its name. Throws std::system_error.
  void finish();

 private:
  struct Closer {
    void operator()(std::FILE* file) const { static_cast<void>(std::fclose(file)); }
  };
  void flush();
  [[noreturn]] void fail(const char* action) const;

  std::filesystem::path path_;
  std::filesystem::path partial_;
  std::size_t axis_count_;
  std::unique_ptr<std::FILE, Closer> file_;
  std::vector<char> text_;
};

}  // namespace zerorate::evaluate
