/// @file
/// Whether memory from outside may be what a node remembers.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/estimator/prediction.hpp"
#include "core/noise/inputs.hpp"
#include "core/noise/modes.hpp"
#include "firmware/app/node_params.hpp"

namespace zerorate::app {

/// Whether all words of a value of floats are plausible numbers.
/// @pre  no padding: an empty array has a byte, and bytes of padding hold whatever was there before
template <class Value>
[[nodiscard]] bool has_plausible_words(const Value& value) {
  static_assert(sizeof(Value) % sizeof(float) == 0);
  return core::are_plausible(
      std::bit_cast<std::array<float, sizeof(Value) / sizeof(float)>>(value));
}

/// Whether memory from outside may be a span of a model's modes.
template <std::size_t R, std::size_t C>
[[nodiscard]] bool is_possible_span(const core::Transition<R, C>& span) {
  const auto is_possible = [](const auto& mode) { return has_plausible_words(mode); };
  return is_possible(span.level) && std::ranges::all_of(span.decaying, is_possible) &&
         std::ranges::all_of(span.rotating, is_possible);
}
/// Likewise with the inputs.
template <core::ModelShape Shape>
[[nodiscard]] bool is_possible_span(const core::TransitionWithInputs<Shape>& span) {
  const core::TransitionOf<Shape>& modes = span;
  return is_possible_span(modes) && has_plausible_words(span.inputs);
}

/// Whether predictions are plausible numbers with positive variances.
/// @param may_be_silent whether they may be those of a predictor that knows nothing
template <std::size_t Axes>
[[nodiscard]] constexpr bool are_plausible(const std::array<core::Prediction, Axes>& predictions,
                                           bool may_be_silent) {
  constexpr float kSilent = core::Prediction{}.variance_rad2_s2;
  for (const core::Prediction& predicted : predictions) {
    if (may_be_silent && predicted.variance_rad2_s2 == kSilent) continue;
    if (!core::is_plausible_rate(predicted.bias_rad_s) ||
        !core::is_finite_positive(predicted.variance_rad2_s2) ||
        !core::is_plausible_variance(predicted.variance_rad2_s2)) {
      return false;
    }
  }
  return true;
}

/// The covariance of the bias and its drifts while its triangular decomposition takes one component
/// after the other out of it. Roundings of a filter stay far below kRounding of a variance.
/// @tparam Size components
template <std::size_t Size>
struct Decomposition {
  static constexpr float kRounding = 1e-3F;
  static constexpr float kSmallestPivot = 1e-4F;

  std::array<std::array<float, Size>, Size> rest{};  ///< lower triangle, (rad/s)^2
  std::array<float, Size> variance{};                ///< diagonal before the decomposition

