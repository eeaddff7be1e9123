/// @file
/// True stops and true drives of a vehicle, by a reference system.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/truth/track.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::truth {

/// The sensor's axis about which the vehicle's heading counts.
struct VerticalAxis {
  std::size_t axis = 2;
  double sign = 1.0;         ///< sense of the heading over the axis' rate
  double correlation = 1.0;  ///< turns over one second; 1 where the user named the axis
  double turns_ratio = 1.0;  ///< turns of the reference over those of the axis
};

/// Reads "z" or "-z". Throws std::invalid_argument.
[[nodiscard]] VerticalAxis parse_vertical_axis(std::string_view text);
/// "z" or "-z"; "rate" or "-rate" of a single axis.
[[nodiscard]] std::string name(const VerticalAxis& vertical, std::size_t axis_count);

/// A time without motion.
struct Stop {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;  ///< newest time at which the vehicle certainly stands: the departure

  [[nodiscard]] std::int64_t middle_ns() const { return from_ns + (to_ns - from_ns) / 2; }
};

/// Why a drive cannot be scored.
enum class Flaw : std::uint8_t {
  none,
  heading_missing,  ///< the reference's heading has a gap in the drive or beside it
  heading_jump,     ///< the reference's heading jumped, and the gyro did not
  rate_missing,     ///< the gyro has a gap in the drive
  no_bias,          ///< the node had not measured a bias by the departure
};
[[nodiscard]] std::string_view name(Flaw flaw);

/// A stop lasts at least so long: the node's settle time and hold-back, and twice that of rest.
inline constexpr double kShortestStop_s = 4.0;

/// From the middle of a stop to the middle of the next.
struct Drive {
  std::int64_t from_ns = 0;
  std::int64_t departure_ns = 0;
  std::int64_t arrival_ns = 0;  ///< beginning of the next stop
  std::int64_t to_ns = 0;
  double turn_rad = 0.0;      ///< turn of the heading from middle to middle
  double way_turn_rad = 0.0;  ///< turn of the heading from way_from_ns() to way_to_ns()
  Flaw flaw = Flaw::none;

  /// Rest on both sides of the way, in which a late reference catches up.
  static constexpr auto kBesideTheWay_ns = static_cast<std::int64_t>(kShortestStop_s * 0.5e9);
  [[nodiscard]] std::int64_t way_from_ns() const {
    return std::max(from_ns, departure_ns - kBesideTheWay_ns);
  }
  [[nodiscard]] std::int64_t way_to_ns() const {
    return std::min(to_ns, arrival_ns + kBesideTheWay_ns);
  }
};

struct TruthOptions {
  std::optional<VerticalAxis> vertical;       ///< nullopt: found
  std::optional<double> reference_error_rad;  ///< nullopt: estimated at the stops
  double usable_from_s = 0.0;  ///< time in the recording; before, the reference was still aligning
};

struct Truth {
  Series heading_rad;
  /// All headings were measured at stops. A drive is from one heading to the next then, whatever
  /// stops lie between; the gyro counts whole turns.
  bool has_headings_at_stops_only = false;
  /// Noise of the reference's speed at rest, and the limit below which it stands [m/s].
  double speed_noise_m_s = 0.0;
  double speed_limit_m_s = 0.0;
  std::vector<Stop> stops;
  std::vector<Drive> drives;
  VerticalAxis vertical;
  /// Root mean square of the heading's change over a stop, in which the true one is 0; NaN without
  /// a heading. The reference's error over a drive is not less.
  double error_at_stops_rad = 0.0;
  /// Standard deviation of the reference's turn over a drive, as taken for the coverage.
  double reference_error_rad = 0.0;
  /// Why no drive can be scored; empty if they can.
  std::string obstacle;
};

/// Stops by the reference's speed. The speed's noise is the lower quartile of its root mean square
/// in spans of 2 s that never exceed 0.5 m/s; a stop stays below 6 times that, at least 0.02 m/s
/// and at most 0.3 m/s, for kShortestStop_s.
void find_stops(const Series& speed_m_s, Truth& truth);

/// Turns in all, below which they do not determine the vertical axis.
inline constexpr double kLeastTurns_rad = 30.0 * units::kRadPerDeg;

/// The axis whose integral follows the reference's heading. The least squares over turns of at
/// least a second must have a correlation of 0.7 and turns within 25 % of the reference's. Where no
/// axis has, the turns in which axis and reference agree roughly must, and be most of all turns.
/// Where none has even then, turns of 12 s are tried, for a reference that is late.
/// The time in which an axis repeats one value does not count.
/// @return nullopt if the reference turns by less than kLeastTurns_rad
/// Throws recording::DataError if no axis does so.
[[nodiscard]] std::optional<VerticalAxis> find_vertical_axis(const Track& track);

/// Throws recording::DataError if the vertical axis is ambiguous.
[[nodiscard]] Truth find_truth(const Track& track, const TruthOptions& options);

/// Reads a recording to its end; nullopt where it has no column of a reference. Throws
/// recording::Error, recording::DataError.
[[nodiscard]] std::optional<Truth> read_truth(recording::Reader& reader,
                                              const TruthOptions& options);

}  // namespace zerorate::truth
