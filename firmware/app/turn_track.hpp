/// @file
/// Turn since departure of a node: what is summed, and when its error is computed anew.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "core/heading/turn_sum.hpp"
#include "core/heading/vertical.hpp"
#include "core/inputs/accelerometer.hpp"
#include "core/standstill/standstill.hpp"
#include "firmware/app/rate_message.hpp"
#include "firmware/app/reference_track.hpp"
#include "firmware/app/tick_forecast.hpp"

namespace zerorate::app {

/// Place of a ReferenceTrack where no references are taken.
struct NoReferences {
  struct State {
    constexpr bool operator==(const State&) const = default;
  };
};

/// Sums the published rates of a GyroNode. The error of the sum is asked of the TickNode, whose
/// steps compute it when the drive is longer by an eighth. References correct both.
/// @tparam Ticks a TickNode
template <class Ticks>
class TurnTrack {
 public:
  static constexpr std::size_t kAxes = Ticks::kAxes;
  using Params = typename Ticks::Params;
  using Vertical = std::conditional_t<Ticks::kMeasuresVertical, core::MeasuredVertical,
                                      core::GivenVertical<kAxes>>;
  using Sum = core::TurnSum<Vertical::kSummedAxes>;
  static constexpr bool kTakesReferences = Ticks::kTakesReferences;
  using References = std::conditional_t<kTakesReferences, ReferenceTrack<Sum>, NoReferences>;
  static constexpr std::uint32_t kShortest = 16;  ///< ticks

  struct State {
    /// Length of the drive whose error was asked for last. A bias hardly changes in a shorter one.
    std::uint32_t asked_ticks = kShortest;
    typename Sum::State sum;
    [[no_unique_address]] typename Vertical::State vertical;
    [[no_unique_address]] typename References::State references;

    constexpr bool operator==(const State&) const = default;
  };

  /// @param params must outlive the track
  constexpr explicit TurnTrack(const Params& params)
      : params_(params),
        sum_(params.model.motion, params.model.sample_period,
             std::max(params.standstill.hold_back, kLongestUnnoticed)),
        vertical_(params.up),
        references_(made_references(params, vertical_)) {}

  [[nodiscard]] constexpr State state() const {
    State state{asked_ticks_, sum_.state(), vertical_.state(), {}};
    if constexpr (kTakesReferences) state.references = references_.state();
    return state;
  }
  constexpr void restore(const State& state) {
    asked_ticks_ = state.asked_ticks;
    sum_.restore(state.sum);
    vertical_.restore(state.vertical);
    if constexpr (kTakesReferences) references_.restore(state.references);
  }
  /// Goes on, before the first sample, with what references taught another run.
  constexpr void resume(const core::LearntMotion& learnt, float pause_s) requires kTakesReferences {
    references_.resume(learnt, pause_s);
  }
  /// Whether memory from outside may be such a state.
  [[nodiscard]] static bool is_possible(const State& state) {
    if constexpr (kTakesReferences) {
      if (!References::is_possible(state.references)) return false;
    }
    return Sum::is_possible(state.sum) && Vertical::is_possible(state.vertical);
  }

  [[nodiscard]] constexpr const Vertical& vertical() const { return vertical_; }
  /// Earth's rotation about the measured vertical.
  [[nodiscard]] constexpr core::EarthRate earth() const {
    const core::UpAxis axis = params_.up.value_or(core::UpAxis{});
    if (!vertical_.is_known()) return params_.earth.about_any(axis);
    return params_.earth.about(axis, vertical_.up());
  }
  [[nodiscard]] constexpr const References& references() const { return references_; }
  /// Heading at the newest sample.
  [[nodiscard]] constexpr Heading heading() const { return references_.heading(sum_); }
  /// Takes a reference of the heading or of a turn.
  template <class Reference>
  constexpr core::ReferenceVerdict take(const Reference& reference, core::Instant newest,
                                        const Ticks& ticks) {
    if (!ticks.predicted()[0].is_available() || !ticks.predictors().has_learnt()) {
      return core::ReferenceVerdict::no_bias;
    }
    return references_.take(reference, newest, sum_);
  }

