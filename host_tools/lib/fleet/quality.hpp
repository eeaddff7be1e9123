/// @file
/// Yield, capability and control charts of a fleet: what a report to those who pay is asked for.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace zerorate::fleet {

struct Population;
struct Limits;

/// Range that a figure must lie in, SI units.
struct Range {
  double lo = 0.0;
  double hi = 0.0;
};

/// An index with its 95 % interval.
struct Index {
  double value = 0.0;
  double lo = 0.0;
  double hi = 0.0;
};

/// How far a figure stays from its limits, of which one may be infinite.
struct Capability {
  double mean = 0.0;
  double spread = 0.0;               ///< standard deviation of all
  std::optional<double> lot_spread;  ///< standard deviation within lots; nullopt for one lot
  Index ppk;                         ///< distance of the nearer limit over three spreads
  std::optional<Index> cpk;          ///< index by the spread within lots
  std::size_t below = 0;             ///< values below the lower limit
  std::size_t above = 0;
};

/// Ppk and Cpk, with intervals by Bissell (1990), normal values assumed. Errors of measurement are
/// part of the spread: the truth is no less capable.
/// @param values  values of a figure
/// @param lots  lot of each value, from 0
/// @param sensors  number of independent ones among them: the axes of a sensor resemble each other
/// Returns nullopt for fewer than three sensors, values that are all alike, and no limit.
[[nodiscard]] std::optional<Capability> capability_of(std::span<const double> values,
                                                      std::span<const std::size_t> lots,
                                                      std::size_t sensors, const Range& limits);

/// Share of k in n with its 95 % interval (Wilson 1927).
[[nodiscard]] Index share_of(std::size_t k, std::size_t n);

/// Chart of individual values: in control are those within three sigma of the mean, where sigma is
/// the mean step from one to the next over 1.128 (Shewhart's chart of individuals).
struct ControlChart {
  double centre = 0.0;
  double lo = 0.0;
  double hi = 0.0;
  std::vector<std::size_t> outside;  ///< places of the values outside
};
/// @param values  at least two, in the order of manufacture
[[nodiscard]] ControlChart control_chart_of(std::span<const double> values);

/// A figure of the fleet; N and B by their logarithms.
struct QualityFigure {
  std::string key;              ///< name in the file of limits
  std::optional<Range> limits;  ///< limits of an axis, where the file has them
  std::optional<Capability> capability;
  ControlChart chart;          ///< chart in Quality::order
  std::vector<double> values;  ///< mean of the axes of each sensor in that order
};

struct Quality {
  /// Sensors by their lots, then by their names, numbers in them by their size: lots or names that
  /// begin with a date, or count, are in the order of time.
  std::vector<std::size_t> order;
  std::vector<QualityFigure> figures;  ///< N, B and d
  bool has_limits = false;
  std::size_t passed = 0;  ///< sensors; the rest is 0 without limits
  std::size_t failed = 0;
  std::size_t too_short = 0;
  Index yield;  ///< share of the sensors that passed
};

/// Whether a name comes before another, with numbers by their size: L2 before L10.
[[nodiscard]] bool comes_before(std::string_view one, std::string_view other);

/// Judges every sensor by the 95 % intervals of its recordings, as accept() does, and the fleet as
/// a whole. Estimates are not drawn towards the population.
/// @param limits  nullptr: there is no yield and no capability
[[nodiscard]] Quality quality_of(const Population& population, const Limits* limits);

}  // namespace zerorate::fleet
