#include "host_tools/lib/contest/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <utility>

#include "host_tools/lib/identify/rest_samples.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::contest {
namespace {

/// kalman, moving average, calibration mean, and the rival where the node does not have it.
constexpr std::size_t kSeats = app::kPredictors + 1;
constexpr std::size_t kRival = app::kPredictors;
constexpr auto kLastMean = static_cast<std::size_t>(app::Predictor::calibration_mean);
constexpr auto kKalman = static_cast<std::size_t>(app::Predictor::kalman);

/// Squared errors of one stop or drive, a contestant each; NaN where it had no prediction.
using Squares = std::array<double, kSeats>;

/// One log after its replay.
struct LogErrors {
  std::vector<Squares> stops;
  std::vector<Squares> drives;
  std::vector<Turn> turns;  ///< turns of these drives, by kalman
  std::size_t vertical = 0;
  std::size_t predictions = 0;  ///< predictions of single axes
  std::size_t covered = 0;
  bool has_temperature = false;
  bool has_acceleration = false;
};

/// Follows one replay.
class Watch {
 public:
  /// @param rival  nullptr: the mean of the last stop
  /// @param truth  has to outlive it
  Watch(LogErrors& errors, std::vector<std::size_t> axes, std::unique_ptr<RivalBias> rival,
        const std::optional<truth::Truth>& truth)
      : errors_(errors), axes_(std::move(axes)), rival_(std::move(rival)), truth_(truth) {}

  [[nodiscard]] evaluate::ReplayObserver observer() {
    return {.truth = truth_,
            .on_sample = [this](const evaluate::ReplayedSample& sample) { take(sample); },
            .on_stop = [this](const evaluate::ReplayedStop& stop) { take(stop); }};
  }

  /// Errors of the drives, as the heading at the bias of the departure has them.
  void finish(const evaluate::TrueDrives& drives) {
    errors_.vertical = drives.truth.vertical.axis;
    for (std::size_t k = 0; k < std::min(drives.drives.size(), ahead_rad_s_.size()); ++k) {
      const evaluate::ScoredTrueDrive& scored = drives.drives[k];
      if (scored.flaw != truth::Flaw::none) continue;
      Squares squares{};
      for (std::size_t p = 0; p < app::kPredictors; ++p) {
        squares[p] = squared(scored.at_departure[p].drift_rad);
      }
      const double length_s = units::seconds(scored.drive.to_ns - scored.drive.from_ns);
      squares[kRival] = squared(scored.at_departure[kLastMean].drift_rad -
                                truth_->vertical.sign * ahead_rad_s_[k] * length_s);
      errors_.drives.push_back(squares);
      errors_.turns.push_back({scored.drive.turn_rad, scored.at_departure[kKalman].drift_rad});
    }
  }

 private:
  static double squared(double error) { return error * error; }

  void take(const evaluate::ReplayedSample& sample) {
    while (truth_ && ahead_rad_s_.size() < truth_->drives.size() &&
           sample.time_ns >= truth_->drives[ahead_rad_s_.size()].departure_ns) {
      const std::size_t axis = truth_->vertical.axis;
      ahead_rad_s_.push_back((rival_ ? rival_->bias_rad_s(axis) : 0.0) -
                             double{sample.last_stop_mean_rad_s[axis]});
    }
    if (rival_) rival_->take(sample);
  }

  void take(const evaluate::ReplayedStop& stop) {
    Squares squares{};
    for (const std::size_t axis : axes_) {
      for (std::size_t p = 0; p < app::kPredictors; ++p) {
        squares[p] += squared(stop.error_rad_s[axis][p]);
      }
      if (rival_) {
        squares[kRival] += squared(stop.measured_rad_s[axis] - rival_->held_rad_s(axis));
      }
      ++errors_.predictions;
      const double limit_rad_s = statistics::kHalfWidth95 * stop.sigma_rad_s[axis][kKalman];
      if (std::abs(stop.error_rad_s[axis][kKalman]) <= limit_rad_s) ++errors_.covered;
    }
    for (double& one : squares) one /= static_cast<double>(axes_.size());
    errors_.stops.push_back(squares);
  }

