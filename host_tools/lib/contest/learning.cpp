#include "host_tools/lib/contest/learning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "firmware/model/hypotheses.hpp"
#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/contest/drive_models.hpp"
#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::contest {
namespace {

namespace fs = std::filesystem;
using app::Predictor;

constexpr auto kFirstDrives = LearningContest::kFirstDrives;

/// Data sheet with an error.
model::SensorModel data_sheet(const model::SensorModel& right, const DataSheetError& error) {
  if (!(error.white > 0.0) || !std::isfinite(error.white) || !(error.flicker > 0.0) ||
      !std::isfinite(error.flicker)) {
    throw std::invalid_argument(
        fmt::format("a factor on the noise of a data sheet must be positive: white {}, flicker {}",
                    error.white, error.flicker));
  }
  if (model::hypotheses_of(right).empty()) {
    throw std::invalid_argument(
        fmt::format("the model {} leaves nothing to learn: it needs a [flicker] and "
                    "[learning] hypotheses of 4 or 12",
                    right.name));
  }
  model::SensorModel wrong = right;
  wrong.white.angle_random_walk_rad_per_sqrt_s *= error.white;
  wrong.flicker->bias_instability_rad_s *= error.flicker;
  model::validate(wrong);
  return wrong;
}

/// One contestant over drives of one axis.
struct PhaseSums {
  DriveSums all;
  DriveSums first;  ///< drives of each run

  PhaseSums& operator+=(const PhaseSums& other) {
    all += other.all;
    first += other.first;
    return *this;
  }
};

/// Contestants on one axis: those of a known model, and two a data sheet.
struct LearningSums {
  PhaseSums yardstick;
  std::array<PhaseSums, kTuned> tuned;
  std::vector<PhaseSums> learning;
  std::vector<PhaseSums> fixed;

  explicit LearningSums(std::size_t cases) : learning(cases), fixed(cases) {}

  LearningSums& operator+=(const LearningSums& other) {
    yardstick += other.yardstick;
    for (std::size_t i = 0; i < kTuned; ++i) tuned[i] += other.tuned[i];
    for (std::size_t i = 0; i < learning.size(); ++i) {
      learning[i] += other.learning[i];
      fixed[i] += other.fixed[i];
    }
    return *this;
  }
};

/// Outcome of one schedule and seed on one recording.
struct Outcome {
  std::vector<LearningSums> axes;
  std::vector<std::optional<evaluate::LearntNoises>> learnt;  ///< index: case
};

/// One replay's drives, scored in all and at first.
class Scored {
 public:
  Scored(const recording::Input& input, const evaluate::ReplayOptions& options) {
    recording::Reader reader{input};
    std::array<std::array<std::size_t, app::kPredictors>, 3> drives{};
    const evaluate::ReplayObserver observer{.on_drive = [&](const evaluate::ReplayedDrive& drive) {
      const auto p = static_cast<std::size_t>(drive.predictor);
      if (drives[drive.axis][p]++ < kFirstDrives) first_[drive.axis][p].add(drive.outcome);
    }};
    result_ = evaluate::replay(reader, options, observer);
  }

  [[nodiscard]] PhaseSums sums(std::size_t axis, Predictor predictor) const {
    const auto p = static_cast<std::size_t>(predictor);
    return {sums_of(result_.scores[axis][p]), sums_of(first_[axis][p])};
  }
  [[nodiscard]] const std::optional<evaluate::LearntNoises>& learnt() const {
    return result_.learnt;
  }

 private:
  evaluate::ReplayResult result_;
  decltype(evaluate::ReplayResult::scores) first_{};
};

class LearningRuns {
 public:
  LearningRuns(const std::vector<fs::path>& paths, const LearningOptions& options)
      : paths_(paths), options_(options), fits_(paths.size()) {
    for (const DataSheetError& error : options.cases) {
      data_sheets_.push_back(data_sheet(options.model, error));
    }
  }

  LearningContest run(const parallel::Progress& progress) {
    fit_all();
    std::vector<Outcome> outcomes(paths_.size() * runs());
    parallel::for_each(
        outcomes.size(), options_.drives.threads,
        [&](std::size_t i) { outcomes[i] = replay_one(i / runs(), schedule(i)); }, progress);
    return standings(outcomes);
  }

