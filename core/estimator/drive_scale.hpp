/// @file
/// Scale of the bias's movement between stops over its prediction.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/numeric.hpp"
#include "core/estimator/prediction.hpp"

namespace zerorate::core {

/// Factor of at least 1 on the variances that a learning bank predicts for a drive, by maximum
/// likelihood in fixed memory (docs/design/learning.md, section 5). The estimate itself may be
/// below 1. Otherwise chance alone would widen the interval of a sensor that fits its model.
///
/// The innovations within a stop are many and depend on the white noise. Those between stops are
/// few and show whether the interval of a drive holds: a sensor outside the family shows in these
/// alone. A stop resolves the share f of the variance v and moves the estimate of an axis by d,
/// with the variance s f v. The logarithm of s follows the score f (d^2 / (s f v) - 1) / 2 over the
/// information gathered, f^2 / 2. A stop too short for any information has f near 0. Of the
/// variance of a bias that follows inputs, s is a factor of the share n of the noise alone: then f
/// n stands in the place of f, and s n + 1 - n in that of s.
///
/// Cost of a stop: 20 times the mixture's, and some 40 floating-point operations and 6 divisions.
template <class Bank>
class DriveScale {
 public:
  static constexpr std::size_t kHypotheses = Bank::kHypotheses;
  static constexpr std::size_t kAxes = Bank::kAxes;
  using Biases = std::array<Prediction, kAxes>;
  using Variances = std::array<float, kHypotheses>;
  using BankState = typename Bank::State;
  using Transition = typename Bank::Transition;
  static constexpr bool kHasInputs = Bank::Coefficients::kInputs > 0;
  /// Place of the shares where all variance is noise.
  struct AllNoise {
    constexpr bool operator==(const AllNoise&) const = default;
    constexpr float operator[](std::size_t /*axis*/) const { return 1.0F; }
  };
  using NoiseShares = std::conditional_t<kHasInputs, std::array<float, kAxes>, AllNoise>;

  /// Part of the state that is saved while the power is off.
  struct Memory {
    float scale = 1.0F;                     ///< estimate
    float information = kPriorInformation;  ///< about the logarithm of the scale

    constexpr bool operator==(const Memory&) const = default;
  };
  struct State {
    Memory memory;
    Biases before{};                                  ///< predicted when the stop began
    [[no_unique_address]] NoiseShares noise_share{};  ///< n of each axis
    Variances variances_before{};                     ///< variance by each hypothesis, at scale 1
    std::uint8_t ticks_left = 0;  ///< ticks until the stop is judged; 0: no stop

    constexpr bool operator==(const State&) const = default;
  };
  static_assert(std::is_trivially_copyable_v<State>);

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  constexpr void restore(const Memory& memory) { state_ = {.memory = memory}; }
  [[nodiscard]] constexpr float scale() const { return std::max(state_.memory.scale, 1.0F); }

  /// True if a restored memory or state is valid.
  [[nodiscard]] static constexpr bool is_possible(const Memory& memory) {
    return memory.scale >= kLeast && is_plausible(memory.scale) &&
           memory.information >= kPriorInformation && memory.information <= kMostInformation;
  }
  [[nodiscard]] static constexpr bool is_possible(const State& state) {
    bool are_possible =
        is_possible(state.memory) && are_plausible_variances(state.variances_before);
    for (const Prediction& before : state.before) {
      are_possible =
          are_possible && is_plausible_rate(before.bias_rad_s) && before.variance_rad2_s2 >= 0.0F;
    }
    if constexpr (kHasInputs) {
      for (const float share : state.noise_share) {
        are_possible = are_possible && share >= 0.0F && share <= 1.0F;
      }
    }
    return are_possible;
  }

  /// Whether the bias moves more than predicted, beyond chance.
  [[nodiscard]] constexpr bool is_exceeded() const {
    const float excess = scale() / kWorrying - 1.0F;
    return excess > 0.0F && excess * excess * state_.memory.information > kDeviations * kDeviations;
  }

