#include "host_tools/lib/calibrate/turn_guide.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/base/numeric.hpp"
#include "firmware/wire/health_bits.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::calibrate {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double seconds(core::Duration duration) {
  return units::seconds(duration.ns());
}

double angle_rad(const app::RateMessage& message, std::size_t axis) {
  return double{message.turn[axis].angle.in(core::rad)};
}

double bias_rad_s(const app::RateMessage& message, std::size_t axis) {
  return double{message.axes[axis].bias.in(core::rad_per_s)};
}

}  // namespace

std::size_t GuidedTurn::axis() const {
  return static_cast<std::size_t>(std::ranges::max_element(farthest_rad) - farthest_rad.begin());
}

void TurnGuide::take(const wire::NumberedMessage& numbered) {
  if (!follows(numbered)) return;
  ++messages_;
  const app::RateMessage& message = numbered.message;
  if (stage_ != Stage::done) {
    if (message.motion == core::Motion::still) {
      take_rest(message);
    } else {
      take_motion(message);
    }
    if (turn_) {
      add_drive(message);
      add_circumstances(numbered);
    }
  }
  if (message.has_rate()) newest_rate_ = message.time;
  newest_ = numbered;
}

void TurnGuide::finish() {
  if (turn_) end_turn(still_since_.has_value());
}

double TurnGuide::rest_s() const {
  return still_since_ ? seconds(newest_->message.time - *still_since_) : 0.0;
}

/// Whether the message is a new one. Datagrams may overtake each other.
bool TurnGuide::follows(const wire::NumberedMessage& numbered) {
  constexpr std::int32_t kOvertaken = 8;
  if (!newest_) {
    newest_rate_ = numbered.message.time;
    return true;
  }
  const auto step = static_cast<std::int32_t>(numbered.sequence - newest_->sequence);
  if (step <= 0 && step > -kOvertaken && numbered.message.time <= newest_->message.time) {
    return false;
  }
  if (step <= 0) start_anew();
  return true;
}

/// The node was started again: its bias and its turn begin anew.
void TurnGuide::start_anew() {
  ++restarts_;
  turn_.reset();
  still_since_.reset();
  rest_before_.reset();
  newest_.reset();
  noise_ = {};
  if (stage_ != Stage::done) stage_ = Stage::rest;
}

void TurnGuide::take_rest(const app::RateMessage& message) {
  if (!still_since_) {
    const bool is_bump = was_bump();
    still_since_ = is_bump ? rest_before_ : message.time;
    const bool was_short = is_early_ && turn_ && !turn_->is_long_enough();
    if (was_short || (is_bump && !angle_before_rad_)) drop_turn();
  } else {
    learn_noise(message);
  }
  if (stage_ == Stage::turning) stage_ = Stage::pausing;
  const bool is_long = seconds(message.time - *still_since_) >= settings_.rest_s;
  if (!is_long || !message.health.calibrated) return;
  if (turn_) end_turn(true);
  if (stage_ != Stage::done) stage_ = Stage::ready;
}

void TurnGuide::take_motion(const app::RateMessage& message) {
  if (still_since_) {
    rest_before_ = std::exchange(still_since_, std::nullopt);
    angle_before_rad_ = turn_ ? std::optional{turn_->angle_rad} : std::nullopt;
  }
  if (!turn_) {
    is_early_ = stage_ == Stage::rest;
    turn_ = GuidedTurn{
        .begin_s = seconds(message.time - core::Instant{}),
        .rest_s = rest_before_ ? seconds(message.time - *rest_before_) : 0.0,
    };
    for (std::size_t i = 0; i < 3; ++i) first_bias_rad_s_[i] = bias_rad_s(message, i);
  }
  if (!is_early_) stage_ = Stage::turning;
}

/// Whether the motion that is over interrupted a rest for less than kBump_rad: the noise of the
/// gyro does so now and then.
bool TurnGuide::was_bump() const {
  constexpr double kBump_rad = 2.0 * units::kRadPerDeg;
  if (!rest_before_ || !turn_) return false;
  const std::array<double, 3> before = angle_before_rad_.value_or(std::array<double, 3>{});
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(std::abs(turn_->angle_rad[i] - before[i]) < kBump_rad)) return false;
  }
  return true;
}

