#include "host_tools/lib/evaluate/replay.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "host_tools/lib/evaluate/feed.hpp"
#include "host_tools/lib/evaluate/replay_node.hpp"
#include "host_tools/lib/evaluate/stop_judge.hpp"
#include "host_tools/lib/identify/near_zero_mean.hpp"
#include "host_tools/lib/identify/rest_check.hpp"
#include "host_tools/lib/recording/error.hpp"

namespace zerorate::evaluate {
namespace {

/// The first rows are read ahead, because the sensor's rate has to be known before the first step.
class BufferedRows {
 public:
  explicit BufferedRows(recording::Reader& reader) : reader_(reader) {
    recording::Row row;
    while (ahead_.size() < kRowsAhead && reader_.next(row)) ahead_.push_back(row);
    period_ns_ = reader_.findings().mean_interval_ns();
  }

  bool next(recording::Row& row) {
    if (ahead_.empty()) return reader_.next(row);
    row = ahead_.front();
    ahead_.pop_front();
    return true;
  }

  [[nodiscard]] std::int64_t first_time_ns() const { return ahead_.front().time_ns; }

  /// The mean interval of the rows read ahead, holes left out.
  [[nodiscard]] core::Duration sample_period() const {
    if (period_ns_ == 0) {
      throw recording::DataError(
          "the recording has fewer than two rows in time order: its sample rate cannot be told");
    }
    const std::string doubt = recording::doubt_of_period(period_ns_);
    if (!doubt.empty() && !reader_.columns().is_timed_by_rows) throw recording::DataError(doubt);
    return core::Duration::nanoseconds(period_ns_);
  }

 private:
  recording::Reader& reader_;
  std::deque<recording::Row> ahead_;
  std::int64_t period_ns_ = 0;
};

core::Duration sample_period(const ReplayOptions& options, const BufferedRows& rows) {
  const core::Duration measured = rows.sample_period();
  if (!options.sample_rate_hz) return measured;
  const auto nominal = core::Duration::nanoseconds(std::llround(1e9 / *options.sample_rate_hz));
  if (nominal < measured * 2 && measured < nominal * 2) return nominal;
  throw std::invalid_argument("--sample-rate is not that of the recording, whose samples come at " +
                              std::to_string(1e9 / static_cast<double>(measured.ns())) + " Hz");
}

/// The replay of one recording through one node type.
template <core::ModelShape Shape>
class Run {
 public:
  using Node = typename ReplayNode<Shape>::Node;

  Run(BufferedRows& rows, const recording::Reader& reader, const ReplayOptions& options,
      const ReplayObserver& observer, ReplayResult& result)
      : rows_(rows),
        reader_(reader),
        observer_(observer),
        through_(options.through),
        references_(options.references),
        accepted_(options.accepted),
        result_(result),
        replayed_(options, reader.columns(), {result.sample_period, result.filter_tick},
                  rows.first_time_ns()) {
    if (options.schedule && options.checks_rest) {
      rest_.emplace(result.axis_count, result.sample_period, result.sample_period);
      levels_.emplace(result.axis_count);
    }
    if (!observer.truth) return;
    true_drives_.emplace(*observer.truth, replayed_.shift(), longest_interval(result.sample_period),
                         options.published);
  }

  template <class Feed>
  void to_the_end(Feed feed) {
    recording::Row row;
    while (rows_.next(row)) {
      const auto arrival = replayed_.arrive(row);
      if (drive_open_ && !arrival.moving) close_drive(replayed_.latest());
      const app::RateMessage message = feed.feed(arrival.sample, arrival.pulses);
      take(row, arrival.moving, message);
      ++result_.rows;
      if (observer_.on_progress && result_.rows % kProgressRows == 0) {
        observer_.on_progress(reader_.fraction_read());
      }
    }
    if (drive_open_) {
      close_drive(newest_);
    } else {
      stops_.end_stop(node_, kStart, result_);
    }
    if (rest_) {
      std::vector<std::size_t> axes = identify::axes_called("all", result_.axis_count);
      std::vector<identify::RestDoubt> doubts = rest_->doubts();
      std::ranges::move(levels_->doubts(), std::back_inserter(doubts));
      result_.rest_doubts = identify::require_rest(doubts, accepted_, axes);
    }
    node_.finish_learning();
    if (has_news()) tell_learnt(row.time_ns);
    result_.loop = feed.counters();
    result_.findings = reader_.findings();
    if (true_drives_) result_.true_drives = true_drives_->finish();
  }
  Node& node() { return replayed_.node(); }
  static constexpr core::Instant start() { return kStart; }