  /// Begins a stop with these predicted biases.
  /// @param span from the measurement before
  constexpr void begin_stop(const BankState& bank, [[maybe_unused]] const Transition& span) {
    state_.before = bank.newest();
    if constexpr (kHasInputs) find_noise_shares(bank, span);
    for (std::size_t m = 0; m < kHypotheses; ++m) {
      state_.variances_before[m] = bank.filters[m].bias_variance;
    }
    state_.ticks_left = kTicks;
  }
  /// Counts a tick of the stop that was learnt from. The drift of a long stop is no measure of the
  /// drive.
  constexpr void on_tick(const BankState& bank) {
    if (state_.ticks_left == 1) {
      end_stop(bank);
    } else if (state_.ticks_left > 0) {
      --state_.ticks_left;
    }
  }
  /// Ends the stop and learns from it, if on_tick() has not.
  constexpr void end_stop(const BankState& bank) {
    if (state_.ticks_left == 0) return;
    state_.ticks_left = 0;
    float score = 0.0F;
    float information = 0.0F;
    const Biases after = bank.newest();
    for (std::size_t i = 0; i < kAxes; ++i) {
      const float moved = after[i].bias_rad_s - state_.before[i].bias_rad_s;
      const float share = share_resolved(bank, i);
      const float resolved = share * state_.before[i].variance_rad2_s2;
      // An axis without noise does not exist in the sensor.
      if (!is_finite_positive(resolved) || moved == 0.0F) continue;
      const float noise = state_.noise_share[i];
      const float scale = state_.memory.scale * noise + (1.0F - noise);
      const float surprise = std::min(moved * moved / (scale * resolved), kLargest);
      score += 0.5F * share * noise * (surprise - 1.0F);
      information += 0.5F * share * noise * share * noise;
    }
    Memory& memory = state_.memory;
    memory.information = std::min(memory.information + information, kMostInformation);
    memory.scale *= 1.0F + std::clamp(score / memory.information, kLargestFall, kLargestRise);
    memory.scale = std::max(memory.scale, kLeast);
  }

 private:
  /// Factor of a filter's variance in that of the mixture.
  [[nodiscard]] static constexpr float level_of(const BankState& bank, std::size_t m,
                                                std::size_t axis) {
    return bank.evidence.hypotheses[m][axis].weight * bank.evidence.mean_scale(m, axis);
  }
  /// Share of the variance that the stop has resolved, under the present hypotheses and scales: a
  /// scale that was learnt in between is no information on the bias.
  [[nodiscard]] constexpr float share_resolved(const BankState& bank, std::size_t axis) const {
    float before = 0.0F;
    float after = 0.0F;
    for (std::size_t m = 0; m < kHypotheses; ++m) {
      const float level = level_of(bank, m, axis);
      before += level * state_.variances_before[m];
      after += level * bank.filters[m].bias_variance;
    }
    return 1.0F - after / before;
  }
  /// Shares of the variance before the stop that are not the doubt in coefficients of inputs.
  constexpr void find_noise_shares(const BankState& bank, const Transition& span) {
    state_.noise_share.fill(1.0F);
    if (!span.inputs.has_changed()) return;
    Variances of_inputs{};
    for (std::size_t m = 0; m < kHypotheses; ++m) {
      of_inputs[m] = bank.filters[m].input_variance(span);
    }
    for (std::size_t i = 0; i < kAxes; ++i) {
      float doubt = 0.0F;
      float all = 0.0F;
      for (std::size_t m = 0; m < kHypotheses; ++m) {
        const float level = level_of(bank, m, i);
        doubt += level * of_inputs[m];
        all += level * bank.filters[m].bias_variance;
      }
      state_.noise_share[i] = std::clamp(1.0F - doubt / all, 0.0F, 1.0F);
    }
  }
  /// Least estimate: from here it soon exceeds 1 if the sensor grows noisier.
  static constexpr float kLeast = 0.1F;
  static constexpr float kPriorInformation = 6.0F;  ///< a factor of 1.5 either way
  static constexpr float kMostInformation = 30.0F;  ///< memory of some twenty stops
  static constexpr std::uint8_t kTicks = 20;
  static constexpr float kLargest = 16.0F;  ///< one stop that went wrong is not the noise
  static constexpr float kLargestRise = 3.0F;
  static constexpr float kLargestFall = -0.5F;
  /// Factor of the variance above which the sensor does not fit the model at all.
  static constexpr float kWorrying = 2.0F;
  static constexpr float kDeviations = 3.0F;

  State state_{};
};

}  // namespace zerorate::core