/// The turn that had begun is none.
void TurnGuide::drop_turn() {
  turn_.reset();
  stage_ = is_early_ ? Stage::rest : Stage::ready;
}

void TurnGuide::learn_noise(const app::RateMessage& message) {
  const app::RateMessage& before = newest_->message;
  if (!message.has_rate() || !before.has_rate()) return;
  for (std::size_t i = 0; i < 3; ++i) {
    const double step = double{message.axes[i].measured.in(core::rad_per_s)} -
                        double{before.axes[i].measured.in(core::rad_per_s)};
    noise_.squares[i] += step * step;
  }
  noise_.time_s += seconds(message.time - before.time);
  noise_.count += 1.0;
}

/// Whether the node has begun its sum anew with this message. Each of two motions has two signs:
/// the time is shorter, and the angle is nearer to none than to the one before.
bool TurnGuide::departs(const app::RateMessage& message) const {
  const app::RateMessage& before = newest_->message;
  if (message.turn_time < before.turn_time) return true;
  if (before.motion != core::Motion::still || message.motion == core::Motion::still) return false;
  double from_none = 0.0;
  double from_before = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    from_none += std::abs(angle_rad(message, i));
    from_before += std::abs(angle_rad(message, i) - angle_rad(before, i));
  }
  return from_none < from_before;
}

void TurnGuide::add_drive(const app::RateMessage& message) {
  const bool is_first = !newest_ || departs(message);
  const core::Duration length =
      is_first ? message.turn_time : message.turn_time - newest_->message.turn_time;
  turn_->length_s += seconds(length);
  for (std::size_t i = 0; i < 3; ++i) {
    turn_->angle_rad[i] +=
        angle_rad(message, i) - (is_first ? 0.0 : angle_rad(newest_->message, i));
    turn_->farthest_rad[i] = std::max(turn_->farthest_rad[i], std::abs(turn_->angle_rad[i]));
    turn_->bias_step_rad_s[i] = std::max(turn_->bias_step_rad_s[i],
                                         std::abs(bias_rad_s(message, i) - first_bias_rad_s_[i]));
    const double bias_sigma_rad_s = double{message.axes[i].sigma.in(core::rad_per_s)};
    if (length > core::Duration{}) turn_->sigma_rad[i] += bias_sigma_rad_s * seconds(length);
    if (!core::is_finite(message.turn[i].sigma.in(core::rad))) turn_->sigma_rad[i] = kInfinity;
  }
}

void TurnGuide::add_circumstances(const wire::NumberedMessage& numbered) {
  const app::RateMessage& message = numbered.message;
  turn_->alarms = wire::decode_health(static_cast<std::uint16_t>(
      wire::encode_health(turn_->alarms) | wire::encode_health(message.health)));
  const std::uint32_t lost = newest_ ? numbered.sequence - newest_->sequence - 1 : 0;
  turn_->lost_messages += lost;
  if (lost == 0) {
    turn_->silence_s = std::max(turn_->silence_s, seconds(message.time - newest_rate_));
  }
}

void TurnGuide::end_turn(bool is_over) {
  GuidedTurn turn = *std::exchange(turn_, std::nullopt);
  turn.is_over = is_over;
  const double count = std::max(noise_.count, 1.0);
  for (std::size_t i = 0; i < 3; ++i) {
    const double white_rad2 =
        0.5 * noise_.squares[i] / count * noise_.time_s / count * turn.length_s;
    turn.sigma_rad[i] = std::hypot(turn.sigma_rad[i], std::sqrt(white_rad2));
  }
  if (turn.is_long_enough()) (is_early_ ? early_turns_ : turns_).push_back(turn);
  if (settings_.wanted > 0 && turns_.size() >= settings_.wanted) stage_ = Stage::done;
}

}  // namespace zerorate::calibrate
