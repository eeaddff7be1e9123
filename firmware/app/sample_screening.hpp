/// @file
/// Single samples of all axes: which are possible, and which may be learnt from.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/compile_time.hpp"
#include "core/base/numeric.hpp"
#include "core/base/units.hpp"
#include "core/estimator/prediction.hpp"
#include "core/samples/sample_model.hpp"
#include "core/samples/sample_screen.hpp"

namespace zerorate::app {

/// False for what is not finite, and beyond what anything can measure that turns: its square would
/// not be finite either. In bits, which are in the order of the magnitudes, for processors without
/// floating point.
[[nodiscard]] constexpr bool is_possible(core::AngularRate rate) {
  constexpr float kLargest_rad_s = 1e6F;
  return (std::bit_cast<std::uint32_t>(rate.in(core::rad_per_s)) & 0x7FFF'FFFFU) <=
         std::bit_cast<std::uint32_t>(kLargest_rad_s);
}

/// In a node without room for it: nothing is looked at, every sample may be learnt from.
template <std::size_t Axes, bool HasRoom>
class SampleScreening {
 public:
  struct Squares {
    constexpr bool operator==(const Squares&) const = default;
  };
  struct State {
    constexpr bool operator==(const State&) const = default;
  };

  constexpr explicit SampleScreening(const core::SampleModel& /*model*/) {}
  [[nodiscard]] constexpr State state() const { return {}; }
  constexpr void restore(const State& /*state*/) {}
  [[nodiscard]] static constexpr bool is_possible(const State& /*state*/) { return true; }
  [[nodiscard]] static constexpr bool is_possible(const Squares& /*squares*/) { return true; }
  constexpr void end_stop() {}
  constexpr void begin_tick(const std::array<core::Prediction, Axes>& /*predicted*/,
                            float /*white_variance*/, float /*measurement_floor_variance*/) {}
  [[nodiscard]] constexpr bool take(const std::array<float, Axes>& /*rate_rad_s*/) { return true; }
  [[nodiscard]] constexpr bool is_saturated(
      const std::array<core::AngularRate, Axes>& /*rate*/) const {
    return false;
  }
  [[nodiscard]] constexpr bool is_disturbed() const { return false; }
  [[nodiscard]] constexpr Squares squares() const { return {}; }
};

/// In a node with room for it, as long as the model asks for it.
template <std::size_t Axes>
class SampleScreening<Axes, true> {
 public:
  /// Squares of the samples of a tick that were learnt from; see
  /// core::SampleScreen::squares_rad2_s2().
  struct Squares {
    std::array<float, Axes> rad2_s2{};

    constexpr bool operator==(const Squares&) const = default;
  };
  struct State {
    bool disturbed = false;
    std::array<core::SampleScreen::State, Axes> screens;

    constexpr bool operator==(const State&) const = default;
  };

  constexpr explicit SampleScreening(const core::SampleModel& model)
      : model_(&model), screens_(core::filled_array<Axes>(core::SampleScreen{model})) {}
  [[nodiscard]] constexpr State state() const {
    State state{.disturbed = disturbed_, .screens = {}};
    for (std::size_t i = 0; i < Axes; ++i) state.screens[i] = screens_[i].state();
    return state;
  }
  constexpr void restore(const State& state) {
    disturbed_ = state.disturbed;
    for (std::size_t i = 0; i < Axes; ++i) screens_[i].restore(state.screens[i]);
  }

  /// Whether memory from outside may be such a state.
  [[nodiscard]] static bool is_possible(const State& state) {
    bool are_possible = core::is_bool(state.disturbed);
    for (const auto& screen : state.screens) {
      are_possible = are_possible && core::SampleScreen::is_possible(screen);
    }
    return are_possible;
  }
  /// Likewise for what a tick holds.
  [[nodiscard]] static constexpr bool is_possible(const Squares& squares) {
    return core::are_plausible_variances(squares.rad2_s2);
  }

  /// The vehicle moves.
  constexpr void end_stop() {
    for (core::SampleScreen& screen : screens_) screen.end_stop();
    disturbed_ = false;
  }

  /// A tick begins, for which this is predicted.
  /// @param white_variance variance of a sample
  constexpr void begin_tick(const std::array<core::Prediction, Axes>& predicted,
                            float white_variance, float measurement_floor_variance) {
    if (!model_->needs_screen()) return;
    for (std::size_t i = 0; i < Axes; ++i) {
      screens_[i].begin_tick(predicted[i].bias_rad_s,
                             predicted[i].variance_rad2_s2 + measurement_floor_variance,
                             white_variance);
    }
  }

  /// The next sample. Whether it may be learnt from, on all axes: what shakes one shakes the
  /// others.
  [[nodiscard]] constexpr bool take(const std::array<float, Axes>& rate_rad_s) {
    disturbed_ = false;
    if (!model_->needs_screen()) return true;
    for (std::size_t i = 0; i < Axes; ++i) disturbed_ |= !screens_[i].take(rate_rad_s[i]);
    return !disturbed_;
  }

  /// Whether an axis is at an end of its range: what it tells is learnt from, for the noise of the
  /// model is that of what it tells.
  [[nodiscard]] constexpr bool is_saturated(const std::array<core::AngularRate, Axes>& rate) const {
    bool is_saturated = false;
    for (const core::AngularRate one : rate) {
      is_saturated |= model_->range.is_saturated(one.in(core::rad_per_s));
    }
    return is_saturated;
  }
  [[nodiscard]] constexpr const core::SampleScreen& screen(std::size_t axis) const {
    return screens_[axis];
  }
  /// Whether the newest sample was not learnt from.
  [[nodiscard]] constexpr bool is_disturbed() const { return disturbed_; }

  [[nodiscard]] constexpr Squares squares() const {
    Squares squares;
    for (std::size_t i = 0; i < Axes; ++i) squares.rad2_s2[i] = screens_[i].squares_rad2_s2();
    return squares;
  }

 private:
  const core::SampleModel* model_;
  std::array<core::SampleScreen, Axes> screens_;
  bool disturbed_ = false;
};

}  // namespace zerorate::app