 private:
  static constexpr core::Instant kStart = ReplayNode<Shape>::kStart;
  static constexpr std::uint64_t kProgressRows = 4096;
  static constexpr std::size_t kAxes = Node::kAxes;

  /// Longest gap over which a rate is integrated for the heading of a true drive.
  static core::Duration longest_interval(core::Duration sample_period) {
    return std::max(core::Duration::nanoseconds(recording::kShortestHole), sample_period * 2);
  }

  void take(const recording::Row& row, bool moving, const app::RateMessage& message) {
    const std::array<float, 3> truth =
        observer_.true_rate ? observer_.true_rate(result_.rows) : std::array<float, 3>{};
    if (message.motion != core::Motion::still && has_news()) tell_learnt(row.time_ns);
    stops_.take(node_, kStart, result_, message);
    if (message.health.saturated) ++result_.samples_saturated;
    if (message.health.model_inconsistent && result_.samples_inconsistent++ == 0) {
      result_.first_inconsistent_s = time_s(message);
    }
    if (message.health.measurement_rejected) ++result_.samples_doubted;
    if (message.health.temperature_missing) ++result_.samples_without_temperature;
    if (message.health.acceleration_missing) ++result_.samples_without_acceleration;
    if (message.health.odometer_disagreement) ++result_.samples_disagreeing;
    if (is_frozen(message)) {
      if (result_.samples_frozen++ == 0) result_.first_frozen_s = time_s(message);
    } else if (!message.has_rate()) {
      ++result_.samples_refused;
    } else {
      // From the first measurement on, whether or not others have borne it out yet.
      const bool has_bias = core::is_finite(message.axes[0].sigma.in(core::rad_per_s));
      if (moving && has_bias) add_to_drive(message, truth);
      newest_ = message.time;
      if (rest_) {
        rest_->add(message.time, row.rate_rad_s);
        levels_->add(row.rate_rad_s);
      }
      if (true_drives_) {
        const std::size_t vertical = observer_.truth->vertical.axis;
        const double published = double{message.axes[vertical].corrected.in(core::rad_per_s)};
        true_drives_->take(row.time_ns, measured_rad_s(message, vertical), published, has_bias,
                           node_);
      }
    }
    if (message.has_rate() && message.health.calibrated) ++result_.rows_corrected;
    if (references_) learn_from_reference(row, message);
    if (observer_.on_sample) {
      observer_.on_sample({result_.rows, row.time_ns, moving, message, known_rates(row, truth),
                           last_stop_means(), node_.measured_ticks()});
    }
  }

  /// Hands the reference's heading of a row over.
  void learn_from_reference(const recording::Row& row, const app::RateMessage& message) {
    if (!std::isfinite(row.ref_heading_rad) || !message.has_rate()) return;
    if (references_->only_at_stops && message.motion != core::Motion::still) return;
    const auto verdict = node_.take_reference(
        app::HeadingReference{.time = message.time,
                              .heading = core::rad(row.ref_heading_rad),
                              .sigma = core::rad(static_cast<float>(references_->sigma_rad))});
    LearntMotion& learnt = *result_.learnt_motion;
    switch (verdict) {
      case core::ReferenceVerdict::learnt:
        ++learnt.learnt;
        break;
      case core::ReferenceVerdict::refused:
        ++learnt.refused;
        break;
      case core::ReferenceVerdict::no_bias:
      case core::ReferenceVerdict::bad_time:
        ++learnt.unusable;
        break;
      default:
        break;
    }
    const core::HeadingFilter& filter = node_.heading_filter();
    learnt.scale_factor = double{filter.scale_factor()};
    learnt.scale_factor_sigma = std::sqrt(double{filter.scale_factor_variance()});
    learnt.offset_rad_s = double{filter.offset_rad_s()};
    learnt.offset_sigma_rad_s = std::sqrt(double{filter.offset_variance_rad2_s2()});
    learnt.quality = double{filter.quality()};
  }

