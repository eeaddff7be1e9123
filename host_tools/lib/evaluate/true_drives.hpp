/// @file
/// Drives of a replay, scored against a reference system.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/time.hpp"
#include "core/heading/heading_filter.hpp"
#include "firmware/app/node_params.hpp"
#include "host_tools/lib/evaluate/drive_scores.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace zerorate::evaluate {

/// How the heading of a drive is made.
enum class Scored : std::uint8_t {
  published,          ///< integral of the corrected rate, sample by sample
  bias_at_departure,  ///< integral of the measured rate less the bias at departure
};

/// A true drive after the node. A drift counts like the heading: positive where the node's heading
/// is ahead.
struct ScoredTrueDrive {
  truth::Drive drive;
  truth::Flaw flaw = truth::Flaw::none;  ///< flaw of the reference or of the replay; none: scored
  /// Corrected rate by predictor, sample by sample, on the way. That of the predictor which is
  /// published is the rate of the messages.
  std::array<DriveOutcome, app::kPredictors> outcomes{};
  /// Measured rate less the bias at departure, by predictor, from middle to middle of the
  /// stops.
  std::array<DriveOutcome, app::kPredictors> at_departure{};

  /// Heading error of the published rate on the way, a point a second.
  struct Point {
    double time_s = 0.0;  ///< time in the recording
    double error_rad = 0.0;
  };
  std::vector<Point> along;

  [[nodiscard]] const DriveOutcome& outcome(app::Predictor predictor, Scored scored) const {
    const auto& all = scored == Scored::published ? outcomes : at_departure;
    return all[static_cast<std::size_t>(predictor)];
  }
};

/// One predictor over the scored drives. Without drives every figure is NaN.
struct TrueScore {
  std::size_t drives = 0;
  double rms_rad = 0.0;
  double median_rad = 0.0;          ///< median of the error's size
  double worst_rad = 0.0;           ///< largest size
  double coverage95 = 0.0;          ///< share inside 1.96 sigma of node and reference together
  double coverage95_of_node = 0.0;  ///< coverage with a perfect reference
  double sigma_over_rms = 0.0;      ///< mean sigma of node and reference over rms_rad
};

/// The scored drives of a replay.
struct TrueDrives {
  truth::Truth truth;
  app::Predictor published = app::Predictor::kalman;  ///< predictor of ScoredTrueDrive::along
  std::vector<ScoredTrueDrive> drives;

  [[nodiscard]] std::size_t scored() const;
  [[nodiscard]] TrueScore score(app::Predictor predictor, Scored scored = Scored::published) const;
};

/// Turn of an axis by a rate, over the part of the time between two moments.
class WayIntegral {
 public:
  WayIntegral() = default;
  WayIntegral(std::int64_t from_ns, std::int64_t to_ns) : from_ns_(from_ns), to_ns_(to_ns) {}

  /// A rate that stands for the time from one sample to the next.
  void add(std::int64_t begin_ns, std::int64_t end_ns, double rate_rad_s, bool moves);

  [[nodiscard]] double length_s() const;
  [[nodiscard]] double turned_rad() const { return turned_rad_; }
  [[nodiscard]] double path_rad() const { return path_rad_; }  ///< sum of the sizes of its parts
  [[nodiscard]] double moved_s() const { return moved_s_; }
  [[nodiscard]] double squared_intervals_s2() const { return squared_intervals_s2_; }

 private:
  std::int64_t from_ns_ = 0;
  std::int64_t to_ns_ = 0;
  double turned_rad_ = 0.0;
  double path_rad_ = 0.0;
  double moved_s_ = 0.0;
  double squared_intervals_s2_ = 0.0;
};

/// Compares what a node publishes with the reference's turn, drive by drive.
///
/// The heading is the integral of the corrected rate, sample by sample, from two seconds before the
/// departure to two seconds after the arrival. A second figure is that of the bias at departure,
/// from middle to middle of the stops. The interval is the node's prediction at departure over a
/// time as long, with the tolerance of the scale factor. Where the node learns from references,
/// scale factor and offset in motion are known at departure, and what is known of them stands in
/// place of the tolerance.
class TrueDriveScorer {
 public:
  /// @param shift of the node's clock over the recording's
  /// @param longest_interval between samples that is integrated over
  TrueDriveScorer(truth::Truth truth, core::Duration shift, core::Duration longest_interval,
                  app::Predictor published);

