/// @file
/// Compares the biases that a node publishes with the true ones.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware/app/rate_message.hpp"
#include "host_tests/system/scenario/play.hpp"

namespace zerorate::scenario {

/// Error of a bias that was called healthy.
struct BiasError {
  double sigmas = 0.0;
  double time_s = 0.0;

  [[nodiscard]] bool is_wrong() const { return sigmas > 5.0; }
};

/// Outcome of one drive.
struct Outcome {
  std::uint64_t messages = 0;
  std::uint64_t healthy = 0;
  std::uint64_t no_numbers = 0;  ///< messages with a rate, and a figure in it that is none
  std::uint64_t restarts_with_memory = 0;
  BiasError worst;             ///< the largest, of a node that was calibrated at rest
  BiasError worst_after_turn;  ///< likewise, of one that was calibrated while the vehicle turned
};

/// Looks at every message of a drive.
class Judge {
 public:
  explicit Judge(const std::vector<simulate::ScenarioRow>& rows) : rows_(rows) {}
  void go_to(std::size_t row) { row_ = row; }
  void restart(bool with_memory) {
    if (with_memory) ++outcome_.restarts_with_memory;
    has_learnt_ = has_learnt_ && with_memory;
  }
  [[nodiscard]] const Outcome& outcome() const { return outcome_; }

  void publish(const app::RateMessage& message) {
    ++outcome_.messages;
    note_beginning(message.health.calibrated);
    if (!message.has_rate()) return;
    const app::Health good{.calibrated = true};
    const bool is_healthy = message.health == good;
    outcome_.healthy += is_healthy ? 1U : 0U;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const app::AxisRate& rate = message.axes[axis];
      const float sigma = rate.sigma.in(core::rad_per_s);
      const float bias = rate.bias.in(core::rad_per_s);
      const bool is_number =
          std::isfinite(bias) && std::isfinite(rate.corrected.in(core::rad_per_s)) &&
          !std::isnan(sigma) && (std::isfinite(sigma) || !message.health.calibrated);
      if (!is_number) ++outcome_.no_numbers;
      if (!is_healthy) continue;
      const double error = double{bias} - double{rows_[row_].bias_rad_s[axis]};
      const double sigmas = std::abs(error) / double{sigma};
      BiasError& worst = began_in_turn_ ? outcome_.worst_after_turn : outcome_.worst;
      if (sigmas <= worst.sigmas) continue;
      worst = {sigmas, static_cast<double>(rows_[row_].row.time_ns) * 1e-9};
    }
  }

 private:
  /// A turn before anything was learnt cannot be told from a bias.
  void note_beginning(bool calibrated) {
    if (!calibrated || has_learnt_) return;
    constexpr float kTurn_rad_s = static_cast<float>(0.1 * kDps);
    has_learnt_ = true;
    began_in_turn_ = std::ranges::any_of(rows_[row_].true_rate_rad_s,
                                         [](float rate) { return std::abs(rate) > kTurn_rad_s; });
  }

  const std::vector<simulate::ScenarioRow>& rows_;
  std::size_t row_ = 0;
  bool has_learnt_ = false;
  bool began_in_turn_ = false;  ///< the vehicle turned when the node was calibrated first
  Outcome outcome_;
};

}  // namespace zerorate::scenario
