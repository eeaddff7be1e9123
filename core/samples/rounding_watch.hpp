/// @file
/// Error that the rounding of samples leaves in a bias, however many of them are averaged.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/base/numeric.hpp"

namespace zerorate::core {

/// Variance of the mean error of a quantizer, over all places of the rate within a step. Noise of a
/// sample makes it small: at the place x the mean error is the sum over k of
/// step / (pi k) exp(-2 (pi k sigma / step)^2) sin(2 pi k x / step), which is squared here and
/// averaged over x. Without noise it is step^2 / 12, with noise of a step 10^-18 of that.
[[nodiscard]] constexpr float rounding_variance(float step, float noise_variance) {
  constexpr float kPi2 = 9.8696044F;
  constexpr int kHarmonics = 8;
  const float step2 = step * step;
  if (!(noise_variance < step2)) return 0.0F;
  const float damping = 4.0F * kPi2 * noise_variance / step2;
  float sum = 0.0F;
  float damped = 1.0F;
  float rest = 1.0F / 6.0F;  // sum of 1 / (pi k)^2 over the harmonics that are left
  for (int k = 1; k <= kHarmonics; ++k) {
    const auto k2 = static_cast<float>(k * k);
    damped = 1.0F - one_minus_exp_neg(damping * k2);
    sum += damped / (kPi2 * k2);
    rest -= 1.0F / (kPi2 * k2);
  }
  return 0.5F * step2 * (sum + rest * damped);
}

/// Variance of the mean error of samples near zero that were cut toward zero, half a step away from
/// it. The cell of zero is two steps wide, and noise makes its error small as a power only: step^2
/// / 3 without noise; 0.12 step^3 / sigma^2 at most, squared, with much. In between an upper limit.
[[nodiscard]] constexpr float cell_of_zero_variance(float step, float noise_variance) {
  constexpr float kFalloff = 25.0F;
  const float step2 = step * step;
  if (!(step2 > 0.0F)) return 0.0F;
  const float noise = noise_variance / step2;
  return step2 * (1.0F / 3.0F) / (1.0F + kFalloff * noise * noise);
}

/// Rounding of the samples by a model.
struct Rounding {
  float step_rad_s = 0.0F;     ///< step; 0: not known
  float floor_rad2_s2 = 0.0F;  ///< variance of the error of the mean
  bool is_truncation = false;  ///< toward zero, and undone: the cell of zero is two steps wide
};

/// Watches the samples of a gyro for their step, and says how far the mean of rounded samples may
/// lie from the rate (docs/design/sample-model.md).
///
/// The step is the least difference between two neighbouring samples, at rest and while driving. A
/// smaller step counts after eight differences below three quarters of the step before. One flipped
/// bit on the bus makes one or two differences of any size.
///
/// At rest, samples on two neighbouring levels with the variance v have a mean that is
/// m = sqrt(step^2 / 4 - v) from the border between these levels, and the rate lies between the
/// border and the mean: its distance from the mean is between 0 and m, the noise decides where. All
/// of these are taken for equally likely, which makes the variance m^2 / 3. The noise of the model
/// is not relied on: where it is higher than the sensor's it would promise a dither that there is
/// not. Samples that were cut toward zero, half a step away from it, have the levels 0
/// and 1.5 steps with the border at 1 step: there the variance is (step^2 - 1.5 v) / 3.
///
/// Cost of a sample: 6 floating-point operations; of a window: some 20, and 100 more where the step
/// is larger than the noise.
template <std::size_t Axes>
class RoundingWatch {
 public:
  using Rates = std::array<float, Axes>;

  struct State {
    Rates newest_rad_s{};           ///< newest sample
    Rates shown_rad2_s2{};          ///< variance of a sample by differences of neighbours at rest
    Rates variance_rad2_s2{};       ///< variance of the error of the mean
    float well_below_rad_s = 0.0F;  ///< three quarters of the step that was seen; 0: none was
    float smaller_rad_s = 0.0F;     ///< largest of the differences below that
    std::uint16_t differences = 0;  ///< differences that `shown_rad2_s2` is the mean of
    std::uint8_t smaller = 0;       ///< number of the differences below that
    bool has_newest = false;

    constexpr bool operator==(const State&) const = default;
  };

  /// @param white_rad2_s2 white variance of a sample by the model
  constexpr RoundingWatch(const Rounding& model, float white_rad2_s2)
      : model_(model), white_(white_rad2_s2) {
    state_.variance_rad2_s2.fill(model.floor_rad2_s2);
  }

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// True if a restored state is valid.
  [[nodiscard]] static bool is_possible(const State& state) {
    return are_plausible(state.newest_rad_s) && are_plausible_variances(state.shown_rad2_s2) &&
           are_plausible_variances(state.variance_rad2_s2) &&
           is_plausible_variance(state.well_below_rad_s) &&
           is_plausible_variance(state.smaller_rad_s) && state.smaller < kFewestSmaller &&
           is_bool(state.has_newest);
  }

