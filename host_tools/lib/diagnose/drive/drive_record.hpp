/// @file
/// Errors of the heading over drives between true stops, with their variance, and what may have
/// caused them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "host_tools/lib/diagnose/drive/trace_effect.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace zerorate::diagnose {

/// One drive, or a part of it. The bias and what its inputs are at rest are taken off: they are
/// interpolated between the measurements at all stops.
struct DriveEvidence {
  double departure_s = 0.0;
  double length_s = 0.0;
  /// Turn about the vertical axis less that of the reference, of which an axis misses a small share
  double error_rad = 0.0;
  double turn_rad = 0.0;      ///< turn of the reference
  double path_rad = 0.0;      ///< sum of the sizes of its parts
  double leant_rad_g2 = 0.0;  ///< sum of its parts by the square of the acceleration to the side
  double moving_s = 0.0;
  double metres = 0.0;
  std::array<double, 3> turned_rad{};  ///< turns about x, y and z of the sensor
  /// Integral of the specific force less that at rest, x, y and z [g s]
  std::array<double, 3> force_g_s{};
  double vibration_g2_s = 0.0;  ///< integral of the vibration less that at rest

  /// Adds the sums of the part that follows.
  void add(const DriveEvidence& next);
  /// Turn that an axis upright in the vehicle misses on the usual grades and by the usual lean.
  [[nodiscard]] double missed_rad() const;
};

/// A part of a drive from one straight moment to the next. Time, way and turns grow alike over
/// whole drives, and apart in windows.
struct Window {
  std::size_t drive = 0;  ///< place of its drive in the record
  std::size_t index = 0;  ///< place in its drive
  DriveEvidence sums;
};

/// Rows of evidence: errors of the heading over drives, and over windows of them.
struct DriveRecord {
  truth::VerticalAxis vertical;
  std::size_t axis_count = 3;
  bool has_acceleration = false;
  bool has_headings_at_stops_only = false;  ///< nothing watched the heading on the way
  double reference_sigma_rad = 0.0;         ///< standard deviation of a heading of the reference
  double way_sigma_rad = 0.0;  ///< standard deviation of what the reference errs by on each way
  std::vector<DriveEvidence> drives;
  std::vector<std::size_t> number;  ///< number of each drive, of which flawed ones are left out
  /// Windows of all drives but the last of each, which follows from the drive and the others. There
  /// are none, or enough for a scatter of their own.
  std::vector<Window> windows;
  /// Covariance of the errors by noise and by the bias between its measurements, of the drives and
  /// then of the windows [rad^2]
  Eigen::MatrixXd bias_rad2;
  std::size_t left_out = 0;            ///< drives with a flaw, or spoilt by a finding
  std::vector<TraceFinding> findings;  ///< found in the rows and in the reference of single drives
  std::string obstacle;                ///< reason why there are no drives; empty if there are

  [[nodiscard]] std::size_t size() const { return drives.size(); }
  /// Number of the rows of evidence: the drives, and then the windows.
  [[nodiscard]] std::size_t rows() const { return drives.size() + windows.size(); }
  [[nodiscard]] const DriveEvidence& row(std::size_t i) const {
    return i < size() ? drives[i] : windows[i - size()].sums;
  }
  /// Rows of some drives, by their places in increasing order.
  [[nodiscard]] std::vector<std::size_t> rows_of(const std::vector<std::size_t>& places) const;
  /// Errors of all rows [rad].
  [[nodiscard]] Eigen::VectorXd errors() const;
  /// Covariance of the errors of all rows but for a factor. Rows share the measurements of the
  /// bias, and neighbours the heading of the reference between them.
  [[nodiscard]] Eigen::MatrixXd covariance() const;
};

/// Some drives of a record, by their places in increasing order.
[[nodiscard]] DriveRecord picked(const DriveRecord& record, const std::vector<std::size_t>& places);

/// A record without its windows.
[[nodiscard]] DriveRecord whole_drives(DriveRecord record);

/// Some rows of a matrix.
[[nodiscard]] Eigen::MatrixXd picked_rows(const Eigen::MatrixXd& matrix,
                                          const std::vector<std::size_t>& rows);

}  // namespace zerorate::diagnose