  LogErrors& errors_;
  std::vector<std::size_t> axes_;
  std::unique_ptr<RivalBias> rival_;
  const std::optional<truth::Truth>& truth_;
  std::vector<double> ahead_rad_s_;  ///< bias of the rival less that of the last stop
};

/// Drives of a log by its reference; nullopt where it has none of use.
std::optional<truth::Truth> truth_of(const recording::Input& input,
                                     const truth::TruthOptions& options) {
  recording::Reader reader{input};
  std::optional<truth::Truth> truth = truth::read_truth(reader, options);
  if (truth && !truth->obstacle.empty()) truth.reset();
  return truth;
}

/// Parts of a log that are compared.
enum class Compared : std::uint8_t { stops, stops_and_drives };

LogErrors errors_of(const std::string& log, const ComparisonOptions& options,
                    const model::SensorModel& model, Compared compared) {
  recording::Input input = options.format;
  input.path = log;
  try {
    std::optional<truth::Truth> truth;
    if (compared == Compared::stops_and_drives && !options.replay.schedule) {
      truth = truth_of(input, options.truth);
    }
    recording::Reader reader{input};
    LogErrors errors{.has_temperature = reader.columns().temperature,
                     .has_acceleration = reader.columns().acceleration};
    const auto axes = identify::axes_called(options.axis, reader.columns().axis_count);
    evaluate::ReplayOptions replay = options.replay;
    replay.model = model;
    Watch watch{errors, axes,
                compared == Compared::stops_and_drives
                    ? make_rival(options.rival, input, axes, replay)
                    : nullptr,
                truth};
    const evaluate::ReplayResult result = evaluate::replay(reader, replay, watch.observer());
    if (result.true_drives) watch.finish(*result.true_drives);
    return errors;
  } catch (const recording::DataError& error) {
    throw recording::DataError(log + ": " + error.what());
  }
}

using Chosen = std::vector<Squares> LogErrors::*;

/// A contestant over the logs of one replay.
struct Seat {
  const std::vector<LogErrors>& logs;
  std::size_t index;
};

/// Pairs of what both predicted. Two replays of a log have the same stops, or are no pair.
SquarePairs pairs_of(Chosen chosen, const Seat& own, const Seat& other) {
  SquarePairs pairs;
  for (std::size_t i = 0; i < own.logs.size(); ++i) {
    const std::vector<Squares>& mine = own.logs[i].*chosen;
    const std::vector<Squares>& theirs = other.logs[i].*chosen;
    auto& part = pairs.emplace_back();
    if (mine.size() != theirs.size()) continue;
    for (std::size_t k = 0; k < mine.size(); ++k) {
      const std::array<double, 2> pair{mine[k][own.index], theirs[k][other.index]};
      if (std::isfinite(pair[0]) && std::isfinite(pair[1])) part.push_back(pair);
    }
  }
  return pairs;
}

double root_mean(const SquarePairs& pairs) {
  double sum = 0.0;
  double count = 0.0;
  for (const auto& log : pairs) {
    for (const auto& pair : log) {
      sum += pair[0];
      count += 1.0;
    }
  }
  return std::sqrt(sum / count);
}

ContestantScore score_of(const std::vector<LogErrors>& logs, std::string name, std::size_t seat,
                         std::size_t rival) {
  const SquarePairs stops = pairs_of(&LogErrors::stops, {logs, seat}, {logs, rival});
  const SquarePairs drives = pairs_of(&LogErrors::drives, {logs, seat}, {logs, rival});
  return {.name = std::move(name),
          .stop_error_rad_s = root_mean(stops),
          .stop_ratio = paired_ratio(stops),
          .heading_error_rad = root_mean(drives),
          .heading_ratio = paired_ratio(drives)};
}

/// A quantity that logs may hold, and its share of the bias where nothing better is known.
struct Offer {
  const char* quantity;
  std::string table;  ///< lines for a model file
  bool LogErrors::*is_recorded;
  bool (*is_used)(const model::SensorModel& model);
  void (*add_to)(model::SensorModel& model);
};

constexpr double kReference_degc = 25.0;
constexpr double kSlope_dps_per_k = 0.03;  // the coarsest that data sheets of MEMS gyros state
constexpr double kForce_dps_per_g = 0.1;

Offer temperature_offer() {
  return {.quantity = "temperature",
          .table = fmt::format("[temperature]\nreference_degc = {}\nslope_sigma_dps_per_degc = {}",
                               kReference_degc, kSlope_dps_per_k),
          .is_recorded = &LogErrors::has_temperature,
          .is_used = [](const model::SensorModel& model) { return model.temperature.has_value(); },
          .add_to =
              [](model::SensorModel& model) {
                model.temperature = model::TemperatureDrift{
                    .reference_degc = kReference_degc,
                    .slope_sigma_rad_s_per_k = kSlope_dps_per_k * units::kRadPerDeg};
              }};
}

Offer acceleration_offer() {
  return {
      .quantity = "acceleration",
      .table = fmt::format("[[input]]\nquantity = \"acceleration\"\nsigma_dps_per_unit = {}",
                           kForce_dps_per_g),
      .is_recorded = &LogErrors::has_acceleration,
      .is_used = [](const model::SensorModel& model) { return !model.inputs.empty(); },
      .add_to =
          [](model::SensorModel& model) {
            model.inputs.push_back({.sigma_rad_s_per_unit = kForce_dps_per_g * units::kRadPerDeg});
          }};
}

/// Lines for a model file that take an error of the scale factor off, beyond that of the model;
/// empty where the logs stand on different axes.
std::string table_of_scale(const ScaleInTurns& scale, const model::SensorModel& model,
                           const std::vector<LogErrors>& logs) {
  std::array<double, 3> percent{};
  const auto with_drives = [](const LogErrors& log) { return !log.turns.empty(); };
  const std::size_t axis = std::ranges::find_if(logs, with_drives)->vertical;
  for (const LogErrors& log : logs) {
    if (with_drives(log) && log.vertical != axis) return {};
  }
  constexpr double kPercent = 100.0;
  if (model.scale_factor) {
    for (std::size_t i = 0; i < percent.size(); ++i) {
      percent[i] = kPercent * model.scale_factor->error[i];
    }
  }
  percent[axis] = kPercent * ((1.0 + percent[axis] / kPercent) * (1.0 + scale.error) - 1.0);
  constexpr double kLeastPercent = 0.01;
  return fmt::format(
      "[scale_factor]\nsigma_percent = {:.2g}\nerror_percent = [{:.4g}, {:.4g}, {:.4g}]",
      std::max(kPercent * scale.sigma, kLeastPercent), percent[0], percent[1], percent[2]);
}

std::vector<LogErrors> replay_all(const std::vector<std::string>& logs,
                                  const ComparisonOptions& options, const model::SensorModel& model,
                                  Compared compared, const parallel::Progress& progress) {
  std::vector<LogErrors> errors(logs.size());
  parallel::for_each(
      logs.size(), options.threads,
      [&](std::size_t i) { errors[i] = errors_of(logs[i], options, model, compared); }, progress);
  return errors;
}

}  // namespace

