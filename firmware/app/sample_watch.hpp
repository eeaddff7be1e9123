/// @file
/// A watch on the samples of a gyro for axes that no longer measure.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/common/gyro_source.hpp"

namespace zerorate::app {

/// Finds axes whose samples repeat themselves: at any rate, at full scale, at zero, or as a ramp of
/// equal steps. docs/design/sample-watch.md says what distinguishes them from quiet ones.
///
/// An axis is at fault after one second and more of repetition, if one of these holds:
/// - Noise would end the repetition, but for one case in 10^12. The noise is what the axis has
///   shown at rest (else the other axes, else half of the model's after ten seconds), and at most
///   half of the model's. A sensor with noise far below one step repeats itself for ever by this
///   rule.
/// - The other axes turned so far meanwhile that their product is 1024 squared steps: no axis is
///   aligned so well that it would not turn with them by one step.
/// - All axes repeat themselves for ten seconds while the vehicle drives.
/// - The axis is at full scale for ten seconds.
///
/// No heap, one thread. Some 30 floating-point operations a sample, all of them cheap.
class SampleWatch {
 public:
  static constexpr std::size_t kAxes = 3;

  /// State by the odometer; unknown where there is none or where it fails.
  enum class Vehicle : std::uint8_t { unknown, stands, drives };

  /// @param white_variance_rad2_s2  of a sample, by the model
  /// @param sample_period  nominal
  constexpr SampleWatch(float white_variance_rad2_s2, core::Duration sample_period)
      : white_variance_(white_variance_rad2_s2),
        per_second_(static_cast<std::uint32_t>(
            std::max<std::int64_t>(core::Duration::seconds(1) / sample_period, 1))) {}

  /// Sets the rate of one count; zero: unknown, the least difference between two samples stands for
  /// it.
  constexpr void set_step(core::AngularRate step) {
    const float known = step.in(core::rad_per_s);
    if (known > 0.0F) step_ = known;
  }

  /// Takes each sample in turn. An axis at fault stays so, over restarts of the chip too, until its
  /// samples no longer repeat themselves.
  /// @return bit i: axis i is at fault
  /// Not inlined, as its parts: a board counts bytes.
  [[gnu::noinline]] constexpr std::uint8_t take(const drivers::GyroSample& sample,
                                                Vehicle vehicle) {
    std::array<float, kAxes> rates{};
    for (std::size_t i = 0; i < kAxes; ++i) rates[i] = sample.rate[i].in(core::rad_per_s);
    for (std::size_t i = 0; i < kAxes; ++i) {
      const bool is_saturated = ((sample.saturated_axes >> i) & 1U) != 0;
      compare(axes_[i], rates, i, is_saturated);
    }
    const bool stands = vehicle == Vehicle::stands;
    for (Axis& axis : axes_) watch_rest(axis, stands);
    in_window_ = stands ? (in_window_ + 1) % kWindow : 0;
    std::uint8_t at_fault = 0;
    for (std::size_t i = 0; i < kAxes; ++i) {
      if (is_at_fault(i, vehicle)) at_fault |= static_cast<std::uint8_t>(1U << i);
    }
    return at_fault;
  }

 private:
  static constexpr std::uint32_t kWindow = 128;  ///< samples
  static constexpr float kUnknown = std::numeric_limits<float>::infinity();

  struct Axis {
    float newest = 0.0F;
    float difference = 0.0F;              ///< from the sample before
    std::uint32_t alike = 0;              ///< samples of the present repetition
    bool is_saturated = false;            ///< the newest sample
    std::array<float, kAxes> at_begin{};  ///< rates of all axes when the repetition began
    float lowest = 0.0F;                  ///< sum of the present window at rest
    float highest = 0.0F;
    std::uint32_t changes = 0;
    float least_span = kUnknown;  ///< sum of all windows at rest
  };

  [[gnu::noinline]] constexpr void compare(Axis& axis, const std::array<float, kAxes>& rates,
                                           std::size_t i, bool is_saturated) {
    const float difference = rates[i] - axis.newest;
    // Counts times the rate of one count: three roundings.
    const float rounding = 2e-6F * (magnitude(rates[i]) + magnitude(axis.newest));
    const bool repeats =
        magnitude(difference - axis.difference) <= rounding || (is_saturated && axis.is_saturated);
    const bool is_first = axis.alike == 0;
    if (repeats && !is_first) {
      axis.alike += axis.alike < std::numeric_limits<std::uint32_t>::max() ? 1U : 0U;
    } else {
      axis.alike = 1;
      axis.at_begin = rates;
    }
    if (!is_first) {
      axis.difference = difference;
      if (magnitude(difference) > rounding) {
        ++axis.changes;
        if (!is_saturated) least_difference_ = std::min(least_difference_, magnitude(difference));
      }
    }
    axis.newest = rates[i];
    axis.is_saturated = is_saturated;
  }

