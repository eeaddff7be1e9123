/// @file
/// Checksum of the figures that a node computes with.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/complex.hpp"
#include "core/base/crc32.hpp"
#include "core/base/time.hpp"
#include "core/noise/hypotheses.hpp"
#include "core/noise/inputs.hpp"
#include "core/samples/sample_model.hpp"

namespace zerorate::app {

/// Adds numbers to a checksum, in one order and without the padding between them.
class Fingerprint {
 public:
  template <class Number>
  requires(std::is_arithmetic_v<Number> ||
           std::is_enum_v<Number>) constexpr void add(Number number) {
    crc_ = core::crc32(std::bit_cast<std::array<std::uint8_t, sizeof(Number)>>(number), crc_);
  }
  constexpr void add(core::Duration duration) { add(duration.ns()); }
  constexpr void add(core::Complex number) {
    add(number.re);
    add(number.im);
  }
  constexpr void add_modes(const auto& modes) {
    for (const auto& mode : modes) {
      add(mode.one_minus_phi);
      add(mode.noise_variance);
      add(mode.initial_variance);
      add(mode.initial_mean);
    }
  }
  template <core::ModelShape Shape>
  constexpr void add(const core::Hypotheses<Shape>& hypotheses) {
    for (std::size_t m = 0; m < hypotheses.count; ++m) {
      for (const float strength : hypotheses.all[m].strength) add(strength);
    }
  }
  constexpr void add(const core::KnownModel& /*none*/) {}
  [[nodiscard]] constexpr std::uint32_t value() const { return crc_; }

 private:
  std::uint32_t crc_ = 0;
};

/// Checksum of what gives the numbers of a record their meaning. What decides only which samples
/// are learnt from (standstill, odometer, gate) and what happens from then on (turn-on, prior
/// probabilities, half-life) is not in it: a record means the same under other figures there, and
/// what is counted in it (silence, steady ticks) is compared with the new ones from then on.
template <class Node>
[[nodiscard]] constexpr std::uint32_t fingerprint(const typename Node::Params& params) {
  Fingerprint print;
  print.add(std::uint32_t{sizeof(typename Node::Predictors::Filter)});
  print.add(std::uint32_t{sizeof(typename Node::State)});
  print.add(params.model.modes.tick);
  print.add(params.model.modes.start);
  print.add(params.model.modes.walk_variance);
  print.add_modes(params.model.modes.decaying);
  print.add_modes(params.model.modes.rotating);
  print.add(params.model.white_variance_rad2_s2);
  print.add(params.model.measurement_floor_variance_rad2_s2);
  if constexpr (!std::is_empty_v<typename Node::TickInputs>) {
    print.add(params.model.inputs.reference_degc);
    print.add(params.model.inputs.lag_s);
    for (const core::InputTerm& term : params.model.inputs.terms) {
      print.add(term.input);
      print.add(term.sigma);
      for (const float coefficient : term.coefficient) print.add(coefficient);
    }
  }
  if constexpr (Node::kScreensSamples) {
    const core::SampleModel& samples = params.model.samples;
    for (const float figure : {samples.outliers.probability, samples.outliers.variance_rad2_s2,
                               samples.motion.begin_probability, samples.motion.end_probability,
                               samples.motion.variance_rad2_s2, samples.level.variance,
                               samples.level.time_constants_per_tick, samples.range.lower_rad_s,
                               samples.range.upper_rad_s}) {
      print.add(figure);
    }
  }
  print.add(params.model.sample_period);
  print.add(params.learns_white_noise);
  print.add(params.model.hypotheses);
  for (const float rate_rad_s : params.earth.vertical_rad_s) print.add(rate_rad_s);
  if (params.model.scale.is_on()) {
    for (const float factor : params.model.scale.factor) print.add(factor);
  }
  if (params.model.truncation.is_on()) print.add(params.model.truncation.half_step_rad_s);
  return print.value();
}

}  // namespace zerorate::app