Comparison compare(const std::vector<std::string>& logs, const ComparisonOptions& options,
                   const parallel::Progress& progress) {
  const model::SensorModel& model = options.replay.model;
  const auto share = [&](double from, double to) {
    return progress ? [=](double done) { progress(from + (to - from) * done); }
                    : parallel::Progress{};
  };
  const std::vector<LogErrors> errors =
      replay_all(logs, options, model, Compared::stops_and_drives, share(0.0, 0.4));
  Comparison result{.model = model.name, .rival = options.rival, .logs = logs};
  std::size_t predictions = 0;
  std::size_t covered = 0;
  for (const LogErrors& log : errors) {
    result.stops += log.stops.size();
    result.drives += log.drives.size();
    predictions += log.predictions;
    covered += log.covered;
  }
  result.coverage95 = static_cast<double>(covered) / static_cast<double>(predictions);
  const std::size_t rival = options.rival.kind == Rival::Kind::last_mean ? kLastMean : kRival;
  result.contestants = {score_of(errors, "kalman", kKalman, rival),
                        score_of(errors, "moving average",
                                 static_cast<std::size_t>(app::Predictor::moving_average), rival),
                        score_of(errors, options.rival.name(), rival, rival)};
  std::vector<std::vector<Turn>> turns;
  turns.reserve(errors.size());
  for (const LogErrors& log : errors) turns.push_back(log.turns);
  result.scale = scale_in_turns(turns);
  if (result.scale) result.scale_table = table_of_scale(*result.scale, model, errors);
  double done = 0.4;
  for (const Offer& offer : {temperature_offer(), acceleration_offer()}) {
    const bool is_recorded = std::ranges::all_of(errors, offer.is_recorded);
    if (is_recorded && !offer.is_used(model)) {
      model::SensorModel with = model;
      offer.add_to(with);
      const auto informed =
          replay_all(logs, options, with, Compared::stops, share(done, done + 0.3));
      result.unused_inputs.push_back(
          {offer.quantity, offer.table,
           paired_ratio(pairs_of(&LogErrors::stops, {informed, kKalman}, {errors, kKalman}))});
    }
    done += 0.3;
  }
  return result;
}

}  // namespace zerorate::contest
