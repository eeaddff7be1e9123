/// @file
/// Worth of a bias predictor on drives: real recordings made at rest, cut into stops, in which
/// the predictors may learn, and drives, in which they are compared with what the sensor did.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/contest/standings.hpp"
#include "host_tools/lib/evaluate/odometer.hpp"
#include "host_tools/lib/parallel/parallel.hpp"
#include "host_tools/lib/recording/input.hpp"

namespace zerorate::contest {

/// Contestants. The first two and the last two are predictors of the node. The random-walk filter
/// is the node's with another model. The exponential mean is the common method of trackers.
enum class Contestant : std::uint8_t {
  kalman_extended,     ///< decade filter, d fitted; or the model that the diagnosis extended
  kalman_base,         ///< decade filter, d = 1/2
  random_walk_filter,  ///< white noise and a random walk, its memory tuned
  exponential_mean,    ///< mean of all samples at rest so far, its memory tuned
  moving_average,
  calibration_mean,  ///< the yardstick
};
inline constexpr std::size_t kContestants = 6;

/// Method that makes models of recordings.
enum class FitBy : std::uint8_t {
  characterization,  ///< white and 1/f noise by likelihood, its order free and 1/2
  diagnosis,         ///< model of `zerorate diagnose`, and 1/f noise
};

/// @param fit_by  says what the first two are
[[nodiscard]] std::string_view name(Contestant contestant, FitBy fit_by = FitBy::characterization);

/// Where the parameters of a recording's contestants come from.
enum class FitOn : std::uint8_t {
  /// All the other recordings, the same axis: logarithmic means of the fitted noise; of extended
  /// models, which have no mean, each in its turn.
  other,
  itself,  ///< hindsight: a ceiling, not a result
};

struct DriveContestOptions {
  std::vector<evaluate::ScheduleParams> schedules;  ///< mean lengths; each runs with every seed
  std::size_t seeds = 8;
  std::uint64_t first_seed = 1;
  FitOn fit_on = FitOn::other;
  FitBy fit_by = FitBy::characterization;
  std::optional<double> filter_rate_hz{};  ///< see evaluate::ReplayOptions
  std::string axis = "all";                ///< x, y, z or all
  recording::Input format{};               ///< layout of every recording; its path does not count
  unsigned threads = 0;                    ///< 0: as many as the machine has
};

struct DriveContest {
  struct AxisModels {
    std::string recording;
    std::size_t axis;
    bool is_scored;               ///< false: another axis was asked for
    model::SensorModel extended;  ///< fitted to this recording, for use on others
    model::SensorModel base;
  };

  DriveContestOptions options;
  std::vector<std::string> recordings;
  std::vector<AxisModels> fits;
  std::size_t drives = 0;  ///< drives of each contestant
  std::vector<std::array<DriveStanding, kContestants>> by_schedule;
  std::array<DriveStanding, kContestants> overall;
  BootstrapFigure extended_over_base;  ///< ratio of their drifts, as DriveStanding::ratio
};

/// Fits every recording, replays each through the node under every schedule and seed, and compares.
/// The memories of the two tuned competitors are chosen per axis and schedule for the least drift
/// on the recordings that the parameters come from, which is more than the node's own filter gets.
/// Cost: 2 axes + 10 replays a recording, schedule and seed, on all threads.
/// Throws recording::Error; std::invalid_argument if FitOn::other has fewer than two recordings or
/// no drive was made.
[[nodiscard]] DriveContest run_drive_contest(const std::vector<std::filesystem::path>& recordings,
                                             const DriveContestOptions& options,
                                             const parallel::Progress& progress);

}  // namespace zerorate::contest