  /// The next sample, whether the vehicle stands or not.
  constexpr void take(const Rates& rate_rad_s) {
    if (state_.has_newest) {
      for (std::size_t i = 0; i < Axes; ++i) take_change(rate_rad_s[i] - state_.newest_rad_s[i]);
    } else {
      estimate_without_rest();
    }
    state_.newest_rad_s = rate_rad_s;
    state_.has_newest = true;
  }

  /// Differences of neighbouring samples in a window at rest.
  /// @param squares sum of their squares on each axis
  constexpr void observe(const Rates& squares, std::uint32_t differences) {
    if (differences == 0) return;
    const std::uint32_t all = state_.differences + differences;
    const std::uint32_t kept = std::min({all, kWindows * differences, std::uint32_t{0xFFFF}});
    state_.differences = static_cast<std::uint16_t>(kept);
    const float gain = 1.0F / static_cast<float>(kept);
    // Two standard deviations of a mean of squares, of which neighbours share a sample.
    const float error = square_root(6.0F * gain);
    const float certain = error < 1.0F ? 1.0F - error : 0.0F;
    const float step = step_rad_s();
    for (std::size_t i = 0; i < Axes; ++i) {
      float& shown = state_.shown_rad2_s2[i];
      shown += gain * (0.5F * squares[i] - static_cast<float>(differences) * shown);
      state_.variance_rad2_s2[i] = variance(step, certain * shown, state_.newest_rad_s[i]);
    }
  }

  /// Step of the samples: the model's or the one that was seen, the larger of them; 0: unknown.
  [[nodiscard]] constexpr float step_rad_s() const {
    return std::max(model_.step_rad_s, state_.well_below_rad_s * (1.0F / kWellBelow));
  }
  /// Variance of the error that averaging leaves in the bias of an axis.
  [[nodiscard]] constexpr float variance_rad2_s2(std::size_t axis) const {
    return state_.variance_rad2_s2[axis];
  }

 private:
  static constexpr std::uint8_t kFewestSmaller = 8;
  static constexpr float kWellBelow = 0.75F;     ///< share of a step; half a step is below it
  static constexpr std::uint32_t kWindows = 64;  ///< memory: half a minute

  /// Before the first window at rest, as after a restart, the noise of the model has to do.
  [[gnu::noinline]] constexpr void estimate_without_rest() {
    if (state_.differences > 0) return;
    const float step = step_rad_s();
    state_.variance_rad2_s2.fill(variance(step, step > 0.0F ? white_ : 0.0F, 0.0F));
  }
  constexpr void take_change(float signed_change) {
    const float change = signed_change < 0.0F ? -signed_change : signed_change;
    // Most changes end here.
    if (state_.well_below_rad_s > 0.0F && change > state_.well_below_rad_s) return;
    if (change == 0.0F) return;
    state_.smaller_rad_s = std::max(state_.smaller_rad_s, change);
    if (++state_.smaller < kFewestSmaller) return;
    state_.well_below_rad_s = kWellBelow * std::exchange(state_.smaller_rad_s, 0.0F);
    state_.smaller = 0;
    estimate_without_rest();
  }
  /// @param newest_rad_s  newest sample of the axis
  [[nodiscard]] constexpr float variance(float step, float shown, float newest_rad_s) const {
    // A sensor that does not change hides its noise in a step, of ten standard deviations at most.
    const float step2 = step > 0.0F ? step * step : 100.0F * white_;
    // Rounding adds less than this to the noise, unless the noise is below a third of a step.
    const float noise = std::max(white_, shown - 0.125F * step2);
    if (model_.is_truncation && newest_rad_s * newest_rad_s < reach2(step2, shown)) {
      return std::max((step2 - 1.5F * shown) * (1.0F / 3.0F), cell_of_zero_variance(step, noise));
    }
    const float by_samples = (0.25F * step2 - shown) * (1.0F / 3.0F);
    return std::max({model_.floor_rad2_s2, by_samples, rounding_variance(step, noise)});
  }
  /// Square of the greatest sample of a rate that reaches into the cell of zero: one step and four
  /// standard deviations.
  [[nodiscard]] static constexpr float reach2(float step2, float shown) {
    return step2 + 16.0F * shown + 8.0F * square_root(step2 * shown);
  }

  Rounding model_;
  float white_;
  State state_{};
};

}  // namespace zerorate::core