 private:
  using Results = DriveResults;

  [[nodiscard]] std::size_t schedules() const { return options_.drives.schedules.size(); }
  /// Runs of a recording.
  [[nodiscard]] std::size_t runs() const { return schedules() * options_.drives.seeds; }
  [[nodiscard]] std::size_t schedule_index(std::size_t i) const {
    return i % runs() / options_.drives.seeds;
  }
  [[nodiscard]] evaluate::ScheduleParams schedule(std::size_t i) const {
    evaluate::ScheduleParams schedule = options_.drives.schedules[schedule_index(i)];
    schedule.seed = options_.drives.first_seed + i % options_.drives.seeds;
    return schedule;
  }

  void fit_all() {
    parallel::for_each(paths_.size(), options_.drives.threads,
                       [&](std::size_t i) {
                         fits_[i] =
                             fit_recording(paths_[i], FitBy::characterization, options_.drives);
                       },
                       {});
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      for (std::size_t axis = 0; axis < fits_[i].size(); ++axis) {
        if (tuned_models(i, axis, FitOn::other).empty()) {
          throw std::invalid_argument(
              "parameters from other recordings need at least two recordings with the same axes");
        }
      }
    }
  }

  [[nodiscard]] std::vector<model::SensorModel> tuned_models(std::size_t recording,
                                                             std::size_t axis, FitOn fit_on) const {
    return lent_models(fits_, fit_on, recording, axis, &DriveContest::AxisModels::extended);
  }

  [[nodiscard]] std::vector<std::size_t> scored_axes(std::size_t recording) const {
    std::vector<std::size_t> axes;
    for (const DriveContest::AxisModels& fit : fits_[recording]) {
      if (fit.is_scored) axes.push_back(fit.axis);
    }
    return axes;
  }

  [[nodiscard]] Scored replay(std::size_t recording, const evaluate::ScheduleParams& schedule,
                              const model::SensorModel& model, bool learns) const {
    return Scored{input_of(paths_[recording], options_.drives),
                  {.model = model,
                   .filter_rate_hz = options_.drives.filter_rate_hz,
                   .schedule = schedule,
                   .learns_noise = learns}};
  }

  [[nodiscard]] Outcome replay_one(std::size_t recording,
                                   const evaluate::ScheduleParams& schedule) const {
    Outcome outcome;
    outcome.axes.assign(fits_[recording].size(), LearningSums{data_sheets_.size()});
    replay_tuned(recording, schedule, outcome);
    for (std::size_t c = 0; c < data_sheets_.size(); ++c) {
      const Scored learning = replay(recording, schedule, data_sheets_[c], true);
      const Scored fixed = replay(recording, schedule, data_sheets_[c], false);
      for (std::size_t axis = 0; axis < outcome.axes.size(); ++axis) {
        outcome.axes[axis].learning[c] = learning.sums(axis, Predictor::kalman);
        outcome.axes[axis].fixed[c] = fixed.sums(axis, Predictor::kalman);
      }
      outcome.learnt.push_back(learning.learnt());
    }
    return outcome;
  }

  /// Every axis has a model of its own, and therefore replays of its own.
  void replay_tuned(std::size_t recording, const evaluate::ScheduleParams& schedule,
                    Outcome& outcome) const {
    for (std::size_t axis = 0; axis < outcome.axes.size(); ++axis) {
      if (!fits_[recording][axis].is_scored) continue;
      LearningSums& sums = outcome.axes[axis];
      for (const auto& [tuned, fit_on] : {std::pair{Tuned::on_others, FitOn::other},
                                          std::pair{Tuned::hindsight, FitOn::itself}}) {
        const auto model = mean_model(tuned_models(recording, axis, fit_on));
        const Scored scored = replay(recording, schedule, model, false);
        sums.tuned[static_cast<std::size_t>(tuned)] = scored.sums(axis, Predictor::kalman);
        if (tuned == Tuned::on_others) {
          sums.yardstick = scored.sums(axis, Predictor::calibration_mean);
        }
      }
    }
  }

