/// @file
/// Guide through a calibration by turns: stand still, turn, stand still, turn back, stand still.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "core/base/time.hpp"
#include "firmware/wire/rate_frame.hpp"

namespace zerorate::calibrate {

/// Shortest turn that is one: half a round. What is less is a bump, and is forgotten at rest.
inline constexpr double kShortestTurn_rad = std::numbers::pi;

/// A turn between two stops, as a node measured it.
struct GuidedTurn {
  std::array<double, 3> angle_rad{};
  std::array<double, 3> farthest_rad{};  ///< largest size of each angle on the way
  /// Standard deviation of each angle by bias and white noise, see TurnGuide; infinite where the
  /// node could not follow the axis, as at full scale.
  std::array<double, 3> sigma_rad{};
  double begin_s = 0.0;                     ///< on the clock of the node
  double length_s = 0.0;                    ///< time that was summed
  double rest_s = 0.0;                      ///< rest before it
  double silence_s = 0.0;                   ///< longest time without a sample
  std::array<double, 3> bias_step_rad_s{};  ///< largest change of the bias since the beginning
  std::uint64_t lost_messages = 0;
  app::Health alarms;    ///< flags that were set in any of its messages
  bool is_over = false;  ///< false: the messages end before the rest

  /// Axis that has turned farthest.
  [[nodiscard]] std::size_t axis() const;
  /// Angle in full turns.
  [[nodiscard]] double rounds(std::size_t of_axis) const {
    return 0.5 * angle_rad[of_axis] / std::numbers::pi;
  }
  [[nodiscard]] bool is_long_enough() const { return farthest_rad[axis()] >= kShortestTurn_rad; }
};

/// Follows the messages of a node.
///
/// Several drives of the node are one turn where the rests between them are short: whoever turns by
/// hand pauses to change the grip. A turn is over after a rest as long as the one before it.
///
/// The standard deviation that the node publishes contains the tolerance of the scale factor, which
/// is looked for here. So the guide sums that of the bias, which each message has, over the time of
/// the turn: as much as if the error of the bias stayed the same, an upper bound. The white noise
/// is measured by the differences of neighbouring messages at rest.
class TurnGuide {
 public:
  enum class Stage : std::uint8_t {
    rest,     ///< stands still for not long enough yet, or moves before it did
    ready,    ///< may be turned
    turning,  ///< turns
    pausing,  ///< stands still after a turn, for not long enough yet
    done,     ///< all turns are there
  };
  struct Settings {
    std::size_t wanted = 2;  ///< turns until it is done; 0: as many as there are
    double rest_s = 10.0;    ///< rest before and after a turn
  };

  explicit TurnGuide(const Settings& settings) : settings_(settings) {}

  void take(const wire::NumberedMessage& numbered);
  /// There are no more messages: a turn whose rest has begun is over.
  void finish();

  [[nodiscard]] Stage stage() const { return stage_; }
  /// Rest up to now.
  [[nodiscard]] double rest_s() const;
  /// Turn that goes on, if one does.
  [[nodiscard]] GuidedTurn current() const { return turn_.value_or(GuidedTurn{}); }
  [[nodiscard]] const std::vector<GuidedTurn>& turns() const { return turns_; }
  /// Turns that began before the rest was long enough.
  [[nodiscard]] const std::vector<GuidedTurn>& early_turns() const { return early_turns_; }
  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  [[nodiscard]] std::uint64_t restarts() const { return restarts_; }
  /// Whether the node has measured a bias.
  [[nodiscard]] bool is_calibrated() const { return newest_ && newest_->message.health.calibrated; }

 private:
  /// Squared differences of neighbouring messages at rest.
  struct Noise {
    std::array<double, 3> squares{};
    double time_s = 0.0;
    double count = 0.0;
  };

  [[nodiscard]] bool follows(const wire::NumberedMessage& numbered);
  void start_anew();
  void take_rest(const app::RateMessage& message);
  void take_motion(const app::RateMessage& message);
  [[nodiscard]] bool was_bump() const;
  void drop_turn();
  void learn_noise(const app::RateMessage& message);
  void add_drive(const app::RateMessage& message);
  void add_circumstances(const wire::NumberedMessage& numbered);
  [[nodiscard]] bool departs(const app::RateMessage& message) const;
  void end_turn(bool is_over);

  Settings settings_;
  Stage stage_ = Stage::rest;
  std::optional<wire::NumberedMessage> newest_;
  std::optional<core::Instant> still_since_;
  std::optional<core::Instant> rest_before_;  ///< beginning of the rest before the newest motion
  std::optional<std::array<double, 3>> angle_before_rad_;  ///< angles then; none before a turn
  core::Instant newest_rate_;
  Noise noise_;

  std::optional<GuidedTurn> turn_;  ///< one that goes on; `sigma_rad` is that of the bias alone
  std::array<double, 3> first_bias_rad_s_{};
  bool is_early_ = false;  ///< it began before the rest was long enough
  std::vector<GuidedTurn> turns_;
  std::vector<GuidedTurn> early_turns_;
  std::uint64_t messages_ = 0;
  std::uint64_t restarts_ = 0;
};

}  // namespace zerorate::calibrate
