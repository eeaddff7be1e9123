/// @file
/// The paper's cheap predictor: for j ticks ahead the mean of the last j ticks (eq. 8); beyond the
/// length of the stop, the mean of the whole stop (eq. 9).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/numeric.hpp"
#include "core/estimator/prediction.hpp"
#include "core/estimator/suffix_sums.hpp"
#include "core/estimator/weighted_window.hpp"
#include "core/noise/model_shape.hpp"

namespace zerorate::core {

/// Fixed memory for any length of stop; SuffixSums states how near it comes to the exact mean.
/// Cost: observe 2 additions on average, bias one addition per block, at most 328; an interval
/// about 2 log2(count) compositions, a heading interval one composition per block.
/// @tparam Levels of SuffixSums: fewer save memory, and a shorter stop is remembered in full
template <ModelShape Shape, std::size_t Levels = 22>
class MovingAverage {
 public:
  using Coefficients = ModesOf<Shape>;
  using Transition = TransitionOf<Shape>;

  struct State {
    bool restart = true;           ///< the next measurement is the first of a stop
    SuffixSums<Levels> sums;       ///< deviations from the reference
    std::uint32_t age = 0;         ///< ticks from the start to the newest measurement
    float reference_rad_s = 0.0F;  ///< the stop's first measurement
    float white_variance_sum = 0.0F;

    constexpr bool operator==(const State&) const = default;
  };
  static_assert(std::is_trivially_copyable_v<State>);
  static_assert(sizeof(State) <= 1536);

  /// @param modes noise model of the intervals; must outlive the predictor
  constexpr explicit MovingAverage(const ModesOf<Shape>& modes) : modes_(&modes) {}

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// True if a restored state is valid.
  [[nodiscard]] static bool is_possible(const State& state) {
    return is_bool(state.restart) && state.sums.is_possible() &&
           is_plausible_rate(state.reference_rad_s) &&
           is_plausible_variance(state.white_variance_sum);
  }

  /// The next measurement starts a new average; until then the old one stands.
  constexpr void begin_stop() { state_.restart = true; }

  constexpr void advance(const Transition& span) { state_.age += span.ticks; }

  constexpr Innovation observe(float rate_rad_s, float white_variance) {
    if (!is_measurement(rate_rad_s, white_variance)) return {};
    if (state_.restart) {
      state_.sums.clear();
      state_.reference_rad_s = rate_rad_s;
      state_.white_variance_sum = 0.0F;
      state_.restart = false;
    }
    const bool first = state_.sums.count() == 0;
    const Innovation innovation{.accepted = true,
                                .first = first,
                                .residual_rad_s = first ? 0.0F : rate_rad_s - mean_of_newest(1)};
    state_.sums.push(rate_rad_s - state_.reference_rad_s);
    state_.white_variance_sum += white_variance;
    return innovation;
  }

  /// advance() and observe() in one.
  constexpr Innovation step(const Transition& span, float rate_rad_s, float white_variance) {
    advance(span);
    return observe(rate_rad_s, white_variance);
  }

  [[nodiscard]] constexpr float bias_rad_s(const Transition& lead) const {
    return state_.sums.count() == 0 ? 0.0F : mean_of_newest(window_length(lead));
  }

  /// Ticks of the measurements that a prediction averages; 0 before the first.
  [[nodiscard]] constexpr std::uint32_t window(const Transition& lead) const {
    return state_.sums.count() == 0 ? 0 : window_length(lead);
  }
  [[nodiscard]] constexpr Prediction predict(const Transition& lead) const {
    return predict(lead, modes_->over(window(lead)));
  }
  /// @param averaged span of window(lead) ticks
  [[nodiscard]] constexpr Prediction predict(const Transition& lead,
                                             const Transition& averaged) const {
    const std::uint32_t length = window(lead);
    if (length == 0) return {};
    WeightedWindow<Shape> window{*modes_, state_.age - length};
    window.add(averaged, 1.0F / static_cast<float>(length), white_variance());
    return {mean_of_newest(length), window.point_variance(lead)};
  }

