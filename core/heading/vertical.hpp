/// @file
/// The vertical in the axes of a sensor.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/earth_rate.hpp"
#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"

namespace zerorate::core {

/// The vertical as it is given: an axis, or nothing.
/// @tparam Axes of the sensor
template <std::size_t Axes>
class GivenVertical {
 public:
  /// Axes of a TurnSum beside this vertical, which is one of them.
  static constexpr std::size_t kSummedAxes = Axes;

  struct State {
    constexpr bool operator==(const State&) const = default;
  };

  constexpr explicit GivenVertical(const std::optional<UpAxis>& given)
      : is_known_(given.has_value()), up_(given.value_or(UpAxis{})) {
    up_.axis = static_cast<std::uint8_t>(std::min<std::size_t>(up_.axis, Axes - 1));
  }
  [[nodiscard]] constexpr State state() const { return {}; }
  constexpr void restore(State /*state*/) {}
  [[nodiscard]] static constexpr bool is_possible(State /*state*/) { return true; }

  [[nodiscard]] constexpr bool is_known() const { return is_known_; }
  [[nodiscard]] constexpr Direction up() const { return up_.direction(); }
  /// Place of the vertical among the summed axes, and whether that counts turns as seen from above.
  [[nodiscard]] constexpr std::size_t axis() const { return up_.axis; }
  [[nodiscard]] constexpr float sense() const { return up_.points_down ? -1.0F : 1.0F; }

  /// Calls use(axis, share) for each axis of the sensor that measures turns about the vertical.
  template <class Use>
  constexpr void for_each_share(Use use) const {
    use(axis(), sense());
  }
  /// Variance about the vertical, where of(axis) is that of an axis.
  template <class Of>
  [[nodiscard]] constexpr float variance(Of of) const {
    return of(axis());
  }
  /// No-ops: a given axis cannot be lost, and is among the summed ones.
  static constexpr void lose() {}
  static constexpr void complete(auto& /*sample*/) {}
  static constexpr void complete_variances(auto& /*variances*/) {}

 private:
  bool is_known_;
  UpAxis up_;
};

/// The vertical by the specific force at rest, and by the rates since then.
///
/// At rest an accelerometer shows the vertical: the mean over the stop. In motion the sensor turns
/// under it, dn/dt = n x omega. Straight on, where the force is near 1 g, the force corrects what
/// the errors of the rates add up to, with a time constant of a minute: accelerations come and go
/// (Mahony, Hamel and Pflimlin 2008, without the learning of a bias).
///
/// A force that is no gravity at rest (below 0.9 g or above 1.1 g) is not believed, nor is one that
/// differs from the given axis by more than 45 deg: then the given axis stays.
///
/// Cost of a sample: 6 floating-point operations; of a tick: some 60 and 2 divisions.
class MeasuredVertical {
 public:
  static constexpr std::size_t kSummedAxes = 4;  ///< x, y, z of the sensor, and the vertical

  struct State {
    Direction up{0.0F, 0.0F, 1.0F};  ///< newest one
    Direction mean_of_stops{};       ///< mean direction at the stops before this one, unit
    std::uint16_t rest_ticks = 0;    ///< ticks of this stop that `up` is the mean of
    std::uint8_t stops = 0;          ///< stops before this one, at most kMostStops
    bool is_measured = false;

    constexpr bool operator==(const State&) const = default;
  };

  constexpr explicit MeasuredVertical(const std::optional<UpAxis>& given) : given_(given) {
    if (given) state_.up = given->direction();
  }
  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// True if a restored state is valid.
  [[nodiscard]] static bool is_possible(const State& state) {
    return is_unit(state.up) && (state.stops == 0 || is_unit(state.mean_of_stops)) &&
           state.stops <= kMostStops && is_bool(state.is_measured);
  }

  [[nodiscard]] constexpr bool is_known() const { return state_.is_measured || given_.has_value(); }
  [[nodiscard]] constexpr const Direction& up() const { return state_.up; }
  /// Angle between the vertical and its mean over the stops before: the slope of a parking place,
  /// or of the road. None before the second stop.
  [[nodiscard]] constexpr std::optional<Angle> slope() const {
    if (!state_.is_measured || state_.stops == 0) return std::nullopt;
    Direction chord{};
    for (std::size_t i = 0; i < 3; ++i) chord[i] = state_.up[i] - state_.mean_of_stops[i];
    return rad(square_root(dot(chord, chord)));
  }
  [[nodiscard]] static constexpr std::size_t axis() { return kVertical; }
  [[nodiscard]] static constexpr float sense() { return 1.0F; }