  /// Through a chip its driver finds such samples, and restarts the chip.
  [[nodiscard]] bool is_frozen(const app::RateMessage& message) const {
    return through_ == Through::source && message.health.sensor_fault;
  }
  /// Time of a message since the first row.
  static double time_s(const app::RateMessage& message) {
    return static_cast<double>((message.time - kStart).ns()) * 1e-9;
  }

  /// True rates, not a number about an axis of which it is not known.
  [[nodiscard]] std::array<float, kAxes> known_rates(
      const recording::Row& row, const std::array<float, kAxes>& scheduled) const {
    if (result_.truth_known) return scheduled;
    std::array<float, kAxes> rates;
    rates.fill(std::numeric_limits<float>::quiet_NaN());
    if (observer_.truth) {
      const truth::VerticalAxis& vertical = observer_.truth->vertical;
      rates[vertical.axis] = static_cast<float>(vertical.sign) * row.ref_rate_rad_s;
    }
    return rates;
  }
  [[nodiscard]] std::array<float, kAxes> last_stop_means() const {
    std::array<float, kAxes> means;
    for (std::size_t i = 0; i < kAxes; ++i) {
      means[i] = node_.bias(app::Predictor::calibration_mean, i).in(core::rad_per_s);
    }
    return means;
  }

  /// Whether the node has learnt something that was not reported yet.
  [[nodiscard]] bool has_news() const {
    return replayed_.params().model.hypotheses.count > 0 && !node_.is_learning() &&
           node_.measured_ticks() != told_ticks_;
  }
  void tell_learnt(std::int64_t time_ns) {
    told_ticks_ = node_.measured_ticks();
    LearntNoises& learnt = result_.learnt.emplace();
    for (std::size_t i = 0; i < result_.axis_count; ++i)
      learnt[i] = node_.predictors().learnt_noise(i);
    if (observer_.on_learnt) observer_.on_learnt({time_ns, learnt, result_.mesh});
  }

  void add_to_drive(const app::RateMessage& message, const std::array<float, 3>& truth) {
    if (!drive_open_) {
      drive_open_ = true;
      drive_start_ = message.time;
      drives_ = {};
      measured_ = {};
    }
    if (const std::uint32_t tick = node_.tick(); tick != biases_tick_ || biases_stale_) {
      predict_biases();
      biases_tick_ = tick;
      biases_stale_ = false;
    }
    const double elapsed_s = static_cast<double>((message.time - newest_).ns()) * 1e-9;
    for (std::size_t i = 0; i < result_.axis_count; ++i) {
      const double rate = measured_rad_s(message, i) - double{truth[i]};
      measured_[i].add(rate, elapsed_s);
      for (std::size_t p = 0; p < app::kPredictors; ++p) {
        drives_[i][p].add(rate - biases_[i][p], elapsed_s);
      }
    }
  }
  /// Rate over the Earth as the node takes it in, with the bias still in it.
  [[nodiscard]] double measured_rad_s(const app::RateMessage& message, std::size_t axis) const {
    const auto& params = replayed_.params();
    return double{params.model.corrected(message.axes[axis].measured, axis).in(core::rad_per_s)} -
           double{node_.ticks().earth().vertical_rad_s[axis]};
  }
  void predict_biases() {
    for (std::size_t i = 0; i < result_.axis_count; ++i) {
      for (std::size_t p = 0; p < app::kPredictors; ++p) {
        biases_[i][p] = double{node_.bias(kAllPredictors[p], i).in(core::rad_per_s)};
      }
    }
  }

  /// Called before the node's first sample of the stop: its newest measurement is still the one
  /// before the drive.
  void close_drive(core::Instant end) {
    stops_.end_stop(node_, kStart, result_);
    stops_.begin_stop(node_);
    drive_open_ = false;
    biases_stale_ = true;
    for (std::size_t i = 0; i < result_.axis_count; ++i) {
      for (std::size_t p = 0; p < app::kPredictors; ++p) {
        const app::Predictor predictor = kAllPredictors[p];
        const DriveOutcome drive =
            outcome(drives_[i][p], node_.predict_heading(predictor, i, drive_start_, end),
                    double{node_.white_variance_rad2_s2(i)});
        result_.scores[i][p].add(drive);
        if (observer_.on_drive) {
          observer_.on_drive({i, predictor, (drive_start_ - replayed_.shift()).ns(), drive,
                              measured_[i].elapsed_s(), measured_[i].integrated_rad()});
        }
      }
    }
  }