  /// Time passed in which nothing was measured.
  constexpr void lose() {
    sum_.lose();
    vertical_.lose();
    if constexpr (kTakesReferences) references_.lose();
  }
  /// A tick is over, and the steps of the next one have not begun.
  constexpr void close_tick(Ticks& ticks) {
    if constexpr (Ticks::kMeasuresVertical) follow_vertical(ticks);
    sum_.close_tick();
    if constexpr (kTakesReferences) references_.follow(sum_, bias_variance_rad2_s2(ticks));
    if (!sum_.moves() || ticks.drive().ticks > 0) return;
    const auto length = static_cast<std::uint32_t>(sum_.duration() / params_.model.modes.tick) + 1;
    // Forces come and go: what they add to the error of the turn may be less a second later.
    const std::uint32_t eighth = asked_ticks_ / 8;
    const bool follows_forces = params_.model.inputs.follows(core::is_inertial);
    const std::uint32_t wait = follows_forces ? std::min(eighth, second_ticks()) : eighth;
    if (length <= asked_ticks_ + wait) return;
    asked_ticks_ = length;
    ticks.drive().ticks = length;
  }
  /// Adds the rate of a message as it is published.
  /// @param is_learning whether a measurement of the stop that is over will still be learnt
  constexpr void add(const RateMessage& message, core::Duration since_last,
                     std::uint8_t saturated_axes, bool is_learning, Ticks& ticks) {
    typename Sum::Sample sample{.since_last = since_last,
                                .saturated_axes = saturated_axes,
                                .moves = message.motion != core::Motion::still};
    for (std::size_t i = 0; i < kAxes; ++i) {
      sample.rate_rad_s[i] = message.axes[i].corrected.in(core::rad_per_s);
      sample.bias_sigma_rad_s[i] = message.axes[i].sigma.in(core::rad_per_s);
    }
    if (sample.moves) follow_motion(message, is_learning, ticks);
    vertical_.complete(sample);
    if constexpr (kTakesReferences) add_to_references(message.time, sample);
    sum_.add(sample);
    take_error(ticks);
  }
  /// Corrects the rate about the vertical by what references taught.
  constexpr void correct(RateMessage& message) const {
    if constexpr (kTakesReferences) {
      const core::HeadingFilter& filter = references_.filter();
      message.health.reference_disagreement = filter.disagrees();
      if (!filter.has_learnt()) return;
      if (message.motion != core::Motion::still) correct_bias(message);
      float rate_rad_s = 0.0F;
      vertical_.for_each_share([&](std::size_t i, float share) {
        rate_rad_s += share * message.axes[i].corrected.in(core::rad_per_s);
      });
      const float more_rad_s = filter.scaled(rate_rad_s) - rate_rad_s;
      vertical_.for_each_share([&](std::size_t i, float share) {
        AxisRate& axis = message.axes[i];
        axis.corrected = axis.corrected + core::rad_per_s(share * more_rad_s);
      });
    }
  }
  /// @param silence time since the newest sample
  constexpr void describe(core::Duration silence, RateMessage& message) const {
    message.turn_time = sum_.duration();
    for (std::size_t i = 0; i < kAxes; ++i) message.turn[i] = turn(i, silence);
    const std::size_t axis = vertical_.axis();
    if (axis < kAxes && has_learnt_motion()) message.turn[axis] = learnt_turn(silence);
    if (!vertical_.is_known()) return;
    message.up = vertical_.up();
    if constexpr (Ticks::kMeasuresVertical) message.slope = vertical_.slope();
    if (axis < kAxes) {
      message.vertical_turn = message.turn[axis];
    } else {
      message.vertical_turn = has_learnt_motion() ? learnt_turn(silence) : turn(axis, silence);
    }
    if (vertical_.sense() < 0.0F) {
      message.vertical_turn.angle = core::Angle{} - message.vertical_turn.angle;
    }
    if constexpr (kTakesReferences) {
      if (silence == core::Duration{}) message.heading = heading();
    }
  }

 private:
  /// Zero where the chip gave none.
  [[nodiscard]] static constexpr float temperature_k_of(const RateMessage& message) {
    constexpr float kZeroCelsius_k = 273.15F;
    return message.temperature ? kZeroCelsius_k + message.temperature->degc() : 0.0F;
  }
  [[nodiscard]] constexpr std::uint32_t second_ticks() const {
    return static_cast<std::uint32_t>(core::Duration::seconds(1) / params_.model.modes.tick);
  }
  /// Time from a motion without pulses to the verdict of the gyro.
  static constexpr core::Duration kLongestUnnoticed = core::Duration::milliseconds(1500);

