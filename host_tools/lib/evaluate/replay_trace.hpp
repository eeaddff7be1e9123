/// @file
/// Trace of a replay for drawing: a bounded number of points, and one entry a stop or drive.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_tools/lib/evaluate/learnt_model.hpp"
#include "host_tools/lib/evaluate/replay.hpp"

namespace zerorate::evaluate {

/// Means over stretches of one axis; rates in deg/s.
struct TracePoint {
  double time_s = 0.0;  ///< middle of the stretch
  double measured_dps = 0.0;
  double corrected_dps = 0.0;
  double error_dps = 0.0;  ///< measured minus true rate; not a number where that is not known
  double bias_dps = 0.0;   ///< predicted
  double last_stop_mean_dps = 0.0;
  double sigma_dps = 0.0;
  bool calibrated = false;
};

/// One closed drive of the traced axis.
struct TracedDrive {
  double start_s = 0.0;
  std::array<DriveOutcome, app::kPredictors> outcomes{};
};

/// Noise model of the traced axis at the end of a stop.
struct TracedModel {
  double time_s = 0.0;
  LearntModel model;
};

/// Follows one axis of a replay. Holds at most kMostPoints stretches: when they are full, pairs of
/// them are merged and later stretches are twice as long.
class ReplayTrace {
 public:
  static constexpr std::size_t kMostPoints = 8192;

  explicit ReplayTrace(std::size_t axis) : axis_(axis) {}

  void add(const ReplayedSample& sample);
  void add(const ReplayedDrive& drive);
  void add(const LearntStop& stop);
  /// After the replay: takes the last, shorter stretch in.
  void finish() { close_stretch(); }

  [[nodiscard]] std::size_t axis() const { return axis_; }
  [[nodiscard]] const std::vector<TracePoint>& points() const { return points_; }
  [[nodiscard]] const std::vector<TracedDrive>& drives() const { return drives_; }
  [[nodiscard]] const std::vector<TracedModel>& models() const { return models_; }
  /// Standstills, in seconds of the recording.
  struct Interval {
    double from_s;
    double to_s;
  };
  [[nodiscard]] const std::vector<Interval>& stops() const { return stops_; }
  /// Runs of filter ticks that the node learnt from.
  struct LearntTicks {
    std::uint32_t from;  ///< counted from the first tick of the replay
    std::uint32_t to;    ///< not learnt any more
  };
  [[nodiscard]] const std::vector<LearntTicks>& learnt() const { return learnt_; }
  /// Time of the first sample, from which ticks are counted; of the recording.
  [[nodiscard]] double start_s() const { return start_s_; }

 private:
  void follow_learning(std::uint32_t learnt_ticks);
  void close_stretch();
  void merge_pairs();

  std::size_t axis_;
  std::size_t stretch_ = 1;  ///< samples a point
  std::size_t filled_ = 0;
  TracePoint sum_;
  std::vector<TracePoint> points_;
  std::vector<TracedDrive> drives_;
  std::vector<TracedModel> models_;
  std::vector<Interval> stops_;
  bool in_stop_ = false;
  std::vector<LearntTicks> learnt_;
  bool started_ = false;
  double start_s_ = 0.0;
};

}  // namespace zerorate::evaluate
