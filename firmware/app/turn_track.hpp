/// @file
/// Turn since departure of a node: what is summed, and when its error is computed anew.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "core/heading/turn_sum.hpp"
#include "core/standstill/standstill.hpp"
#include "firmware/app/rate_message.hpp"
#include "firmware/app/tick_forecast.hpp"

namespace zerorate::app {

/// Sums the published rates of a GyroNode. The error of the sum is asked of the TickNode, whose
/// steps compute it when the drive is longer by an eighth.
/// @tparam Ticks a TickNode
template <class Ticks>
class TurnTrack {
 public:
  static constexpr std::size_t kAxes = Ticks::kAxes;
  using Params = typename Ticks::Params;
  using Sum = core::TurnSum<kAxes>;
  static constexpr std::uint32_t kShortest = 16;  ///< ticks

  struct State {
    /// Length of the drive whose error was asked for last. A bias hardly changes in a shorter one.
    std::uint32_t asked_ticks = kShortest;
    typename Sum::State sum;

    constexpr bool operator==(const State&) const = default;
  };

  /// @param params must outlive the track
  constexpr explicit TurnTrack(const Params& params)
      : params_(params),
        sum_(params.model.motion, params.model.sample_period,
             std::max(params.standstill.hold_back, kLongestUnnoticed)) {}

  [[nodiscard]] constexpr State state() const { return {asked_ticks_, sum_.state()}; }
  constexpr void restore(const State& state) {
    asked_ticks_ = state.asked_ticks;
    sum_.restore(state.sum);
  }

  /// Time passed in which nothing was measured.
  constexpr void lose() { sum_.lose(); }
  /// A tick is over, and the steps of the next one have not begun.
  constexpr void close_tick(Ticks& ticks) {
    sum_.close_tick();
    if (!sum_.moves() || ticks.drive().ticks > 0) return;
    const auto length = static_cast<std::uint32_t>(sum_.duration() / params_.model.modes.tick) + 1;
    if (length <= asked_ticks_ + asked_ticks_ / 8) return;
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
    if (sample.moves) follow_motion(is_learning, ticks);
    sum_.add(sample);
    take_error(ticks);
  }
  /// @param silence time since the newest sample
  constexpr void describe(core::Duration silence, RateMessage& message) const {
    message.turn_time = sum_.duration();
    for (std::size_t i = 0; i < kAxes; ++i) {
      message.turn[i] = {.angle = sum_.angle(i), .sigma = sum_.sigma(i, silence)};
    }
  }

 private:
  /// Time from a motion without pulses to the verdict of the gyro.
  static constexpr core::Duration kLongestUnnoticed = core::Duration::milliseconds(1500);

  /// Notices a departure. A measurement that is learnt after it belongs to the stop before.
  constexpr void follow_motion(bool is_learning, const Ticks& ticks) {
    if (!sum_.moves() && (is_learning || sum_.has_rested(ticks.measured_ticks()))) {
      typename Sum::Rates white{};
      for (std::size_t i = 0; i < kAxes; ++i) white[i] = ticks.white_variance_rad2_s2(i);
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
  std::uint32_t asked_ticks_ = kShortest;
};

}  // namespace zerorate::app
