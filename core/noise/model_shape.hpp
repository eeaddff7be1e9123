/// @file
/// Number of states of each kind in a filter.
#pragma once

#include <cstddef>

#include "core/noise/modes.hpp"

namespace zerorate::core {

/// States of a filter beside the bias itself. A constant of the program: memory and time follow
/// from it.
struct ModelShape {
  std::size_t decaying = 0;        ///< first-order Gauss-Markov modes
  std::size_t rotating = 0;        ///< damped oscillations, two states each
  std::size_t inputs = 0;          ///< terms that follow a temperature or a specific force
  bool has_accelerometer = false;  ///< the specific force is measured: a term may follow it
  std::size_t hypotheses = 1;      ///< strengths of the slow noise; 1: it is known

  constexpr bool operator==(const ModelShape&) const = default;
};

/// The shape of a filter that learns its noise model among so many hypotheses.
[[nodiscard]] constexpr ModelShape with_hypotheses(ModelShape shape, std::size_t count) {
  shape.hypotheses = count;
  return shape;
}

template <ModelShape Shape>
using ModesOf = Modes<Shape.decaying, Shape.rotating>;
template <ModelShape Shape>
using TransitionOf = Transition<Shape.decaying, Shape.rotating>;

}  // namespace zerorate::core
