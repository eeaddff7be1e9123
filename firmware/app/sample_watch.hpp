/// @file
/// A watch on the samples of a gyro for axes that no longer measure.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "core/samples/gyro_sample.hpp"
#include "core/standstill/standstill.hpp"

namespace zerorate::app {

/// State of the vehicle by the odometer; unknown where there is none or where it fails.
enum class VehicleState : std::uint8_t { unknown, stands, drives };

/// A vehicle that only counts as moving is not known to drive.
/// @param driven_at  newest pulse
[[nodiscard]] constexpr VehicleState vehicle_state(core::Motion motion,
                                                   const std::optional<core::Instant>& driven_at,
                                                   core::Instant now) {
  if (motion == core::Motion::still) return VehicleState::stands;
  const bool is_driven = driven_at && now - *driven_at < core::Duration::seconds(1);
  return is_driven ? VehicleState::drives : VehicleState::unknown;
}

/// Finds axes whose samples repeat themselves: at any rate, at full scale, at zero, or as a ramp of
/// equal steps. docs/design/sample-watch.md says what distinguishes them from quiet ones.
///
/// An axis is at fault after a repetition of one second and eight samples at least, under any of:
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
/// @tparam Axes  watched axes, the first of a sample; 36 bytes each
template <std::size_t Axes = 3>
class SampleWatch {
 public:
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
    if (!(known > 0.0F)) return;
    step_ = known;
    step_is_known_ = true;
  }

  /// Takes each sample in turn. An axis at fault stays so, over restarts of the chip too, until its
  /// samples no longer repeat themselves.
  /// @return bit i: axis i is at fault
  /// Not inlined, as its parts: a board counts bytes.
  [[gnu::noinline]] constexpr std::uint8_t take(const core::GyroSample& sample,
                                                VehicleState vehicle) {
    Rates rates{};
    for (std::size_t i = 0; i < Axes; ++i) rates[i] = sample.rate[i].in(core::rad_per_s);
    for (std::size_t i = 0; i < Axes; ++i) {
      const bool is_saturated = ((sample.saturated_axes >> i) & 1U) != 0;
      compare(axes_[i], rates, i, is_saturated);
    }
    const bool stands = vehicle == VehicleState::stands;
    for (Axis& axis : axes_) watch_rest(axis, stands);
    in_window_ = stands ? static_cast<std::uint8_t>((in_window_ + 1U) % kWindow) : std::uint8_t{0};
    std::uint8_t at_fault = 0;
    for (std::size_t i = 0; i < Axes; ++i) {
      if (is_at_fault(i, vehicle)) at_fault |= static_cast<std::uint8_t>(1U << i);
    }
    return at_fault;
  }

 private:
  using Rates = std::array<float, Axes>;

  static constexpr std::uint8_t kWindow = 128;  ///< samples
  static constexpr float kUnknown = std::numeric_limits<float>::infinity();

  struct Axis {
    float newest = 0.0F;
    float difference = 0.0F;  ///< from the sample before
    std::uint32_t alike = 0;  ///< samples of the present repetition
    std::array<float, Axes - 1>
        others_at_begin{};  ///< rates of the other axes when the repetition began
    float lowest = 0.0F;    ///< sum of the present window at rest
    float highest = 0.0F;
    float least_span = kUnknown;  ///< sum of all windows at rest
    std::uint8_t changes = 0;     ///< changes in the present window
    bool is_saturated = false;    ///< the newest sample
  };

  /// The k-th of the axes besides i.
  static constexpr std::size_t other(std::size_t i, std::size_t k) { return k < i ? k : k + 1; }

  [[gnu::noinline]] constexpr void compare(Axis& axis, const Rates& rates, std::size_t i,
                                           bool is_saturated) {
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
      for (std::size_t k = 0; k + 1 < Axes; ++k) axis.others_at_begin[k] = rates[other(i, k)];
    }
    if (!is_first) axis.difference = difference;
    const bool changes = !is_first && magnitude(difference) > rounding;
    if (changes) ++axis.changes;
    if (changes && !is_saturated && !step_is_known_) step_ = std::min(step_, magnitude(difference));
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
    const bool is_full = stands && in_window_ + 1U == kWindow;
    if (is_full && axis.changes >= kFewestChanges) {
      axis.least_span = std::min(axis.least_span, axis.highest - axis.lowest);
    }
  }

  [[gnu::noinline]] [[nodiscard]] constexpr bool is_at_fault(std::size_t i,
                                                             VehicleState vehicle) const {
    constexpr std::uint32_t kLong_s = 10;
    // Two changes in a row are equal by chance once in a while.
    constexpr std::uint32_t kFewest = 8;
    const Axis& axis = axes_[i];
    if (axis.alike < std::max(per_second_, kFewest)) return false;
    if (axis.is_saturated) return axis.alike >= kLong_s * per_second_;
    return axis.alike >= longest_by_noise(i) || have_others_turned(i) ||
           (vehicle == VehicleState::drives && do_all_repeat(kLong_s * per_second_));
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
    // The flips between two counts at their border have this variance without any noise.
    const float of_flips = 0.25F * step_ * step_;
    const float by_model = 0.5F * core::square_root(std::max(white_variance_ - of_flips, 0.0F));
    const float span = span_at_rest(i);
    const bool is_seen = span < kUnknown;
    const float sigma = is_seen ? std::min(by_model, (span - step_) / kSpanInSigmas) : by_model;
    std::uint32_t longest = std::numeric_limits<std::uint32_t>::max();
    for (const Longest& entry : kLongest) {
      if (sigma >= entry.sigma_in_steps * step_) longest = entry.samples;
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
    if (!(step_ < kUnknown)) return false;
    float product = 1.0F;
    for (std::size_t k = 0; k + 1 < Axes; ++k) {
      const float now = axes_[other(i, k)].newest;
      product *= 1.0F + magnitude(now - axes_[i].others_at_begin[k]) / step_;
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
  float step_ = kUnknown;  ///< rate of one count; unknown: the least difference so far
  std::array<Axis, Axes> axes_{};
  std::uint8_t in_window_ = 0;
  bool step_is_known_ = false;
};

/// Looks at a sample before a node takes it. If an axis is at fault, the node forgets the present
/// stop and goes on without the sample.
/// @param driven_at  newest pulse
/// @param measured  bit i: axis i is measured
/// @return bit i: axis i is at fault
template <std::size_t Axes>
constexpr std::uint8_t watch_before(auto& node, SampleWatch<Axes>& watch,
                                    const core::GyroSample& sample,
                                    const std::optional<core::Instant>& driven_at,
                                    core::Instant now, unsigned measured = ~0U) {
  const auto vehicle = vehicle_state(node.motion(), driven_at, now);
  const auto at_fault = static_cast<std::uint8_t>(watch.take(sample, vehicle) & measured);
  if (at_fault != 0) node.discard_stop(sample.time);
  return at_fault;
}

}  // namespace zerorate::app