  BufferedRows& rows_;
  const recording::Reader& reader_;
  const ReplayObserver& observer_;
  Through through_;
  const std::optional<ReferenceUse>& references_;
  const identify::AcceptedDoubts& accepted_;
  ReplayResult& result_;
  ReplayNode<Shape> replayed_;
  Node& node_ = replayed_.node();
  core::Instant newest_ = kStart;  ///< sample with a rate
  bool drive_open_ = false;
  core::Instant drive_start_;
  std::array<std::array<Drive, app::kPredictors>, kAxes> drives_;
  std::array<Drive, kAxes> measured_;  ///< with the bias still in it
  std::array<std::array<double, app::kPredictors>, kAxes> biases_{};
  std::uint32_t biases_tick_ = 0;
  bool biases_stale_ = true;
  std::uint32_t told_ticks_ = 0;  ///< measured ticks at the last report of what was learnt
  StopJudge<Node> stops_{observer_.on_stop};
  std::optional<identify::RestCheck> rest_;
  std::optional<identify::LevelCheck> levels_;  ///< together with rest_
  std::optional<TrueDriveScorer> true_drives_;
};

template <core::ModelShape Shape>
void run(BufferedRows& rows, const recording::Reader& reader, const ReplayOptions& options,
         const ReplayObserver& observer, ReplayResult& result) {
  // The node is some kilobytes: kept off the stack, as firmware keeps it static.
  const auto run = std::make_unique<Run<Shape>>(rows, reader, options, observer, result);
  using Node = typename Run<Shape>::Node;
  if (options.through == Through::chip) {
    run->to_the_end(ChipFeed<Node>{run->node(), find_simulated_chip(options.chip), run->start(),
                                   options.has_data_ready, reader.columns().acceleration});
  } else {
    run->to_the_end(DirectFeed<Node>{run->node(), result.axis_count});
  }
}

}  // namespace

core::Duration filter_tick(const ReplayOptions& options, core::Duration sample_period) {
  constexpr double kDefaultHz = 2.0;
  const double rate_hz = options.filter_rate_hz.value_or(kDefaultHz);
  if (!(rate_hz > 0.0) || !std::isfinite(rate_hz)) {
    throw std::invalid_argument("the filter rate must be positive, in Hz");
  }
  const auto tick = core::Duration::nanoseconds(std::llround(1e9 / rate_hz));
  if (tick >= sample_period) return tick;
  if (options.filter_rate_hz) {
    throw std::invalid_argument("the filter rate is above the recording's sample rate of " +
                                std::to_string(1e9 / static_cast<double>(sample_period.ns())) +
                                " Hz: lower --filter-rate");
  }
  return sample_period;
}

std::string_view name(app::Predictor predictor) {
  switch (predictor) {
    case app::Predictor::kalman:
      return "kalman";
    case app::Predictor::moving_average:
      return "moving_average";
    case app::Predictor::calibration_mean:
      return "calibration_mean";
  }
  return "unknown";
}

ReplayResult replay(recording::Reader& reader, const ReplayOptions& options,
                    const ReplayObserver& observer) {
  BufferedRows rows{reader};
  ReplayResult result;
  result.axis_count = reader.columns().axis_count;
  result.model = options.model.name;
  result.is_model_chosen = options.is_model_chosen;
  result.mesh = mesh_of(options.model);
  result.states_scale_factor = options.model.scale_factor.has_value();
  if (options.through == Through::chip &&
      result.axis_count > find_simulated_chip(options.chip).axis_count) {
    throw std::invalid_argument(options.chip + " has one axis, the recording has " +
                                std::to_string(result.axis_count));
  }
  if (options.references) result.learnt_motion.emplace();
  result.truth_known = options.schedule.has_value() || static_cast<bool>(observer.true_rate);
  result.sample_period = sample_period(options, rows);
  result.filter_tick = filter_tick(options, result.sample_period);
  model::with_shape_of<model::kLargestLearningShape>(
      options.model, reader.columns().acceleration,
      [&]<core::ModelShape Shape>() { run<Shape>(rows, reader, options, observer, result); });
  return result;
}

}  // namespace zerorate::evaluate
