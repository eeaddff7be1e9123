/// @file
/// Work of a tick, cut into steps of bounded length.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/noise/model_shape.hpp"
#include "core/samples/tick_average.hpp"
#include "firmware/app/possible_state.hpp"

namespace zerorate::app {

/// A measurement: the mean of a tick at standstill, with its circumstances.
template <std::size_t Axes, class TickInputs, class Squares>
struct LearntTick : core::TickMean<Axes> {
  bool begins_stop = false;  ///< first measurement of a stop
  bool has_jumped = false;   ///< first one of a level that was doubted, and is accepted
  bool is_sway = false;      ///< mean of a vehicle that sways, in place of that of a tick
  [[no_unique_address]] TickInputs inputs;
  [[no_unique_address]] Squares squares;

  constexpr bool operator==(const LearntTick&) const = default;
};

/// Steps of TickNode, in order. A step with an item is repeated for each of them.
enum class TickStage : std::uint8_t {
  idle,
  begin,     ///< levels and averages take notice of the measurement
  span,      ///< piece of the span since the measurement before
  advance,   ///< hypothesis: its filter goes on to the measurement
  compare,   ///< the bank compares the measurement with its forecast
  learn,     ///< hypothesis: its filter and its evidence learn
  conclude,  ///< all hypotheses have learnt
  weigh,     ///< axis: probabilities of the hypotheses
  rest,      ///< monitors, moving average and calibration mean
  lead,      ///< piece of the span to the tick being filled
  window,    ///< piece of the span that an average covers
  predict,   ///< hypothesis: its forecast, or axis: that of an average
  drive,     ///< piece of the span of the drive so far
  approach,  ///< piece of the span from the newest measurement to the drive
  integral,  ///< hypothesis, or axis of an average: variance of the integral over the drive
};

/// Costs of the steps in units of 5,000 instructions of a Cortex-M0+ with libgcc's floating point,
/// or 250 of a Cortex-M4F, as docs/reference/c-interface.md counts them. They grow with the square
/// of the states.
template <core::ModelShape Shape, std::size_t Axes>
struct TickCosts {
  static constexpr auto kStates =
      static_cast<std::uint32_t>(Shape.decaying + 2 * Shape.rotating + Shape.inputs);
  static constexpr std::uint32_t kBeginning = 2 + static_cast<std::uint32_t>(Shape.hypotheses) / 2;
  static constexpr std::uint32_t kAdvance = 1 + kStates * kStates / 13;
  static constexpr std::uint32_t kComparison = 1 + static_cast<std::uint32_t>(Shape.hypotheses) / 2;
  static constexpr std::uint32_t kLearning = 4 + kStates * kStates / 30;
  static constexpr std::uint32_t kConclusion = 2;
  static constexpr std::uint32_t kWeighing = 1 + static_cast<std::uint32_t>(Shape.hypotheses) / 2;
  static constexpr std::uint32_t kRest = 6;
  static constexpr std::uint32_t kLead = 4;
  static constexpr std::uint32_t kPrediction = 1 + kStates * kStates / 30;
  static constexpr std::uint32_t kIntegral = 2 * kPrediction;
  static constexpr std::uint32_t kLongest =
      std::max({kBeginning, kAdvance + 1, kComparison, kLearning, kWeighing, kRest, kIntegral});
  /// A piece of a span grows with the logarithm of its length.
  static constexpr std::uint32_t of_piece(std::uint32_t ticks) {
    return 1U + static_cast<std::uint32_t>(std::bit_width(ticks)) / 2U;
  }

  /// Cost of the next step of a stage.
  /// @param begins whether it is the first one  @param ticks length of the span that is made
  static constexpr std::uint32_t of_step(TickStage stage, bool begins, std::uint32_t ticks) {
    switch (stage) {
      case TickStage::begin:
        return kBeginning;
      case TickStage::advance:
        return kAdvance;
      case TickStage::compare:
        return kComparison;
      case TickStage::learn:
        return kLearning;
      case TickStage::conclude:
        return kConclusion;
      case TickStage::weigh:
        return kWeighing;
      case TickStage::rest:
        return kRest;
      case TickStage::predict:
        return kPrediction;
      case TickStage::integral:
        return kIntegral;
      case TickStage::lead:
        return begins ? kLead : of_piece(ticks);
      default:
        return of_piece(ticks);
    }
  }

