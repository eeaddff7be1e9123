/// @file
/// The exponential mean of all samples at rest, for several memories at once: the competitor that
/// trackers commonly use.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "host_tools/lib/evaluate/drive_scores.hpp"
#include "host_tools/lib/evaluate/replay.hpp"

namespace zerorate::contest {

/// Weight of a new sample in an exponential mean: that of a plain mean until the memory is full.
/// @param elapsed_s  since the sample before
/// @param samples    number of samples, the new one included
[[nodiscard]] inline double exponential_weight(double elapsed_s, double memory_s, double samples) {
  return std::min(std::max(elapsed_s / memory_s, 1.0 / samples), 1.0);
}

/// Watches a replay and scores its own predictions on the same drives. It sees every sample of a
/// stop, hold-back and settle time included, and thereby a little more than the node.
class ExponentialMeans {
 public:
  /// @param memories_s time constants; they must outlive the object
  ExponentialMeans(std::span<const double> memories_s, std::size_t axes)
      : memories_s_(memories_s), cells_(axes * memories_s.size()) {}

  /// For evaluate::ReplayObserver::on_sample; the object must outlive the replay.
  [[nodiscard]] std::function<void(const evaluate::ReplayedSample&)> observer() {
    return [this](const evaluate::ReplayedSample& sample) { take(sample); };
  }

  /// Ends a drive that the recording left open.
  void finish() { close_drive(); }

  /// Without intervals: coverage and sigma mean nothing.
  [[nodiscard]] const evaluate::DriveScores& scores(std::size_t axis, std::size_t memory) const {
    return cells_[axis * memories_s_.size() + memory].scores;
  }

 private:
  struct Cell {
    double mean_rad_s = 0.0;
    evaluate::Drive drive{};
    evaluate::DriveScores scores{};
  };

  void take(const evaluate::ReplayedSample& sample) {
    if (!sample.message.has_rate()) return;
    const double elapsed_s =
        has_time_ ? static_cast<double>((sample.message.time - newest_).ns()) * 1e-9 : 0.0;
    newest_ = sample.message.time;
    has_time_ = true;
    if (!sample.moving) {
      close_drive();
      learn(sample, elapsed_s);
    } else if (core::is_finite(sample.message.axes[0].sigma.in(core::rad_per_s))) {
      driving_ = true;
      for_each_cell(sample, [&](Cell& cell, double rate_rad_s, double) {
        cell.drive.add(rate_rad_s - cell.mean_rad_s, elapsed_s);
      });
    }
  }

  void learn(const evaluate::ReplayedSample& sample, double elapsed_s) {
    ++samples_;  // at rest alone: a drive forgets nothing
    for_each_cell(sample, [&](Cell& cell, double rate_rad_s, double memory_s) {
      cell.mean_rad_s +=
          exponential_weight(elapsed_s, memory_s, samples_) * (rate_rad_s - cell.mean_rad_s);
    });
  }

  void close_drive() {
    if (!driving_) return;
    driving_ = false;
    for (Cell& cell : cells_) {
      cell.scores.add({.drift_rad = cell.drive.integrated_rad()});
      cell.drive = {};
    }
  }

  template <class Action>
  void for_each_cell(const evaluate::ReplayedSample& sample, Action action) {
    const std::size_t axes = cells_.size() / memories_s_.size();
    for (std::size_t axis = 0; axis < axes; ++axis) {
      const double rate_rad_s = double{sample.message.axes[axis].measured.in(core::rad_per_s)};
      for (std::size_t m = 0; m < memories_s_.size(); ++m) {
        action(cells_[axis * memories_s_.size() + m], rate_rad_s, memories_s_[m]);
      }
    }
  }

  std::span<const double> memories_s_;
  std::vector<Cell> cells_;
  core::Instant newest_;
  bool has_time_ = false;
  bool driving_ = false;
  double samples_ = 0.0;
};

}  // namespace zerorate::contest
