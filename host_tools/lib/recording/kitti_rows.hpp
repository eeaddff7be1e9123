/// @file
/// Folders of one text file a sample, as the KITTI data set has them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "host_tools/lib/recording/byte_source.hpp"
#include "host_tools/lib/recording/row_source.hpp"

namespace zerorate::recording {

/// The folder of the inertial unit in a path of KITTI: itself or its `oxts`; nullopt for others.
[[nodiscard]] std::optional<std::filesystem::path> kitti_folder(const std::filesystem::path& path);

/// Reads `timestamps.txt` and the files of `data/`, 30 numbers each. Used are the accelerations
/// along x, y, z (numbers 12 to 14, m/s2), the rates about them (18 to 20, rad/s) and the speed
/// forward (9, m/s), by the data set's dataformat.txt. Memory: one sample.
class KittiRows : public RowSource {
 public:
  /// Throws Error.
  explicit KittiRows(const std::filesystem::path& folder);

  [[nodiscard]] const Columns& columns() const override { return columns_; }
  [[nodiscard]] bool next(Row& row) override;
  [[nodiscard]] std::uint64_t line() const override { return stamps_.line(); }
  [[nodiscard]] std::optional<double> fraction_read() const override {
    return stamps_.fraction_read();
  }

 private:
  static constexpr std::size_t kNumbers = 30;

  [[nodiscard]] std::array<double, kNumbers> read_sample() const;

  std::filesystem::path folder_;
  LineReader stamps_;
  Columns columns_;
};

}  // namespace zerorate::recording