  /// PhaseSums over the seeds, by recording-axis and schedule.
  [[nodiscard]] std::vector<std::vector<LearningSums>> summed(
      const std::vector<Outcome>& outcomes) const {
    std::vector<std::vector<LearningSums>> sums;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      const std::vector<std::size_t> axes = scored_axes(i / runs());
      if (i % runs() == 0) {
        sums.resize(sums.size() + axes.size(),
                    std::vector<LearningSums>(schedules(), LearningSums{data_sheets_.size()}));
      }
      for (std::size_t k = 0; k < axes.size(); ++k) {
        sums[sums.size() - axes.size() + k][schedule_index(i)] += outcomes[i].axes[axes[k]];
      }
    }
    return sums;
  }

  [[nodiscard]] std::vector<LearntRun> learnt_runs(const std::vector<Outcome>& outcomes,
                                                   std::size_t which) const {
    std::vector<LearntRun> learnt;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      const auto& noises = outcomes[i].learnt[which];
      if (!noises) continue;
      for (const std::size_t axis : scored_axes(i / runs())) {
        learnt.push_back({i / runs(), axis, schedule_index(i), schedule(i).seed,
                          evaluate::learnt_model((*noises)[axis])});
      }
    }
    return learnt;
  }

  [[nodiscard]] LearningContest standings(const std::vector<Outcome>& outcomes) const {
    LearningContest contest{.options = options_};
    for (const fs::path& path : paths_) contest.recordings.push_back(path.filename().string());
    for (const Fits& fits : fits_) {
      std::ranges::copy_if(fits, std::back_inserter(contest.fits),
                           &DriveContest::AxisModels::is_scored);
    }
    const auto sums = summed(outcomes);
    const auto results = [&](auto which, DriveSums PhaseSums::*drives) {
      Results all;
      for (const auto& by_schedule : sums) {
        auto& of_cluster = all.emplace_back();
        for (const LearningSums& axis : by_schedule) of_cluster.push_back(which(axis).*drives);
      }
      return all;
    };
    const auto yardstick = [](const LearningSums& axis) { return axis.yardstick; };
    const auto on_others = [](const LearningSums& axis) { return axis.tuned[0]; };
    const Standings field{results(yardstick, &PhaseSums::all), options_.drives.first_seed};
    const Standings at_first{results(yardstick, &PhaseSums::first), options_.drives.first_seed};
    const ScheduleRange all{0, schedules()};
    contest.drives = static_cast<std::size_t>(field.drives(all));
    if (contest.drives == 0) {
      throw recording::DataError(
          "no drive followed a calibration: the recordings are too short for these schedules");
    }
    const auto standings_of = [&](auto which) {
      LearningStandings standings;
      const Results own = results(which, &PhaseSums::all);
      for (std::size_t s = 0; s < schedules(); ++s) {
        standings.by_schedule.push_back(field.standing(own, {s, s + 1}));
      }
      standings.overall = field.standing(own, all);
      standings.first_drives = at_first.standing(results(which, &PhaseSums::first), all);
      standings.over_on_others = field.ratio(own, results(on_others, &PhaseSums::all), all);
      return standings;
    };
    for (std::size_t i = 0; i < kTuned; ++i) {
      contest.tuned[i] = standings_of([i](const LearningSums& axis) { return axis.tuned[i]; });
    }
    for (std::size_t c = 0; c < data_sheets_.size(); ++c) {
      contest.cases.push_back(
          {.error = options_.cases[c],
           .learning = standings_of([c](const LearningSums& axis) { return axis.learning[c]; }),
           .fixed = standings_of([c](const LearningSums& axis) { return axis.fixed[c]; }),
           .runs = learnt_runs(outcomes, c)});
    }
    return contest;
  }

  const std::vector<fs::path>& paths_;
  const LearningOptions& options_;
  std::vector<model::SensorModel> data_sheets_;
  std::vector<Fits> fits_;
};

}  // namespace

std::string_view name(Tuned tuned) {
  return tuned == Tuned::on_others ? "fitted on the other recordings"
                                   : "fitted on the same recording, in hindsight";
}

LearningContest run_learning_contest(const std::vector<fs::path>& recordings,
                                     const LearningOptions& options,
                                     const parallel::Progress& progress) {
  return LearningRuns{recordings, options}.run(progress);
}

}  // namespace zerorate::contest
