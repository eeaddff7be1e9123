#include "host_tools/lib/diagnose/drive/drive_record.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace zerorate::diagnose {
namespace {

/// Share of every turn that an axis misses on grades: 0.045 % on a grade of 3 %, never less than
/// none. The mean is that of grades of 1.5 %.
constexpr double kMissedOnGrades = 1.1e-4;
/// Its standard deviation in all turns alike, and that in each window by itself.
constexpr double kAlikeOnGrades = 3e-4;
constexpr double kApartOnGrades = 2e-4;
/// Share that an axis misses by the lean in curves, half the square of the angle [1/g^2]. A car
/// leans by some 5 deg per g, a robot by none, so that the standard deviation is nearly as large.
constexpr double kMissedByLean_per_g2 = 3.8e-3;
constexpr double kLeanSigma_per_g2 = 3e-3;

/// A heading of the reference between two rows: at a stop, or between two windows of a drive.
struct Boundary {
  std::size_t drive = 0;  ///< number of the drive after it
  std::size_t window = 0;

  bool operator==(const Boundary&) const = default;
};

/// The headings at both ends of a row.
std::pair<Boundary, Boundary> ends_of(const DriveRecord& record, std::size_t row) {
  if (row < record.size()) {
    const std::size_t number = record.number[row];
    return {{number, 0}, {number + 1, 0}};
  }
  const Window& window = record.windows[row - record.size()];
  const std::size_t number = record.number[window.drive];
  return {{number, window.index}, {number, window.index + 1}};
}

/// Covariance of the errors that the headings at the ends make of two rows, over the variance of a
/// heading.
double shared_headings(const DriveRecord& record, std::size_t one, std::size_t other) {
  const auto [from, to] = ends_of(record, one);
  const auto [other_from, other_to] = ends_of(record, other);
  return (from == other_from ? 1.0 : 0.0) + (to == other_to ? 1.0 : 0.0) -
         (from == other_to ? 1.0 : 0.0) - (to == other_from ? 1.0 : 0.0);
}

std::size_t drive_of(const DriveRecord& record, std::size_t row) {
  return row < record.size() ? row : record.windows[row - record.size()].drive;
}

/// Whether two rows have windows in common, which are all those of the row farther behind.
bool shares_windows(const DriveRecord& record, std::size_t one, std::size_t other) {
  const bool are_two_windows = one != other && std::min(one, other) >= record.size();
  return drive_of(record, one) == drive_of(record, other) && !are_two_windows;
}

/// Sum of the squares of the paths of the windows of each row.
std::vector<double> squared_paths(const DriveRecord& record) {
  std::vector<double> squares(record.rows());
  std::vector<double> left_rad(record.size());
  for (std::size_t k = 0; k < record.size(); ++k) left_rad[k] = record.drives[k].path_rad;
  for (std::size_t i = record.size(); i < record.rows(); ++i) {
    const std::size_t drive = drive_of(record, i);
    const double path_rad = record.row(i).path_rad;
    squares[i] = path_rad * path_rad;
    squares[drive] += squares[i];
    left_rad[drive] -= path_rad;
  }
  for (std::size_t k = 0; k < record.size(); ++k) squares[k] += left_rad[k] * left_rad[k];
  return squares;
}

}  // namespace

double DriveEvidence::missed_rad() const {
  return kMissedOnGrades * turn_rad + kMissedByLean_per_g2 * leant_rad_g2;
}

void DriveEvidence::add(const DriveEvidence& next) {
  length_s += next.length_s;
  error_rad += next.error_rad;
  turn_rad += next.turn_rad;
  path_rad += next.path_rad;
  leant_rad_g2 += next.leant_rad_g2;
  moving_s += next.moving_s;
  metres += next.metres;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    turned_rad[axis] += next.turned_rad[axis];
    force_g_s[axis] += next.force_g_s[axis];
  }
  vibration_g2_s += next.vibration_g2_s;
}

std::vector<std::size_t> DriveRecord::rows_of(const std::vector<std::size_t>& places) const {
  std::vector<std::size_t> chosen = places;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    if (std::ranges::binary_search(places, windows[k].drive)) chosen.push_back(size() + k);
  }
  return chosen;
}

Eigen::VectorXd DriveRecord::errors() const {
  Eigen::VectorXd errors(static_cast<Eigen::Index>(rows()));
  for (std::size_t i = 0; i < rows(); ++i) errors[static_cast<Eigen::Index>(i)] = row(i).error_rad;
  return errors;
}

Eigen::MatrixXd DriveRecord::covariance() const {
  const std::vector<double> path_rad2 = squared_paths(*this);
  // Variance that rows with the same windows have in common, by a wandering reference and grades.
  const auto by_windows = [&](std::size_t shorter) {
    const double part = row(shorter).length_s / drives[drive_of(*this, shorter)].length_s;
    return std::pow(way_sigma_rad, 2) * part + std::pow(kApartOnGrades, 2) * path_rad2[shorter];
  };
  Eigen::MatrixXd v = bias_rad2;
  for (std::size_t i = 0; i < rows(); ++i) {
    for (std::size_t k = 0; k < rows(); ++k) {
      double& shared = v(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
      shared += std::pow(reference_sigma_rad, 2) * shared_headings(*this, i, k) +
                std::pow(kAlikeOnGrades, 2) * row(i).turn_rad * row(k).turn_rad +
                std::pow(kLeanSigma_per_g2, 2) * row(i).leant_rad_g2 * row(k).leant_rad_g2;
      if (shares_windows(*this, i, k)) shared += by_windows(std::max(i, k));
    }
  }
  return v;
}

Eigen::MatrixXd picked_rows(const Eigen::MatrixXd& matrix, const std::vector<std::size_t>& rows) {
  Eigen::MatrixXd some(static_cast<Eigen::Index>(rows.size()), matrix.cols());
  for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      some(static_cast<Eigen::Index>(i), column) =
          matrix(static_cast<Eigen::Index>(rows[i]), column);
    }
  }
  return some;
}

DriveRecord whole_drives(DriveRecord record) {
  const auto drives = static_cast<Eigen::Index>(record.size());
  record.windows.clear();
  record.bias_rad2 = record.bias_rad2.topLeftCorner(drives, drives).eval();
  return record;
}

DriveRecord picked(const DriveRecord& record, const std::vector<std::size_t>& places) {
  const std::vector<std::size_t> rows = record.rows_of(places);
  DriveRecord some = record;
  some.drives.clear();
  some.number.clear();
  some.windows.clear();
  for (const std::size_t place : places) {
    some.drives.push_back(record.drives[place]);
    some.number.push_back(record.number[place]);
  }
  for (std::size_t i = places.size(); i < rows.size(); ++i) {
    Window window = record.windows[rows[i] - record.size()];
    window.drive =
        static_cast<std::size_t>(std::ranges::lower_bound(places, window.drive) - places.begin());
    some.windows.push_back(window);
  }
  some.bias_rad2 = picked_rows(picked_rows(record.bias_rad2, rows).transpose(), rows);
  return some;
}

}  // namespace zerorate::diagnose
