#include "host_tools/lib/contest/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

#include "host_tools/lib/contest/exponential_means.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/number.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::contest {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
/// kalman, moving average, calibration mean, exponential mean.
constexpr std::size_t kSeats = app::kPredictors + 1;
constexpr std::size_t kExponential = app::kPredictors;
constexpr auto kLastMean = static_cast<std::size_t>(app::Predictor::calibration_mean);
constexpr auto kKalman = static_cast<std::size_t>(app::Predictor::kalman);

/// Squared errors of one stop or drive, a contestant each; NaN where it had no prediction.
using Squares = std::array<double, kSeats>;

/// Exponential mean of the samples that the node's messages call still, held on the way.
class ExponentialMean {
 public:
  explicit ExponentialMean(double memory_s) : memory_s_(memory_s) {}

  void take(const app::RateMessage& message) {
    const double elapsed_s = has_time_ ? double{(message.time - newest_).in_seconds()} : 0.0;
    newest_ = message.time;
    has_time_ = true;
    const bool stands = message.motion == core::Motion::still;
    if (stands && !stood_) held_rad_s_ = mean_rad_s_;
    stood_ = stands;
    if (!stands || !message.has_rate()) return;
    const double weight = exponential_weight(elapsed_s, memory_s_, ++samples_);
    for (std::size_t i = 0; i < mean_rad_s_.size(); ++i) {
      const double rate = double{message.axes[i].measured.in(core::rad_per_s)};
      mean_rad_s_[i] += weight * (rate - mean_rad_s_[i]);
    }
  }
  [[nodiscard]] double mean_rad_s(std::size_t axis) const { return mean_rad_s_[axis]; }
  /// Prediction for the newest stop: the mean before it.
  [[nodiscard]] double held_rad_s(std::size_t axis) const { return held_rad_s_[axis]; }

 private:
  double memory_s_;
  std::array<double, 3> mean_rad_s_{};
  std::array<double, 3> held_rad_s_{kNaN, kNaN, kNaN};
  core::Instant newest_;
  bool has_time_ = false;
  bool stood_ = false;
  double samples_ = 0.0;
};

/// One log after its replay.
struct LogErrors {
  std::vector<Squares> stops;
  std::vector<Squares> drives;
  std::size_t predictions = 0;  ///< predictions of single axes
  std::size_t covered = 0;
  bool has_temperature = false;
  bool has_acceleration = false;
};

/// Follows one replay.
class Watch {
 public:
  /// @param truth  has to outlive it
  Watch(LogErrors& errors, std::vector<std::size_t> axes, const Rival& rival,
        const std::optional<truth::Truth>& truth)
      : errors_(errors),
        axes_(std::move(axes)),
        mean_(rival.memory_s.value_or(1.0)),
        truth_(truth) {}

  [[nodiscard]] evaluate::ReplayObserver observer() {
    return {.truth = truth_,
            .on_sample = [this](const evaluate::ReplayedSample& sample) { take(sample); },
            .on_stop = [this](const evaluate::ReplayedStop& stop) { take(stop); }};
  }

  /// Errors of the drives, as the heading at the bias of the departure has them.
  void finish(const evaluate::TrueDrives& drives) {
    for (std::size_t k = 0; k < std::min(drives.drives.size(), ahead_rad_s_.size()); ++k) {
      const evaluate::ScoredTrueDrive& scored = drives.drives[k];
      if (scored.flaw != truth::Flaw::none) continue;
      Squares squares{};
      for (std::size_t p = 0; p < app::kPredictors; ++p) {
        squares[p] = squared(scored.at_departure[p].drift_rad);
      }
      const double length_s = units::seconds(scored.drive.to_ns - scored.drive.from_ns);
      squares[kExponential] = squared(scored.at_departure[kLastMean].drift_rad -
                                      truth_->vertical.sign * ahead_rad_s_[k] * length_s);
      errors_.drives.push_back(squares);
    }
  }

 private:
  static double squared(double error) { return error * error; }

  void take(const evaluate::ReplayedSample& sample) {
    while (truth_ && ahead_rad_s_.size() < truth_->drives.size() &&
           sample.time_ns >= truth_->drives[ahead_rad_s_.size()].departure_ns) {
      const std::size_t axis = truth_->vertical.axis;
      ahead_rad_s_.push_back(mean_.mean_rad_s(axis) - double{sample.last_stop_mean_rad_s[axis]});
    }
    mean_.take(sample.message);
  }