  template <class Use>
  constexpr void for_each_share(Use use) const {
    for (std::size_t i = 0; i < 3; ++i) use(i, state_.up[i]);
  }
  template <class Of>
  [[nodiscard]] constexpr float variance(Of of) const {
    float sum = 0.0F;
    for (std::size_t i = 0; i < 3; ++i) {
      const float share = state_.up[i];
      // A share of zero of what is unknown is zero.
      if (share != 0.0F) sum += share * share * of(i);
    }
    return sum;
  }
  /// Fills in what is summed about the vertical, where the axes of the sensor stand before it. The
  /// turn is lost with that of any axis, and the bias is at most as uncertain as that of the worst.
  /// @param sample a TurnSum::Sample
  constexpr void complete(auto& sample) const {
    constexpr std::uint8_t kVerticalBit = 1U << kVertical;
    const auto& rate = sample.rate_rad_s;
    const auto& sigma = sample.bias_sigma_rad_s;
    sample.rate_rad_s[kVertical] = dot(state_.up, {rate[0], rate[1], rate[2]});
    sample.bias_sigma_rad_s[kVertical] = std::max({sigma[0], sigma[1], sigma[2]});
    if (sample.saturated_axes != 0) sample.saturated_axes |= kVerticalBit;
  }
  constexpr void complete_variances(auto& variances) const {
    variances[kVertical] = variance([&](std::size_t i) { return variances[i]; });
  }

  /// Time passed in which the sensor may have been turned: the next force counts alone.
  constexpr void lose() {
    state_.is_measured = false;
    state_.rest_ticks = 0;
    if (given_) state_.up = given_->direction();
  }
  /// The sensor turned by a small angle: a rotation by Cayley's formula, which keeps the length. A
  /// given axis that nothing has measured stays.
  constexpr void turn(const Direction& turn_rad) {
    if (!state_.is_measured) return;
    const Direction half{0.5F * turn_rad[0], 0.5F * turn_rad[1], 0.5F * turn_rad[2]};
    const Direction first = cross(state_.up, half);
    const Direction second = cross(first, half);
    const float share = 2.0F / (1.0F + dot(half, half));
    for (std::size_t i = 0; i < 3; ++i) state_.up[i] += share * (first[i] + second[i]);
  }
  /// A tick is over.
  /// @param force_g mean specific force of the tick; nullptr: not measured
  /// @param vertical_rate_rad_s rate about the vertical in the tick
  constexpr void close_tick(const Direction* force_g, bool rests, float vertical_rate_rad_s,
                            Duration tick) {
    if (!rests) end_stop();
    if (force_g != nullptr) take(*force_g, rests, vertical_rate_rad_s, tick.in_seconds());
    state_.up = unit(state_.up);
  }

 private:
  static constexpr std::size_t kVertical = 3;
  static constexpr std::uint8_t kMostStops = 32;       ///< stops of the mean, later ones count more
  static constexpr std::uint16_t kMostRestTicks = 64;  ///< ticks of a mean at rest, likewise
  static constexpr float kMostOff_g = 0.1F;  ///< largest deviation of the force at rest from 1 g
  static constexpr float kMostOffInMotion_g = 0.02F;

  [[nodiscard]] static constexpr float dot(const Direction& a, const Direction& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  [[nodiscard]] static constexpr Direction unit(Direction one) {
    const float length = square_root(dot(one, one));
    for (float& part : one) part /= length;
    return one;
  }
  [[nodiscard]] static bool is_unit(const Direction& one) {
    constexpr float kRounding = 1e-3F;
    const float square = dot(one, one);
    return square >= 1.0F - kRounding && square <= 1.0F + kRounding;
  }
  [[nodiscard]] static constexpr Direction cross(const Direction& a, const Direction& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  /// Moves the vertical towards a direction, by a share of the way.
  static constexpr void approach(Direction& from, const Direction& to, float share) {
    for (std::size_t i = 0; i < 3; ++i) from[i] += share * (to[i] - from[i]);
  }

  constexpr void take(const Direction& force_g, bool rests, float vertical_rate_rad_s,
                      float tick_s) {
    const float length_g = square_root(dot(force_g, force_g));
    const float off_g = length_g < 1.0F ? 1.0F - length_g : length_g - 1.0F;
    if (!(off_g <= kMostOff_g)) return;
    const Direction force = unit(force_g);
    constexpr float kCosineOf45Deg = 0.70710678F;
    if (given_ && dot(force, given_->direction()) < kCosineOf45Deg) return;
    if (!state_.is_measured) {
      state_.up = force;
      state_.is_measured = true;
    } else if (rests) {
      if (state_.rest_ticks < kMostRestTicks) ++state_.rest_ticks;
      approach(state_.up, force, 1.0F / static_cast<float>(state_.rest_ticks));
    } else if (is_straight(vertical_rate_rad_s) && off_g <= kMostOffInMotion_g) {
      constexpr float kTimeConstant_s = 60.0F;
      approach(state_.up, force, std::min(tick_s / kTimeConstant_s, 1.0F));
    }
  }
  [[nodiscard]] static constexpr bool is_straight(float vertical_rate_rad_s) {
    constexpr float kMost_rad_s = 2.0F * kRadPerDeg;
    return vertical_rate_rad_s < kMost_rad_s && -vertical_rate_rad_s < kMost_rad_s;
  }
  constexpr void end_stop() {
    if (state_.rest_ticks == 0) return;
    state_.rest_ticks = 0;
    if (state_.stops < kMostStops) ++state_.stops;
    if (state_.stops == 1) state_.mean_of_stops = state_.up;
    approach(state_.mean_of_stops, state_.up, 1.0F / static_cast<float>(state_.stops));
    state_.mean_of_stops = unit(state_.mean_of_stops);
  }

  std::optional<UpAxis> given_;
  State state_{};
};

}  // namespace zerorate::core