  /// Takes component k out.
  /// @return false if a direction has a negative variance, or if something that does not vary
  /// varies with another
  [[nodiscard]] bool eliminate(std::size_t k) {
    if (!core::is_plausible_variance(variance[k])) return false;
    if (rest[k][k] < -kRounding * variance[k]) return false;
    const float pivot = std::max(rest[k][k], kSmallestPivot * variance[k]);
    for (std::size_t i = k + 1; i < Size; ++i) {
      if (rest[i][k] == 0.0F) continue;
      if (!(pivot > 0.0F)) return false;
      const float share = rest[i][k] / pivot;
      for (std::size_t j = k + 1; j <= i; ++j) rest[i][j] -= share * rest[j][k];
    }
    return true;
  }
};

/// Whether the covariance of the bias and its drifts has no direction with a negative variance, by
/// the pivots of its decomposition.
/// Cost: kDrifts^3 / 6 operations; (kDrifts + 1)(kDrifts + 2) floats of stack.
template <class Filter>
[[nodiscard]] bool has_possible_covariance(const Filter& filter) {
  constexpr std::size_t kSize = Filter::kDrifts + 1;
  Decomposition<kSize> left;
  left.rest[0][0] = filter.bias_variance;
  for (std::size_t i = 1; i < kSize; ++i) {
    left.rest[i][0] = filter.bias_covariance[i - 1];
    for (std::size_t j = 1; j <= i; ++j) left.rest[i][j] = filter.covariance(i - 1, j - 1);
  }
  for (std::size_t i = 0; i < kSize; ++i) left.variance[i] = left.rest[i][i];
  for (std::size_t k = 0; k < kSize; ++k) {
    if (!left.eliminate(k)) return false;
  }
  return true;
}

template <class Filter>
[[nodiscard]] bool is_possible_filter(const Filter& filter) {
  if (!(filter.bias_variance > 0.0F) || !has_plausible_words(filter)) return false;
  for (const auto& axis : filter.axes) {
    if (!core::is_plausible_rate(axis.bias_rad_s)) return false;
  }
  return has_possible_covariance(filter);
}

/// Whether the weights of `count` hypotheses are probabilities, and their scales positive.
template <class Evidence>
[[nodiscard]] bool is_possible_evidence(const Evidence& evidence, std::size_t count) {
  constexpr float kRounding = 1e-3F;
  if (!has_plausible_words(evidence) || evidence.shape < Evidence::kPriorShape) return false;
  const std::size_t axes = evidence.hypotheses[0].size();
  for (std::size_t i = 0; i < axes; ++i) {
    float sum = 0.0F;
    for (std::size_t m = 0; m < count; ++m) {
      const auto& one = evidence.hypotheses[m][i];
      if (!(one.weight >= 0.0F && one.log_evidence <= 0.0F && one.scale > 0.0F)) return false;
      sum += one.weight;
    }
    if (!(sum >= 1.0F - kRounding && sum <= 1.0F + kRounding)) return false;
  }
  return true;
}

/// Whether memory from outside may be the state of a bank of filters.
/// @param count hypotheses that are weighed; 0: the model is known
template <class Bank>
[[nodiscard]] bool is_possible_bank(const typename Bank::State& state, std::size_t count) {
  for (const auto& axis : state.axes) {
    if (!core::is_plausible_rate(axis.reference_rad_s) ||
        !core::is_plausible_variance(axis.rejection_variance)) {
      return false;
    }
  }
  if constexpr (Bank::kLearns) {
    if (count > 0 && !is_possible_evidence(state.evidence, count)) return false;
  }
  if (!state.is_measured()) return true;  // the filters are then what the model says
  for (std::size_t m = 0; m < std::max(count, std::size_t{1}); ++m) {
    if (!is_possible_filter(state.filters[m])) return false;
  }
  return true;
}

/// True if a restored state is valid for a node with the parameters of this one. What the node
/// makes of a valid state may still predict what is no number: see predicts_numbers().
template <class Node>
[[nodiscard]] bool is_possible_state(const Node& node, const typename Node::State& state) {
  using Ticks = typename Node::Ticks;
  const auto is_possible_item = [](const typename Ticks::Tick& held) {
    return Node::TickInputs::is_possible(held.inputs) && Node::Screening::is_possible(held.squares);
  };
  const typename Ticks::State& ticks = state.ticks;
  constexpr std::int32_t kMostCredit = 1 << 16;
  return core::is_bool(state.odometer_fault) && state.credit <= kMostCredit &&
         state.credit >= -kMostCredit && Node::Turn::is_possible(state.turn) &&
         is_possible_span(ticks.lead) && ticks.tick == state.learning.average.tick &&
         ticks.measured_ticks <= ticks.tick + 1 && are_plausible(ticks.predicted, true) &&
         Node::Learning::is_possible(state.learning, node.params().model.modes.tick,
                                     is_possible_item) &&
         Node::InputTrack::is_possible(ticks.inputs) &&
         Node::Screening::is_possible(ticks.screening) &&
         Ticks::WhiteLevel::is_possible(ticks.white) &&
         Ticks::Work::is_possible(ticks.work, Ticks::kMostItems, is_possible_item) &&
         node.predictors().is_possible(ticks.predictors);
}

/// Whether what a node has taken up from outside, and aged, is possible, and everything that the
/// node predicts from now until months ahead is a plausible number with a positive variance, or
/// nothing is predicted. Not inlined: its transitions need stack.
template <class Node>
[[nodiscard, gnu::noinline]] bool predicts_numbers(const Node& node) {
  const auto& predictors = node.predictors();
  if (!predictors.is_possible(predictors.filter(), predictors.drive_memory())) return false;
  constexpr std::uint32_t kFactor = 64;
  constexpr std::uint32_t kMonths = 1U << 24U;  // at 2 Hz
  for (std::uint32_t ticks = 1; ticks <= kMonths; ticks *= kFactor) {
    const typename Node::Transition lead{node.params().model.modes.over(ticks)};
    for (const Predictor which : {Predictor::kalman, node.params().published}) {
      const bool may_be_silent = which != Predictor::kalman || !predictors.has_learnt();
      std::array<core::Prediction, Node::kAxes> predictions{};
      for (std::size_t i = 0; i < Node::kAxes; ++i) {
        predictions[i] = predictors.predict(which, i, {lead, lead}, node.params().model.modes);
      }
      if (!are_plausible(predictions, may_be_silent)) return false;
    }
  }
  return true;
}

}  // namespace zerorate::app
