/// @file
/// Noise model that a node has learnt, as bytes; see docs/reference/rate-frame.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/crc32.hpp"
#include "core/base/numeric.hpp"
#include "core/base/result.hpp"
#include "core/base/units.hpp"
#include "firmware/app/learnt_noise.hpp"
#include "firmware/wire/little_endian.hpp"
#include "firmware/wire/rate_frame.hpp"

namespace zerorate::wire {

inline constexpr std::size_t kLearntFrameBytes = 84;
using LearntFrame = std::array<std::uint8_t, kLearntFrameBytes>;

/// Noise of the three axes as the node has learnt it.
struct LearntModel {
  std::array<app::LearntNoise, 3> axes;

  constexpr bool operator==(const LearntModel&) const = default;
  /// Effective stops that the figures rest on: one number, because the axes stop together.
  [[nodiscard]] constexpr float stops() const { return axes[0].stops; }
  /// Whether at least one stop is behind the figures.
  [[nodiscard]] constexpr bool is_learnt() const { return stops() > 0.0F; }
};

/// Figure of a learnt model under the name that JSON and metrics use, with the unit of that name.
struct LearntQuantity {
  std::string_view name;
  std::string_view sigma_name;  ///< name of its standard deviation
  app::LearntFigure app::LearntNoise::*figure;
  float si_per_unit;
};

/// Figures in the order of the frame.
inline constexpr std::array<LearntQuantity, 3> kLearntQuantities{{
    {"order", "order_sigma", &app::LearntNoise::order, 1.0F},
    {"bias_instability_dph", "bias_instability_sigma_dph",
     &app::LearntNoise::bias_instability_rad_s, core::deg_per_h.si_per_unit()},
    {"angle_random_walk_dps_per_sqrt_hz", "angle_random_walk_sigma_dps_per_sqrt_hz",
     &app::LearntNoise::angle_random_walk_rad_per_sqrt_s, core::deg_per_s.si_per_unit()},
}};

namespace detail {
inline constexpr std::uint16_t kLearntMagic = 0x4C5A;  // "ZL"

/// Takes a number of the frame.
/// @return false where it is none that a model can have
[[nodiscard]] constexpr bool take_figure(LittleEndianReader& in, float& figure) {
  figure = in.take_float();
  return core::is_finite(figure) && figure >= 0.0F;
}
[[nodiscard]] constexpr bool take_learnt(LittleEndianReader& in, LearntModel& learnt) {
  float stops = 0.0F;
  bool is_possible = take_figure(in, stops);
  for (app::LearntNoise& axis : learnt.axes) {
    axis.stops = stops;
    for (const LearntQuantity& quantity : kLearntQuantities) {
      app::LearntFigure& figure = axis.*quantity.figure;
      is_possible = take_figure(in, figure.value) && is_possible;
      is_possible = take_figure(in, figure.sigma) && is_possible;
    }
  }
  return is_possible;
}
}  // namespace detail

[[nodiscard]] constexpr LearntFrame encode_learnt_frame(const LearntModel& learnt) {
  LearntFrame frame{};
  LittleEndianWriter out{frame};
  out.put(detail::kLearntMagic);
  out.put(detail::kVersion);
  out.put(std::uint8_t{0});
  out.put(learnt.stops());
  for (const app::LearntNoise& axis : learnt.axes) {
    for (const LearntQuantity& quantity : kLearntQuantities) {
      const app::LearntFigure& figure = axis.*quantity.figure;
      out.put(figure.value);
      out.put(figure.sigma);
    }
  }
  out.put(core::crc32(std::span{frame}.first<kLearntFrameBytes - detail::kChecksumBytes>()));
  return frame;
}

/// The inverse, for bytes of any origin.
[[nodiscard]] constexpr core::Result<LearntModel, FrameError> decode_learnt_frame(
    std::span<const std::uint8_t> bytes) {
  using core::Unexpected;
  if (bytes.size() != kLearntFrameBytes) return Unexpected{FrameError::wrong_size};
  LittleEndianReader in{bytes};
  if (in.take<std::uint16_t>() != detail::kLearntMagic) return Unexpected{FrameError::not_a_frame};
  if (in.take<std::uint8_t>() != detail::kVersion) return Unexpected{FrameError::unknown_version};
  (void)in.take<std::uint8_t>();
  constexpr std::size_t kChecked = kLearntFrameBytes - detail::kChecksumBytes;
  LittleEndianReader checksum{bytes.subspan(kChecked)};
  if (checksum.take<std::uint32_t>() != core::crc32(bytes.first(kChecked))) {
    return Unexpected{FrameError::wrong_checksum};
  }
  LearntModel learnt;
  if (!detail::take_learnt(in, learnt)) return Unexpected{FrameError::impossible_value};
  return learnt;
}

}  // namespace zerorate::wire