  void take(const evaluate::ReplayedStop& stop) {
    Squares squares{};
    for (const std::size_t axis : axes_) {
      for (std::size_t p = 0; p < app::kPredictors; ++p) {
        squares[p] += squared(stop.error_rad_s[axis][p]);
      }
      squares[kExponential] += squared(stop.measured_rad_s[axis] - mean_.held_rad_s(axis));
      ++errors_.predictions;
      const double limit_rad_s = statistics::kHalfWidth95 * stop.sigma_rad_s[axis][kKalman];
      if (std::abs(stop.error_rad_s[axis][kKalman]) <= limit_rad_s) ++errors_.covered;
    }
    for (double& one : squares) one /= static_cast<double>(axes_.size());
    errors_.stops.push_back(squares);
  }

  LogErrors& errors_;
  std::vector<std::size_t> axes_;
  ExponentialMean mean_;
  const std::optional<truth::Truth>& truth_;
  std::vector<double> ahead_rad_s_;  ///< exponential mean less that of the last stop, at departure
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
    Watch watch{errors, identify::axes_called(options.axis, reader.columns().axis_count),
                options.rival, truth};
    evaluate::ReplayOptions replay = options.replay;
    replay.model = model;
    const evaluate::ReplayResult result = evaluate::replay(reader, replay, watch.observer());
    if (result.true_drives) watch.finish(*result.true_drives);
    return errors;
  } catch (const recording::DataError& error) {
    throw recording::DataError(log + ": " + error.what());
  }
}

/// Errors of two contestants that stand in pairs, each log a part.
using Pairs = std::vector<std::vector<std::array<double, 2>>>;

double root_of_ratio(const std::vector<const std::array<double, 2>*>& pairs) {
  double own = 0.0;
  double other = 0.0;
  for (const auto* pair : pairs) {
    own += (*pair)[0];
    other += (*pair)[1];
  }
  return std::sqrt(own / other);
}

statistics::BootstrapFigure ratio_of(const Pairs& logs) {
  std::vector<std::vector<const std::array<double, 2>*>> parts;
  for (const auto& log : logs) {
    auto& part = parts.emplace_back();
    for (const auto& pair : log) part.push_back(&pair);
  }
  if (parts.size() < evaluate::kFewestDrivesOfARatio) {
    std::vector<std::vector<const std::array<double, 2>*>> singles;
    for (const auto& part : parts) {
      for (const auto* pair : part) singles.push_back({pair});
    }
    parts = std::move(singles);
  }
  if (parts.size() < evaluate::kFewestDrivesOfARatio) return {};
  const auto ratio = [&](const std::vector<std::size_t>& drawn) {
    std::vector<const std::array<double, 2>*> pairs;
    for (const std::size_t one : drawn) {
      pairs.insert(pairs.end(), parts[one].begin(), parts[one].end());
    }
    return root_of_ratio(pairs);
  };
  return statistics::bootstrap(parts.size(), ratio,
                               random::RandomStream{1}.substream("comparison of logs"));
}

using Chosen = std::vector<Squares> LogErrors::*;

/// A contestant over the logs of one replay.
struct Seat {
  const std::vector<LogErrors>& logs;
  std::size_t index;
};

/// Pairs of what both predicted. Two replays of a log have the same stops, or are no pair.
Pairs pairs_of(Chosen chosen, const Seat& own, const Seat& other) {
  Pairs pairs;
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

double root_mean(const Pairs& pairs) {
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
  const Pairs stops = pairs_of(&LogErrors::stops, {logs, seat}, {logs, rival});
  const Pairs drives = pairs_of(&LogErrors::drives, {logs, seat}, {logs, rival});
  return {.name = std::move(name),
          .stop_error_rad_s = root_mean(stops),
          .stop_ratio = ratio_of(stops),
          .heading_error_rad = root_mean(drives),
          .heading_ratio = ratio_of(drives)};
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

std::string Rival::name() const {
  return memory_s ? fmt::format("exponential mean of {:g} s", *memory_s) : "mean of the last stop";
}

Rival parse_rival(std::string_view text) {
  constexpr std::string_view kPrefix = "exponential:";
  if (text == "last-mean") return {};
  if (text.starts_with(kPrefix)) {
    text.remove_prefix(kPrefix.size());
    const auto memory_s = recording::parse_real(text);
    if (memory_s && *memory_s > 0.0 && std::isfinite(*memory_s)) return {.memory_s = *memory_s};
  }
  throw std::invalid_argument(
      "--against: expected last-mean or exponential:SECONDS, as in exponential:30");
}

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
  const std::size_t rival = options.rival.memory_s ? kExponential : kLastMean;
  result.contestants = {score_of(errors, "kalman", kKalman, rival),
                        score_of(errors, "moving average",
                                 static_cast<std::size_t>(app::Predictor::moving_average), rival),
                        score_of(errors, options.rival.name(), rival, rival)};
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
           ratio_of(pairs_of(&LogErrors::stops, {informed, kKalman}, {errors, kKalman}))});
    }
    done += 0.3;
  }
  return result;
}

}  // namespace zerorate::contest