  /// Upper bound of the steps from one tick to the next in a stop: a prediction and a measurement.
  /// @param publishes_average whether an average is published, whose window needs a span of its own
  [[nodiscard]] static constexpr std::uint32_t of_tick(bool publishes_average) {
    constexpr auto kFilters = static_cast<std::uint32_t>(Shape.hypotheses);
    constexpr auto kPieces = static_cast<std::uint32_t>(core::ModesOf<Shape>::kPieces);
    constexpr std::uint32_t kShortLead = 7;  ///< ticks from a measurement to the present
    constexpr std::uint32_t kLongWindow = 1U << 14U;
    return kBeginning + kFilters * (kAdvance + kLearning + kPrediction) + kComparison +
           kConclusion + static_cast<std::uint32_t>(Axes) * (kWeighing + kPrediction) + kRest +
           kPieces * (of_piece(kShortLead) + (publishes_average ? of_piece(kLongWindow) : 0));
  }

  static constexpr std::int32_t kAtOnce = 0;  ///< pace where a tick has a single sample
  /// Cost units a sample that do the work of a tick before the next one begins.
  [[nodiscard]] static constexpr std::int32_t pace(std::uint32_t samples_of_tick,
                                                   bool publishes_average) {
    if (samples_of_tick == 1) return kAtOnce;
    // The last step of a tick may wait for one more share.
    const std::uint32_t cost = of_tick(publishes_average) + kLongest;
    return static_cast<std::int32_t>((cost + samples_of_tick - 1) / samples_of_tick);
  }
  /// Where a share is less than a step, steps are done one by one and still keep up.
  [[nodiscard]] static constexpr std::int32_t longest_call(std::int32_t share) {
    constexpr auto kLongestStep = static_cast<std::int32_t>(kLongest);
    return share < kLongestStep ? kLongestStep : share + kLongestStep - 1;
  }
};

/// Question about the integral of the bias over the newest ticks, and its answer.
template <std::size_t Axes>
struct DriveIntegral {
  std::uint32_t ticks = 0;  ///< number of ticks asked about; 0: nothing is asked
  bool is_known = false;    ///< the answer is there, and was not taken
  std::array<float, Axes> variance_rad2{};

  constexpr bool operator==(const DriveIntegral&) const = default;
};

/// Work in progress: plain data, part of a node's state.
/// @tparam Tick measurement of a TickNode  @tparam Predictors its AxisPredictors
template <class Tick, class Predictors>
struct TickWork {
  TickStage stage = TickStage::idle;
  std::uint8_t item = 0;               ///< next piece, hypothesis or axis of the stage
  bool is_stale = false;               ///< the prediction is not that of the tick being filled
  bool begins_to_learn = false;        ///< the white noise was seen for the first time
  float unit_factor = 1.0F;            ///< change of the unit of the bank's variances
  float sway_variance_rad2_s2 = 0.0F;  ///< variance of the error of a sway's mean
  Tick tick;                           ///< measurement that is being learnt
  typename Predictors::Measurement measurement;
  typename Predictors::Kalman::Forecast::Mixtures mixtures{};
  typename Predictors::Transition span;  ///< since the measurement before, of an average or a drive
  DriveIntegral<Predictors::kAxes> drive;

  constexpr void go_to(TickStage next_stage) {
    stage = next_stage;
    item = 0;
  }
  /// Goes to the next item, or after `items` of them to the next stage.
  constexpr void next(std::size_t items, TickStage next_stage) {
    if (++item >= items) go_to(next_stage);
  }

  constexpr bool operator==(const TickWork&) const = default;

  /// True if restored work is valid: its items exist, and its numbers are plausible.
  /// @param most_items largest number of items of a stage
  template <class IsPossibleTick>
  [[nodiscard]] static bool is_possible(const TickWork& work, std::size_t most_items,
                                        IsPossibleTick is_possible_tick) {
    const auto number = std::bit_cast<std::uint8_t>(work.stage);
    return number <= static_cast<std::uint8_t>(TickStage::integral) && work.item < most_items &&
           core::are_bools(work.is_stale, work.begins_to_learn, work.tick.begins_stop,
                           work.tick.has_jumped, work.tick.is_sway, work.drive.is_known) &&
           core::is_plausible_variance(work.unit_factor) && work.unit_factor > 0.0F &&
           core::are_plausible(work.tick.rate_rad_s) &&
           core::is_plausible_variance(work.sway_variance_rad2_s2) && is_possible_tick(work.tick) &&
           is_possible_span(work.span);
  }
};

}  // namespace zerorate::app
