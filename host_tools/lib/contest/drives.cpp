#include "host_tools/lib/contest/drives.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "host_tools/lib/contest/drive_models.hpp"
#include "host_tools/lib/contest/exponential_means.hpp"
#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::contest {
namespace {

namespace fs = std::filesystem;
using app::Predictor;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Memories that the tuned competitors choose from: two a decade, from seconds to a day.
constexpr std::array kMemories_s = {3.0, 10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4, 3e4, 1e5};
constexpr std::size_t kMemories = kMemories_s.size();

using Sums = DriveSums;
using Results = DriveResults;

using AxisScores = std::array<evaluate::DriveScores, app::kPredictors>;
using AllScores = decltype(evaluate::ReplayResult::scores);

Sums predictor_sums(const AxisScores& scores, Predictor predictor) {
  return sums_of(scores[static_cast<std::size_t>(predictor)]);
}

/// All contestants on one axis, with every memory of the tuned ones.
struct AxisSums {
  Sums kalman_extended;
  Sums kalman_base;
  Sums moving_average;
  Sums calibration_mean;
  std::array<Sums, kMemories> exponential_mean;
  std::array<Sums, kMemories> random_walk_filter;

  AxisSums& operator+=(const AxisSums& other) {
    kalman_extended += other.kalman_extended;
    kalman_base += other.kalman_base;
    moving_average += other.moving_average;
    calibration_mean += other.calibration_mean;
    for (std::size_t i = 0; i < kMemories; ++i) {
      exponential_mean[i] += other.exponential_mean[i];
      random_walk_filter[i] += other.random_walk_filter[i];
    }
    return *this;
  }
};

class Contest {
 public:
  Contest(const std::vector<fs::path>& paths, const DriveContestOptions& options)
      : paths_(paths), options_(options), fits_(paths.size()) {}

  DriveContest run(const parallel::Progress& progress) {
    fit_all();
    replay_all(progress);
    return standings();
  }

 private:
  /// A recording and an axis of it: what the bootstrap draws.
  struct Cluster {
    std::size_t recording;
    std::size_t axis;
  };

  [[nodiscard]] std::size_t schedules() const { return options_.schedules.size(); }

  void fit_all() {
    parallel::for_each(
        paths_.size(), options_.threads,
        [&](std::size_t i) { fits_[i] = fit_recording(paths_[i], options_.fit_by, options_); }, {});
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      for (const DriveContest::AxisModels& fit : fits_[i]) {
        if (fit.is_scored) clusters_.push_back({i, fit.axis});
      }
    }
  }

  [[nodiscard]] std::vector<model::SensorModel> models_for(
      const Cluster& cluster, model::SensorModel DriveContest::AxisModels::*which) const {
    auto lent = lent_models(fits_, options_.fit_on, cluster.recording, cluster.axis, which);
    if (lent.empty()) {
      throw std::invalid_argument(
          "parameters from other recordings need at least two recordings with the same axes; "
          "--fit-on itself takes those of hindsight");
    }
    return shared_models(std::move(lent));
  }

