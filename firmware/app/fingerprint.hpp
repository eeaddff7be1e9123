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

}  // namespace zerorate::app
