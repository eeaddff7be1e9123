/// @file
/// The samples of a recording that were measured at rest, and their means over filter ticks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "core/samples/tick_average.hpp"
#include "core/standstill/standstill.hpp"
#include "host_tools/lib/identify/levels_near_zero.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::identify {

using TickMean = core::TickMean<recording::kMaxAxes>;

/// Samples that a node would learn from.
struct RestSamples {
  std::size_t axis_count = recording::kMaxAxes;
  bool is_timed_by_rows = false;  ///< the user gave the rate of the rows
  core::Duration sample_period;   ///< the median interval
  /// The mean interval, holes left out (recording::Findings::mean_interval_ns): the period of
  /// N^2 = r T, also where samples come in bursts.
  core::Duration mean_period;
  std::vector<core::Instant> time;
  std::vector<std::array<float, recording::kMaxAxes>> rate_rad_s;  ///< one per time
  std::vector<float> temperature_degc;  ///< one per time, NaN where lost; empty without the column
  /// Specific force, one per time, NaN where lost; empty without the columns.
  std::vector<std::array<float, recording::kMaxAxes>> acceleration_m_s2;

  /// The samples, by index, between which and the one before the vehicle moved, the clock stepped
  /// or nothing was recorded for long; ascending.
  std::vector<std::size_t> after_drives;

  /// Values near zero in rows with motion, of each axis.
  std::array<LevelsNearZero, recording::kMaxAxes> levels_on_the_move;

  core::Duration paused;     ///< clock steps and long pauses between samples, together
  std::uint64_t rows = 0;    ///< rows of the recording
  std::uint64_t moving = 0;  ///< rows left out because the vehicle moved or was about to
  std::uint64_t lost = 0;    ///< rows left out because a rate is missing or time does not advance
  /// Rows whose rate of an axis is empty, nan or infinite.
  std::array<std::uint64_t, recording::kMaxAxes> lost_rates{};
  std::uint64_t wild = 0;      ///< rows left out because the gyro did not measure after power-on
  std::uint64_t outliers = 0;  ///< rows left out by measurements_of(): find_outliers()
  std::uint64_t repeated = 0;  ///< rows left out by without_repeats()
  recording::Findings findings;

  /// Time from the first sample to the last, without the pauses.
  [[nodiscard]] core::Duration span() const { return time.back() - time.front() - paused; }
  /// Name of an axis: "x", or "rate" where there is only one.
  [[nodiscard]] std::string axis_name(std::size_t axis) const {
    return axis_count == 1 ? "rate" : std::string(1, "xyz"[axis]);
  }
};

struct RestOptions {
  core::Standstill::Params standstill;
  bool has_no_odometer = false;  ///< columns of motion are not used
  /// Called now and then with the share of the recording that is read, if known.
  std::function<void(std::optional<double>)> on_progress;
};

/// Reads a recording to its end. Motion comes from its odometer or still column, with the
/// settle time and hold-back of the node; without such a column the sensor was at rest all the
/// time. Memory: 20 bytes a row at rest, 4 more with a temperature, 12 with an acceleration.
/// Throws recording::Error; recording::DataError with fewer than two samples at rest, and where
/// more than half of the rows cannot be used.
[[nodiscard]] RestSamples read_rest_samples(recording::Reader& reader,
                                            const RestOptions& options = {});

/// Cure where an odometer leaves no stop, the end of a sentence.
inline constexpr std::string_view kCalmForAnOdometer =
    "where the odometer counts at rest, as an encoder that chatters does, --still-from gyro takes "
    "the calm of the gyro";

/// Throws recording::DataError where fewer are found than needed and motion took most of the rows:
/// the sentence then names its share and what to do. An encoder that chatters leaves no stop of a
/// whole drive.
/// @param what  is found, such as "filter ticks at rest"
void require_besides_motion(const RestSamples& samples, std::size_t found, std::size_t needed,
                            std::string_view what);

/// Samples, by index, that stand alone or in runs of up to five, 20 standard deviations of the
/// white noise around them away: no noise of a gyro. Ascending.
[[nodiscard]] std::vector<std::size_t> find_outliers(const RestSamples& samples);

/// Samples, by index, of half seconds whose mean lies 10 standard deviations from the median of the
/// sixteen around them: wild values in longer runs, or at the start and the end. The deviation is
/// that of most means. Ascending. There are none below 64 half seconds, and none where they would
/// be more than 5 %: so many are the nature of the recording.
[[nodiscard]] std::vector<std::size_t> find_wild_stretches(const RestSamples& samples);

/// The samples without some of them.
/// @param indices  ascending
[[nodiscard]] RestSamples without(RestSamples rest, const std::vector<std::size_t>& indices);

/// Shortens RestSamples::mean_period where some samples of the sensor are lost (LostShare). Throws
/// recording::DataError where their stamps do not show which.
void find_lost_samples(RestSamples& samples);

/// Means over ticks by the node's own front end. Ticks without samples are absent: gaps and drives
/// are the jumps of TickMean::tick.
/// @param tick at least the sample period
[[nodiscard]] std::vector<TickMean> average_ticks(const RestSamples& samples, core::Duration tick);

/// Indices of the axes that a user names: x, y, z or all. Throws std::invalid_argument for another
/// name, and for an axis that the recording lacks.
[[nodiscard]] std::vector<std::size_t> axes_called(std::string_view name, std::size_t axis_count);

/// A rate without holes, for what needs an even grid.
struct EvenRecord {
  std::vector<double> rate_rad_s;
  double sample_period_s = 0.0;
};

/// The longest run of samples of one axis whose intervals all lie within half a period of the
/// median one; its period is the mean interval.
[[nodiscard]] EvenRecord longest_even_samples(const RestSamples& samples, std::size_t axis);

/// The longest run of ticks of one axis without a hole.
[[nodiscard]] EvenRecord longest_even_ticks(const std::vector<TickMean>& ticks, core::Duration tick,
                                            std::size_t axis);

}  // namespace zerorate::identify