  /// A measured vertical follows the slopes.
  [[nodiscard]] static constexpr float slope_variance_rad2(const Params& params) {
    return Ticks::kMeasuresVertical ? 0.0F : params.model.motion.slope_variance_rad2;
  }
  [[nodiscard]] static constexpr References made_references(const Params& params,
                                                            const Vertical& vertical) {
    if constexpr (kTakesReferences) {
      const core::MotionModel& motion = params.model.motion;
      return References{{.scale_factor = motion.scale_factor,
                         .scale_factor_per_k = motion.scale_factor_per_k,
                         .scale_factor_at_k = motion.scale_factor_at_k,
                         .slope_variance_rad2 = slope_variance_rad2(params)},
                        vertical.axis(),
                        vertical.sense()};
    } else {
      return {};
    }
  }
  /// Variance of the predicted bias about the vertical.
  [[nodiscard]] constexpr float bias_variance_rad2_s2(const Ticks& ticks) const {
    return vertical_.variance([&](std::size_t i) {
      return ticks.predicted()[i].variance_rad2_s2 +
             TickForecast<Ticks>{ticks}.constant_variance_rad2_s2(i);
    });
  }
  /// The vertical turns with the tick that is over. A rotation within it counts as one about a
  /// steady axis.
  constexpr void follow_vertical(const Ticks& ticks) {
    const auto& turn_rad = sum_.state().tick_rad;
    if (sum_.moves()) vertical_.turn({turn_rad[0], turn_rad[1], turn_rad[2]});
    const core::TickForce force = ticks.inputs().tick_force();
    vertical_.close_tick(force.readings > 0 ? &force.mean_g : nullptr, !sum_.moves(),
                         sum_.state().newest_rad_s[vertical_.axis()], params_.model.modes.tick);
  }
  /// Adds the bias in motion beyond that which rest predicts.
  constexpr void correct_bias(RateMessage& message) const {
    const core::HeadingFilter& filter = references_.filter();
    vertical_.for_each_share([&](std::size_t i, float share) {
      AxisRate& axis = message.axes[i];
      const auto more = core::rad_per_s(share * filter.bias_in_motion_rad_s());
      axis.bias = axis.bias + more;
      axis.corrected = axis.corrected - more;
      const float sigma_rad_s = axis.sigma.in(core::rad_per_s);
      const float variance = sigma_rad_s * sigma_rad_s;
      const float about_vertical = filter.bias_variance_rad2_s2(variance);
      axis.sigma = core::rad_per_s(
          core::square_root(variance + share * share * (about_vertical - variance)));
    });
  }
  /// The turn about the vertical is summed before its scale factor: that may become known later.
  constexpr void add_to_references(core::Instant at, typename Sum::Sample& sample) {
    const std::size_t axis = vertical_.axis();
    sample.rate_rad_s[axis] = references_.filter().unscaled(sample.rate_rad_s[axis]);
    references_.add(sample.rate_rad_s[axis], sample.since_last);
    if (((sample.saturated_axes >> axis) & 1U) != 0) references_.lose();
    if (sum_.moves() && !sample.moves) references_.stop(at);
  }
  /// Turn of a summed axis since departure, by the tolerance of its scale factor.
  [[nodiscard]] constexpr AxisTurn turn(std::size_t axis, core::Duration silence) const {
    const float tolerance_rad2 =
        sum_.scale_variance_rad2(axis) + 2.0F * slope_variance_rad2(params_);
    return {.angle = sum_.angle(axis), .sigma = sum_.sigma(axis, tolerance_rad2, silence)};
  }
  [[nodiscard]] constexpr bool has_learnt_motion() const {
    if constexpr (kTakesReferences) return references_.filter().has_learnt();
    return false;
  }
  /// Turn of the vertical's axis since departure, by the scale factor that references taught.
  [[nodiscard]] constexpr AxisTurn learnt_turn(core::Duration silence) const {
    if constexpr (kTakesReferences) {
      const std::size_t axis = vertical_.axis();
      return {.angle = core::rad(references_.filter().scaled(sum_.angle(axis).in(core::rad))),
              .sigma = sum_.sigma(axis, references_.scale_variance_rad2(sum_), silence)};
    }
    return {};
  }

  /// Notices a departure. A measurement that is learnt after it belongs to the stop before.
  constexpr void follow_motion(const RateMessage& message, bool is_learning, const Ticks& ticks) {
    if (!sum_.moves() && (is_learning || sum_.has_rested(ticks.measured_ticks()))) {
      typename Sum::Rates white{};
      for (std::size_t i = 0; i < kAxes; ++i) white[i] = ticks.white_variance_rad2_s2(i);
      vertical_.complete_variances(white);
      const float temperature_k = temperature_k_of(message);
      if constexpr (kTakesReferences) {
        references_.depart(sum_, message.time, bias_variance_rad2_s2(ticks), temperature_k);
      }
      sum_.depart(white, temperature_k);
      asked_ticks_ = kShortest;
    }
    sum_.note_measurement(ticks.measured_ticks());
  }
  constexpr void take_error(Ticks& ticks) {
    auto& drive = ticks.drive();
    if (!drive.is_known) return;
    drive.is_known = false;
    const float length_s = sum_.duration().in_seconds();
    typename Sum::Rates variances{};
    for (std::size_t i = 0; i < kAxes; ++i) {
      const float constant = TickForecast<Ticks>{ticks}.constant_variance_rad2_s2(i);
      variances[i] = drive.variance_rad2[i] + constant * length_s * length_s;
    }
    vertical_.complete_variances(variances);
    for (std::size_t i = 0; i < variances.size(); ++i) sum_.set_bias_variance(i, variances[i]);
  }

  const Params& params_;
  Sum sum_;
  Vertical vertical_;
  std::uint32_t asked_ticks_ = kShortest;
  [[no_unique_address]] References references_;
};

}  // namespace zerorate::app