  /// Spans of the noise over windows at rest. A window with few changes shows none: the axis may be
  /// frozen.
  [[gnu::noinline]] constexpr void watch_rest(Axis& axis, bool stands) const {
    constexpr std::uint32_t kFewestChanges = 16;
    const bool begins = !stands || in_window_ == 0;
    if (begins) {
      axis.changes = 0;
      axis.lowest = axis.newest;
      axis.highest = axis.newest;
    }
    axis.lowest = std::min(axis.lowest, axis.newest);
    axis.highest = std::max(axis.highest, axis.newest);
    const bool is_full = stands && in_window_ + 1 == kWindow;
    if (is_full && axis.changes >= kFewestChanges) {
      axis.least_span = std::min(axis.least_span, axis.highest - axis.lowest);
    }
  }

  [[gnu::noinline]] [[nodiscard]] constexpr bool is_at_fault(std::size_t i, Vehicle vehicle) const {
    constexpr std::uint32_t kLong_s = 10;
    const Axis& axis = axes_[i];
    if (axis.alike < per_second_) return false;
    if (axis.is_saturated) return axis.alike >= kLong_s * per_second_;
    return axis.alike >= longest_by_noise(i) || have_others_turned(i) ||
           (vehicle == Vehicle::drives && do_all_repeat(kLong_s * per_second_));
  }

  /// Samples in a row that noise makes alike once in 10^12, where the rate lies in the middle
  /// between two borders of counts: there a value returns with the probability
  /// erf(step / (2 sqrt(2) sigma)).
  struct Longest {
    float sigma_in_steps;
    std::uint32_t samples;
  };
  static constexpr std::array<Longest, 8> kLongest{{{0.15F, 32186},
                                                    {0.2F, 2211},
                                                    {0.25F, 594},
                                                    {0.3F, 276},
                                                    {0.4F, 117},
                                                    {0.5F, 73},
                                                    {0.7F, 43},
                                                    {1.0F, 29}}};

  [[nodiscard]] constexpr std::uint32_t longest_by_noise(std::size_t i) const {
    constexpr std::uint32_t kUnseen_s = 10;
    constexpr float kSpanInSigmas = 6.0F;  // changes of a window: 5.2 is expected
    const float step = step_ > 0.0F ? step_ : least_difference_;
    // The flips between two counts at their border have this variance without any noise.
    const float of_flips = 0.25F * step * step;
    const float by_model = 0.5F * core::square_root(std::max(white_variance_ - of_flips, 0.0F));
    const float span = span_at_rest(i);
    const bool is_seen = span < kUnknown;
    const float sigma = is_seen ? std::min(by_model, (span - step) / kSpanInSigmas) : by_model;
    std::uint32_t longest = std::numeric_limits<std::uint32_t>::max();
    for (const Longest& entry : kLongest) {
      if (sigma >= entry.sigma_in_steps * step) longest = entry.samples;
    }
    return is_seen ? longest : std::max(longest, kUnseen_s * per_second_);
  }
  /// Span of this axis; of the quietest other one where this one has shown none.
  [[nodiscard]] constexpr float span_at_rest(std::size_t i) const {
    float span = axes_[i].least_span;
    if (span < kUnknown) return span;
    for (const Axis& axis : axes_) span = std::min(span, axis.least_span);
    return span;
  }

  [[nodiscard]] constexpr bool have_others_turned(std::size_t i) const {
    constexpr float kSquaredSteps = 1024.0F;
    const float step = step_ > 0.0F ? step_ : least_difference_;
    if (!(step < kUnknown)) return false;
    float product = 1.0F;
    for (std::size_t other = 0; other < kAxes; ++other) {
      if (other == i) continue;
      product *= 1.0F + magnitude(axes_[other].newest - axes_[i].at_begin[other]) / step;
    }
    return product > kSquaredSteps;
  }
  [[nodiscard]] constexpr bool do_all_repeat(std::uint32_t samples) const {
    return std::all_of(axes_.begin(), axes_.end(),
                       [&](const Axis& axis) { return axis.alike >= samples; });
  }

  static constexpr float magnitude(float x) { return x < 0.0F ? -x : x; }

  float white_variance_;
  std::uint32_t per_second_;
  float step_ = 0.0F;
  float least_difference_ = kUnknown;
  std::uint32_t in_window_ = 0;
  std::array<Axis, kAxes> axes_{};
};

}  // namespace zerorate::app