  void replay_all(const parallel::Progress& progress) {
    const std::size_t runs = schedules() * options_.seeds;
    std::vector<std::vector<AxisSums>> outcomes(paths_.size() * runs);
    parallel::for_each(
        outcomes.size(), options_.threads,
        [&](std::size_t i) {
          evaluate::ScheduleParams schedule = options_.schedules[i % runs / options_.seeds];
          schedule.seed = options_.first_seed + i % options_.seeds;
          outcomes[i] = replay_one(i / runs, schedule);
        },
        progress);
    sums_.assign(paths_.size(), std::vector<std::vector<AxisSums>>(schedules()));
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      auto& sums = sums_[i / runs][i % runs / options_.seeds];
      sums.resize(outcomes[i].size());
      for (std::size_t axis = 0; axis < sums.size(); ++axis) sums[axis] += outcomes[i][axis];
    }
  }

  [[nodiscard]] std::vector<AxisSums> replay_one(std::size_t recording,
                                                 const evaluate::ScheduleParams& schedule) const {
    std::vector<AxisSums> axes(fits_[recording].size());
    replay_fitted(recording, schedule, axes);
    replay_tuned(recording, schedule, axes);
    return axes;
  }

  /// Every axis has a model of its own, and therefore replays of its own.
  void replay_fitted(std::size_t recording, const evaluate::ScheduleParams& schedule,
                     std::vector<AxisSums>& axes) const {
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      if (!fits_[recording][axis].is_scored) continue;
      const Cluster cluster{recording, axis};
      const auto scores = [&](const model::SensorModel& model) {
        return replay(recording, schedule, model)[axis];
      };
      const auto mean_over = [&](const std::vector<model::SensorModel>& models) {
        Sums sums;
        for (const auto& model : models) sums += predictor_sums(scores(model), Predictor::kalman);
        return sums / static_cast<double>(models.size());
      };
      const auto extended = models_for(cluster, &DriveContest::AxisModels::extended);
      axes[axis].kalman_extended = mean_over(extended);
      axes[axis].kalman_base = mean_over(models_for(cluster, &DriveContest::AxisModels::base));
      const auto of_windows = scores(extended.front());
      axes[axis].moving_average = predictor_sums(of_windows, Predictor::moving_average);
      axes[axis].calibration_mean = predictor_sums(of_windows, Predictor::calibration_mean);
    }
  }

  /// One replay a memory serves all axes: the steady filter of a random walk forgets with the time
  /// constant N / K, whatever N is. Its interval would need the sensor's N and is left out.
  void replay_tuned(std::size_t recording, const evaluate::ScheduleParams& schedule,
                    std::vector<AxisSums>& axes) const {
    constexpr double kN = 1e-3;
    ExponentialMeans means{kMemories_s, axes.size()};
    for (std::size_t m = 0; m < kMemories; ++m) {
      const model::SensorModel walk{.white = {.angle_random_walk_rad_per_sqrt_s = kN},
                                    .rate_random_walk = model::RateRandomWalk{kN / kMemories_s[m]}};
      evaluate::ReplayObserver observer;
      if (m == 0) observer.on_sample = means.observer();
      const auto scores = replay(recording, schedule, walk, observer);
      for (std::size_t axis = 0; axis < axes.size(); ++axis) {
        axes[axis].random_walk_filter[m] = predictor_sums(scores[axis], Predictor::kalman);
        axes[axis].random_walk_filter[m].covered = kNan;
      }
    }
    means.finish();
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      for (std::size_t m = 0; m < kMemories; ++m) {
        axes[axis].exponential_mean[m] = sums_of(means.scores(axis, m));
        axes[axis].exponential_mean[m].covered = kNan;
      }
    }
  }

  [[nodiscard]] AllScores replay(std::size_t recording, const evaluate::ScheduleParams& schedule,
                                 const model::SensorModel& model,
                                 const evaluate::ReplayObserver& observer = {}) const {
    recording::Reader reader{input_of(paths_[recording], options_)};
    // Models that were fitted are compared: they are taken at their word.
    const evaluate::ReplayOptions options{.model = model,
                                          .filter_rate_hz = options_.filter_rate_hz,
                                          .schedule = schedule,
                                          .learns_noise = false};
    return evaluate::replay(reader, options, observer).scores;
  }

  /// The memory with the least drift, relative to the yardstick, on the recordings that lend.
  [[nodiscard]] Sums tuned(const Cluster& cluster, std::size_t schedule,
                           std::array<Sums, kMemories> AxisSums::*which) const {
    std::array<double, kMemories> drift{};
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      if (!lends_to(fits_, options_.fit_on, i, cluster.recording, cluster.axis)) continue;
      const AxisSums& lent = sums_[i][schedule][cluster.axis];
      for (std::size_t m = 0; m < kMemories; ++m) {
        drift[m] += (lent.*which)[m].squares_rad2 / lent.calibration_mean.squares_rad2;
      }
    }
    const auto best = std::min_element(drift.begin(), drift.end()) - drift.begin();
    return (sums_[cluster.recording][schedule][cluster.axis].*
            which)[static_cast<std::size_t>(best)];
  }

  [[nodiscard]] Sums result(Contestant who, const Cluster& cluster, std::size_t schedule) const {
    const AxisSums& sums = sums_[cluster.recording][schedule][cluster.axis];
    switch (who) {
      case Contestant::kalman_extended:
        return sums.kalman_extended;
      case Contestant::kalman_base:
        return sums.kalman_base;
      case Contestant::random_walk_filter:
        return tuned(cluster, schedule, &AxisSums::random_walk_filter);
      case Contestant::exponential_mean:
        return tuned(cluster, schedule, &AxisSums::exponential_mean);
      case Contestant::moving_average:
        return sums.moving_average;
      case Contestant::calibration_mean:
        break;
    }
    return sums.calibration_mean;
  }

  [[nodiscard]] Results results(Contestant who) const {
    Results all(clusters_.size());
    for (std::size_t c = 0; c < clusters_.size(); ++c) {
      for (std::size_t s = 0; s < schedules(); ++s) all[c].push_back(result(who, clusters_[c], s));
    }
    return all;
  }

  [[nodiscard]] DriveContest standings() const {
    DriveContest contest{.options = options_};
    for (const fs::path& path : paths_) contest.recordings.push_back(path.filename().string());
    for (const Fits& fits : fits_)
      std::ranges::copy_if(fits, std::back_inserter(contest.fits),
                           &DriveContest::AxisModels::is_scored);
    contest.by_schedule.resize(schedules());
    const Standings field{results(Contestant::calibration_mean), options_.first_seed};
    const ScheduleRange all{0, schedules()};
    contest.drives = static_cast<std::size_t>(field.drives(all));
    if (contest.drives == 0) {
      throw recording::DataError(
          "no drive followed a calibration: the recordings are too short for these schedules");
    }
    for (std::size_t who = 0; who < kContestants; ++who) {
      const Results own = results(static_cast<Contestant>(who));
      for (std::size_t s = 0; s < schedules(); ++s) {
        contest.by_schedule[s][who] = field.standing(own, {s, s + 1});
      }
      contest.overall[who] = field.standing(own, all);
    }
    contest.extended_over_base =
        field.ratio(results(Contestant::kalman_extended), results(Contestant::kalman_base), all);
    return contest;
  }

  const std::vector<fs::path>& paths_;
  const DriveContestOptions& options_;
  std::vector<Fits> fits_;
  std::vector<Cluster> clusters_;
  std::vector<std::vector<std::vector<AxisSums>>> sums_;  ///< index: recording, schedule, axis
};

}  // namespace

std::string_view name(Contestant contestant, FitBy fit_by) {
  const bool is_diagnosed = fit_by == FitBy::diagnosis;
  switch (contestant) {
    case Contestant::kalman_extended:
      return is_diagnosed ? "extended by the diagnosis" : "decade Kalman, order fitted";
    case Contestant::kalman_base:
      return "decade Kalman, d = 1/2";
    case Contestant::random_walk_filter:
      return "random-walk Kalman, tuned";
    case Contestant::exponential_mean:
      return "exponential mean, tuned";
    case Contestant::moving_average:
      return "moving average";
    case Contestant::calibration_mean:
      return "calibration mean";
  }
  return "unknown";
}

DriveContest run_drive_contest(const std::vector<fs::path>& recordings,
                               const DriveContestOptions& options,
                               const parallel::Progress& progress) {
  return Contest{recordings, options}.run(progress);
}

}  // namespace zerorate::contest
