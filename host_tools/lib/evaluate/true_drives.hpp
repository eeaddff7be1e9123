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

/// A true drive after the node.
struct ScoredTrueDrive {
  truth::Drive drive;
  truth::Flaw flaw = truth::Flaw::none;  ///< flaw of the reference or of the replay; none: scored
  /// Drift by predictor. It counts like the heading: positive where the node's heading is ahead.
  std::array<DriveOutcome, app::kPredictors> outcomes{};

  /// Heading error of the published bias along the drive, a point a second.
  struct Point {
    double time_s = 0.0;  ///< time in the recording
    double error_rad = 0.0;
  };
  std::vector<Point> along;
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
  [[nodiscard]] TrueScore score(app::Predictor predictor) const;
};

/// Integrates the measured rate over each true drive, less the bias that the node published at its
/// departure, and compares with the reference's turn. The interval is the node's prediction at
/// departure over a time as long as from middle to middle, with the tolerance of the scale factor.
/// Where the node learns from references, scale factor and offset in motion are taken off as they
/// were known at departure, and what is known of them stands in place of the tolerance.
class TrueDriveScorer {
 public:
  /// @param shift of the node's clock over the recording's
  /// @param longest_interval between samples that is integrated over
  TrueDriveScorer(truth::Truth truth, core::Duration shift, core::Duration longest_interval,
                  app::Predictor published);

  /// A sample with a rate, after the node has stepped over it.
  /// @param is_measured whether the node has measured a bias
  template <class Node>
  void take(std::int64_t time_ns, double rate_rad_s, bool is_measured, const Node& node) {
    while (next_ < result_.drives.size()) {
      ScoredTrueDrive& scored = result_.drives[next_];
      if (time_ns < scored.drive.from_ns) break;
      if (!is_open_) open();
      integrate(scored, time_ns, rate_rad_s, node.motion() != core::Motion::still);
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
  template <class Node>
  void depart(const Node& node) {
    const truth::Drive& drive = result_.drives[next_].drive;
    const std::size_t axis = result_.truth.vertical.axis;
    const core::Instant from = core::Instant::from_ns(drive.departure_ns) + shift_;
    const core::Instant to = from + core::Duration::nanoseconds(drive.to_ns - drive.from_ns);
    white_variance_rad2_s2_ = double{node.white_variance_rad2_s2(axis)};
    motion_.emplace(node.heading_filter());
    asymmetry_ = double{node.params().model.motion.asymmetry};
    for (std::size_t p = 0; p < app::kPredictors; ++p) {
      const auto predictor = static_cast<app::Predictor>(p);
      biases_[p] = double{node.bias(predictor, axis).in(core::rad_per_s)};
      variances_[p] = double{node.predict_heading(predictor, axis, from, to).variance_rad2};
    }
  }
  void open();
  void integrate(ScoredTrueDrive& scored, std::int64_t time_ns, double rate_rad_s, bool moves);
  /// Drift of a corrected turn by what was known of the motion, with its variance added.
  [[nodiscard]] DriveOutcome outcome(double corrected_rad, double variance_rad2,
                                     double true_turn_rad) const;
  void close(ScoredTrueDrive& scored);

  TrueDrives result_;
  core::Duration shift_;
  std::int64_t longest_ns_;

  std::size_t next_ = 0;
  bool has_sample_ = false;
  bool is_open_ = false;
  bool has_departed_ = false;
  std::int64_t newest_ns_ = 0;
  double turned_rad_ = 0.0;
  double path_rad_ = 0.0;  ///< sum of the sizes of its parts
  double moved_s_ = 0.0;
  std::optional<core::HeadingFilter> motion_;  ///< filter of the references at departure
  double asymmetry_ = 0.0;                     ///< tolerance of the model
  double squared_intervals_s2_ = 0.0;
  double white_variance_rad2_s2_ = 0.0;  ///< variance of a sample, known at departure
  std::array<double, app::kPredictors> biases_{};
  std::array<double, app::kPredictors> variances_{};
};

}  // namespace zerorate::evaluate