  /// A sample with a rate, after the node has stepped over it.
  /// @param measured_rad_s about the vertical axis, with its bias
  /// @param published_rad_s without it, as in the message
  /// @param is_measured whether the node has measured a bias
  template <class Node>
  void take(std::int64_t time_ns, double measured_rad_s, double published_rad_s, bool is_measured,
            const Node& node) {
    while (next_ < result_.drives.size()) {
      ScoredTrueDrive& scored = result_.drives[next_];
      if (time_ns < scored.drive.from_ns) break;
      if (!is_open_) open();
      follow_biases(node);
      integrate(scored, time_ns, measured_rad_s, published_rad_s,
                node.motion() != core::Motion::still);
      if (!has_departed_ && time_ns >= scored.drive.departure_ns) {
        has_departed_ = true;
        if (is_measured) depart(node);
        if (!is_measured && scored.flaw == truth::Flaw::none) scored.flaw = truth::Flaw::no_bias;
      }
      if (time_ns < scored.drive.to_ns) break;
      close(scored);
    }
    newest_ns_ = time_ns;
    has_sample_ = true;
  }

  /// After the last sample: a drive that is not over is flawed.
  [[nodiscard]] TrueDrives finish();

 private:
  using ByPredictor = std::array<double, app::kPredictors>;

  /// The biases hardly change within a filter tick.
  template <class Node>
  void follow_biases(const Node& node) {
    if (has_biases_ && node.tick() == biases_tick_) return;
    has_biases_ = true;
    biases_tick_ = node.tick();
    biases_ = biases_of(node);
  }
  template <class Node>
  ByPredictor biases_of(const Node& node) const {
    ByPredictor biases{};
    for (std::size_t p = 0; p < app::kPredictors; ++p) {
      const auto predictor = static_cast<app::Predictor>(p);
      biases[p] = double{node.bias(predictor, result_.truth.vertical.axis).in(core::rad_per_s)};
    }
    return biases;
  }
  /// Variances of the heading that a node predicts now for a time as long [rad^2].
  template <class Node>
  ByPredictor variances_of(const Node& node, std::int64_t length_ns) const {
    const core::Instant from =
        core::Instant::from_ns(result_.drives[next_].drive.departure_ns) + shift_;
    const core::Instant to = from + core::Duration::nanoseconds(length_ns);
    ByPredictor variances{};
    for (std::size_t p = 0; p < app::kPredictors; ++p) {
      const auto predictor = static_cast<app::Predictor>(p);
      const auto heading = node.predict_heading(predictor, result_.truth.vertical.axis, from, to);
      variances[p] = double{heading.variance_rad2};
    }
    return variances;
  }
  template <class Node>
  void depart(const Node& node) {
    const truth::Drive& drive = result_.drives[next_].drive;
    white_variance_rad2_s2_ = double{node.white_variance_rad2_s2(result_.truth.vertical.axis)};
    motion_.emplace(node.heading_filter());
    asymmetry_ = double{node.params().model.motion.asymmetry};
    at_departure_ = biases_of(node);
    variances_ = variances_of(node, drive.to_ns - drive.from_ns);
    way_variances_ = variances_of(node, drive.way_to_ns() - drive.way_from_ns());
  }
  void open();
  void integrate(ScoredTrueDrive& scored, std::int64_t time_ns, double measured_rad_s,
                 double published_rad_s, bool moves);
  void add_points(ScoredTrueDrive& scored, std::int64_t time_ns) const;
  /// Variance of a turn by the white noise and by what is not known of the motion, beside that of
  /// the bias.
  [[nodiscard]] double variance(const WayIntegral& way, double turn_rad) const;
  /// Drift of a turn without its bias by what was known of the motion at departure.
  [[nodiscard]] DriveOutcome outcome(const WayIntegral& way, double turned_rad,
                                     double variance_rad2, double true_turn_rad) const;
  void close(ScoredTrueDrive& scored);

  TrueDrives result_;
  core::Duration shift_;
  std::int64_t longest_ns_;

  std::size_t next_ = 0;
  bool has_sample_ = false;
  bool is_open_ = false;
  bool has_departed_ = false;
  std::int64_t newest_ns_ = 0;
  WayIntegral measured_;                            ///< from middle to middle
  std::array<WayIntegral, app::kPredictors> ways_;  ///< corrected rates on the way
  std::optional<core::HeadingFilter> motion_;       ///< filter of the references at departure
  double asymmetry_ = 0.0;                          ///< tolerance of the model
  double white_variance_rad2_s2_ = 0.0;             ///< variance of a sample, known at departure
  bool has_biases_ = false;
  std::uint32_t biases_tick_ = 0;
  ByPredictor biases_{};         ///< newest ones
  ByPredictor at_departure_{};   ///< biases at departure
  ByPredictor variances_{};      ///< variances of the bias, from middle to middle
  ByPredictor way_variances_{};  ///< variances of the bias, on the way
};

}  // namespace zerorate::evaluate
