/// @file
/// Speed by an odometer beside the speed by a reference, as columns of a recording.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace zerorate::odometry {

/// Speed below which a vehicle is taken to stand [m/s]; references show up to 0.09 at rest.
inline constexpr double kStanding_m_s = 0.1;

/// Silence of a pulse odometer from which on its speed is zero [s].
inline constexpr double kSilent_s = 1.0;

/// A drive with both speeds, row by row.
struct SpeedRecord {
  std::string name;  ///< name of the file
  std::vector<double> time_s;
  std::vector<double> reference_m_s;  ///< magnitude
  std::vector<double> odometer_m_s;
  std::vector<double> yaw_rad_s;  ///< without bias; empty where the recording has no turning
  bool counts_pulses = false;     ///< the odometer gives pulses, not a speed
  double metres_per_pulse = 0.0;  ///< distance of the reference over the pulses; 0 without pulses
  std::uint64_t rows_lost = 0;    ///< left out because a value is empty or nan
  std::vector<std::size_t> gap_before;  ///< rows that come later than ten periods after the last

  [[nodiscard]] std::size_t size() const { return time_s.size(); }
  [[nodiscard]] bool stands(std::size_t row) const { return reference_m_s[row] < kStanding_m_s; }
  [[nodiscard]] bool is_silent(std::size_t row) const { return odometer_m_s[row] == 0.0; }
  /// Median interval between rows [s].
  [[nodiscard]] double period_s() const;
};

/// Reads the columns `t_s`, `ref_speed_mps` and one of `odometer_speed_mps`, `obd_speed_mps` and
/// `odometer_pulses`; for turning `ref_rate_dps` or else `gz_dps`, whose median at standstill is
/// taken off. Throws recording::Error, which names a column that is missing, and
/// recording::DataError where the vehicle never moves or fewer than a hundred rows are there.
[[nodiscard]] SpeedRecord read_speed_record(const std::filesystem::path& path);

/// Rows [begin, end) next to each other that have a property.
struct Stretch {
  std::size_t begin = 0;
  std::size_t end = 0;
  bool has_begin = true;  ///< the row before lacks the property: neither a gap nor the first row
  bool has_end = true;

  [[nodiscard]] std::size_t size() const { return end - begin; }
  [[nodiscard]] bool is_whole() const { return has_begin && has_end; }
};

/// Longest stretches of rows with a property; a gap ends a stretch.
[[nodiscard]] std::vector<Stretch> stretches(const SpeedRecord& record,
                                             const std::function<bool(std::size_t)>& has_property);

}  // namespace zerorate::odometry