  [[nodiscard]] constexpr HeadingPrediction predict_heading(const Transition& lead,
                                                            const Transition& drive) const {
    if (state_.sums.count() == 0) return {};
    const DriveWeights weights{state_.sums, lead.ticks, drive.ticks};
    WeightedWindow<Shape> window{*modes_, state_.age - state_.sums.count()};
    float sum = 0.0F;
    std::uint32_t newer = state_.sums.count();
    Transition segment{};
    state_.sums.for_each_oldest_first([&](std::uint32_t size, float block_sum) {
      newer -= size;
      const float weight = weights.of_block(newer, size);
      if (segment.ticks != size) segment = modes_->over(size);
      window.add(segment, weight, white_variance());
      sum += weight * block_sum;
    });
    const float tick_s = modes_->tick.in_seconds();
    const auto ticks = static_cast<float>(drive.ticks);
    return {(ticks * state_.reference_rad_s + sum) * tick_s,
            window.sum_variance(lead, drive) * tick_s * tick_s};
  }

 private:
  /// Weight of a measurement in the sum of all predictions over a drive, i ticks before the newest
  /// one. Every prediction whose window reaches the measurement contributes.
  class DriveWeights {
   public:
    constexpr DriveWeights(const SuffixSums<Levels>& sums, std::uint32_t lead, std::uint32_t drive)
        : lead_(lead), averaged_until_(std::min(lead + drive, sums.count())) {
      const std::uint32_t whole_mean_from = std::max(lead, sums.count());
      if (lead + drive > whole_mean_from) {
        whole_mean_share_ =
            static_cast<float>(lead + drive - whole_mean_from) / static_cast<float>(sums.count());
      }
      float total = 0.0F;
      std::uint32_t newer = 0;
      sums.for_each_newest_first([&](std::uint32_t size, float) {
        total += of_block(newer, size) * static_cast<float>(size);
        newer += size;
        return true;
      });
      scale_ = static_cast<float>(drive) / total;
    }

    /// The weight of each tick of a block, taken at the block's middle.
    /// @param newer ticks that are newer than the block
    [[nodiscard]] constexpr float of_block(std::uint32_t newer, std::uint32_t size) const {
      const std::uint32_t middle = std::max(newer + (size - 1) / 2, lead_);
      return scale_ * (whole_mean_share_ + harmonic_between(middle, averaged_until_));
    }

   private:
    /// 1/(a+1) + ... + 1/b; 0 for b <= a. Euler-Maclaurin from 8 on.
    [[nodiscard]] static constexpr float harmonic_between(std::uint32_t a, std::uint32_t b) {
      float sum = 0.0F;
      for (; a < b && a < 8; ++a) sum += 1.0F / static_cast<float>(a + 1);
      if (a >= b) return sum;
      const float from = static_cast<float>(a) + 0.5F;
      const float to = static_cast<float>(b) + 0.5F;
      return sum + natural_log(to / from) +
             (1.0F / 24.0F) * (1.0F / (to * to) - 1.0F / (from * from));
    }

    std::uint32_t lead_;
    std::uint32_t averaged_until_;
    float whole_mean_share_ = 0.0F;
    float scale_ = 1.0F;
  };

  [[nodiscard]] constexpr std::uint32_t window_length(const Transition& lead) const {
    return std::clamp(lead.ticks, std::uint32_t{1}, state_.sums.count());
  }
  [[nodiscard]] constexpr float mean_of_newest(std::uint32_t length) const {
    return state_.reference_rad_s + state_.sums.sum_of_newest(length) / static_cast<float>(length);
  }
  [[nodiscard]] constexpr float white_variance() const {
    return state_.white_variance_sum / static_cast<float>(state_.sums.count());
  }

  const ModesOf<Shape>* modes_;
  State state_{};
};

template <std::size_t R, std::size_t C>
MovingAverage(const Modes<R, C>&) -> MovingAverage<ModelShape{.decaying = R, .rotating = C}>;

}  // namespace zerorate::core
