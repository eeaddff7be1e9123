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
  using Sum = core::TurnSum<kAxes>;
  static constexpr bool kTakesReferences = Ticks::kTakesReferences;
  using References = std::conditional_t<kTakesReferences, ReferenceTrack<kAxes>, NoReferences>;
  static constexpr std::uint32_t kShortest = 16;  ///< ticks

  struct State {
    /// Length of the drive whose error was asked for last. A bias hardly changes in a shorter one.
    std::uint32_t asked_ticks = kShortest;
    typename Sum::State sum;
    [[no_unique_address]] typename References::State references;

    constexpr bool operator==(const State&) const = default;
  };

  /// @param params must outlive the track
  constexpr explicit TurnTrack(const Params& params)
      : params_(params),
        sum_(params.model.motion, params.model.sample_period,
             std::max(params.standstill.hold_back, kLongestUnnoticed)),
        references_(made_references(params)) {}

  [[nodiscard]] constexpr State state() const {
    State state{asked_ticks_, sum_.state(), {}};
    if constexpr (kTakesReferences) state.references = references_.state();
    return state;
  }
  constexpr void restore(const State& state) {
    asked_ticks_ = state.asked_ticks;
    sum_.restore(state.sum);
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
    return Sum::is_possible(state.sum);
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
    if constexpr (kTakesReferences) references_.lose();
  }
  /// A tick is over, and the steps of the next one have not begun.
  constexpr void close_tick(Ticks& ticks) {
    sum_.close_tick();
    if constexpr (kTakesReferences) references_.follow(sum_, bias_variance_rad2_s2(ticks));
    if (!sum_.moves() || ticks.drive().ticks > 0) return;
    const auto length = static_cast<std::uint32_t>(sum_.duration() / params_.model.modes.tick) + 1;
    // Forces come and go: what they add to the error of the turn may be less at its end.
    const std::uint32_t wait = Ticks::kHasAccelerometer ? 0 : asked_ticks_ / 8;
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
    if constexpr (kTakesReferences) add_to_references(message.time, sample);
    sum_.add(sample);
    take_error(ticks);
  }
  /// Corrects the rate of the vertical axis by what references taught.
  constexpr void correct(RateMessage& message) const {
    if constexpr (kTakesReferences) {
      const core::HeadingFilter& filter = references_.filter();
      message.health.reference_disagreement = filter.disagrees();
      if (!filter.has_learnt()) return;
      AxisRate& axis = message.axes[references_.axis()];
      if (message.motion != core::Motion::still) {
        const auto more = core::rad_per_s(references_.bias_in_motion_rad_s());
        const float sigma_rad_s = axis.sigma.in(core::rad_per_s);
        axis.bias = axis.bias + more;
        axis.corrected = axis.corrected - more;
        axis.sigma = core::rad_per_s(
            core::square_root(filter.bias_variance_rad2_s2(sigma_rad_s * sigma_rad_s)));
      }
      axis.corrected = core::rad_per_s(filter.scaled(axis.corrected.in(core::rad_per_s)));
    }
  }
  /// @param silence time since the newest sample
  constexpr void describe(core::Duration silence, RateMessage& message) const {
    if (params_.up) message.up = params_.up->direction();
    message.turn_time = sum_.duration();
    for (std::size_t i = 0; i < kAxes; ++i) {
      message.turn[i] = {.angle = sum_.angle(i),
                         .sigma = sum_.sigma(i, sum_.scale_variance_rad2(i), silence)};
    }
    if constexpr (kTakesReferences) describe_vertical(silence, message);
  }

 private:
  /// Zero where the chip gave none.
  [[nodiscard]] static constexpr float temperature_k_of(const RateMessage& message) {
    constexpr float kZeroCelsius_k = 273.15F;
    return message.temperature ? kZeroCelsius_k + message.temperature->degc() : 0.0F;
  }
  /// Time from a motion without pulses to the verdict of the gyro.
  static constexpr core::Duration kLongestUnnoticed = core::Duration::milliseconds(1500);

  [[nodiscard]] static constexpr References made_references(const Params& params) {
    if constexpr (kTakesReferences) {
      return References{params};
    } else {
      return {};
    }
  }
  [[nodiscard]] constexpr float bias_variance_rad2_s2(const Ticks& ticks) const {
    const std::size_t axis = references_.axis();
    return ticks.predicted()[axis].variance_rad2_s2 +
           TickForecast<Ticks>{ticks}.constant_variance_rad2_s2(axis);
  }
  /// The turn of the vertical axis is summed before its scale factor: that may become known later.
  constexpr void add_to_references(core::Instant at, typename Sum::Sample& sample) {
    const std::size_t axis = references_.axis();
    sample.rate_rad_s[axis] = references_.filter().unscaled(sample.rate_rad_s[axis]);
    references_.add(sample.rate_rad_s[axis], sample.since_last);
    if (((sample.saturated_axes >> axis) & 1U) != 0) references_.lose();
    if (sum_.moves() && !sample.moves) references_.stop(at);
  }
  constexpr void describe_vertical(core::Duration silence, RateMessage& message) const {
    if (params_.up && silence == core::Duration{}) message.heading = heading();
    const std::size_t axis = references_.axis();
    if (!references_.filter().has_learnt()) return;
    message.turn[axis] = {
        .angle = core::rad(references_.filter().scaled(sum_.angle(axis).in(core::rad))),
        .sigma = sum_.sigma(axis, references_.scale_variance_rad2(sum_), silence)};
  }

  /// Notices a departure. A measurement that is learnt after it belongs to the stop before.
  constexpr void follow_motion(const RateMessage& message, bool is_learning, const Ticks& ticks) {
    if (!sum_.moves() && (is_learning || sum_.has_rested(ticks.measured_ticks()))) {
      typename Sum::Rates white{};
      for (std::size_t i = 0; i < kAxes; ++i) white[i] = ticks.white_variance_rad2_s2(i);
      if constexpr (kTakesReferences) {
        references_.depart(sum_, message.time, bias_variance_rad2_s2(ticks),
                           temperature_k_of(message));
      }
      sum_.depart(white);
      asked_ticks_ = kShortest;
    }
    sum_.note_measurement(ticks.measured_ticks());
  }
  constexpr void take_error(Ticks& ticks) {
    auto& drive = ticks.drive();
    if (!drive.is_known) return;
    drive.is_known = false;
    const float length_s = sum_.duration().in_seconds();
    for (std::size_t i = 0; i < kAxes; ++i) {
      const float constant = TickForecast<Ticks>{ticks}.constant_variance_rad2_s2(i);
      sum_.set_bias_variance(i, drive.variance_rad2[i] + constant * length_s * length_s);
    }
  }

  const Params& params_;
  Sum sum_;
  [[no_unique_address]] References references_;
  std::uint32_t asked_ticks_ = kShortest;
};

}  // namespace zerorate::app
