/// @file
/// Lessons of references about a gyro in motion: what outlives a run, and how it ages.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/heading/reference_judge.hpp"

namespace zerorate::core {

/// Whether memory from outside may hold such an error of a scale factor.
[[nodiscard]] constexpr bool is_plausible_scale_error(float error) {
  constexpr float kLargest = 0.5F;
  return error >= -kLargest && error <= kLargest;
}

/// Count of the references that taught, and the temperature at which they did.
///
/// Another temperature has another scale factor: the variance grows with the square of the
/// difference, whether the way there was long or short.
struct Lessons {
  std::uint32_t references = 0;
  std::uint32_t drives = 0;             ///< drives in which at least one reference taught
  std::uint32_t references_before = 0;  ///< references up to the newest departure
  float learnt_k = 0.0F;                ///< temperature [K] of the newest such drive; 0: not known
  float drive_k = 0.0F;                 ///< temperature at the newest departure [K]
  float variance = 0.0F;                ///< variance that the difference has added

  constexpr bool operator==(const Lessons&) const = default;

  /// Whether memory from outside may be such a count.
  [[nodiscard]] bool is_possible() const {
    return references_before <= references && drives <= references &&
           are_plausible_variances(std::array{learnt_k, drive_k, variance});
  }
  /// Temperature at which the scale factor is known, the drive that lasts included.
  [[nodiscard]] constexpr float newest_k() const {
    return references != references_before ? drive_k : learnt_k;
  }
  /// A drive begins.
  /// @param temperature_k 0: not known
  /// @return growth of the variance of the scale factor
  constexpr float depart(float temperature_k, float scale_factor_per_k) {
    if (references != references_before) {
      ++drives;
      references_before = references;
      learnt_k = drive_k;
      variance = 0.0F;
    }
    drive_k = temperature_k;
    if (learnt_k == 0.0F || drive_k == 0.0F) return 0.0F;
    const float change = scale_factor_per_k * (drive_k - learnt_k);
    const float growth = std::max(change * change - variance, 0.0F);
    variance += growth;
    return growth;
  }
};

/// Lessons of references, as a record for the time without power.
struct LearntMotion {
  static constexpr float kMostDrives = 32.0F;  ///< drives that the variance between them rests on

  float scale_factor = 0.0F;  ///< error of it
  float scale_variance = 0.0F;
  float offset_rad_s = 0.0F;  ///< offset of the bias in motion
  float offset_variance_rad2_s2 = 0.0F;
  float covariance_rad_s = 0.0F;        ///< covariance of both
  float between_drives_rad2_s2 = 0.0F;  ///< variance of the bias in motion from drive to drive
  float between_drives_weight = 1.0F;   ///< information on it; 1: the guess before the first
  float noise_factor = 1.0F;            ///< variance of the references over the stated one
  float noise_weight = 1.0F;            ///< references that it rests on
  float temperature_k = 0.0F;           ///< temperature of the newest lesson; 0: not known
  std::uint32_t references = 0;         ///< references that taught
  std::uint32_t drives = 0;             ///< drives in which they did

  constexpr bool operator==(const LearntMotion&) const = default;

  /// Whether memory from outside may be such a lesson.
  [[nodiscard]] bool is_possible() const {
    constexpr float kRounded = 1.001F;
    return are_plausible(std::array{scale_factor, offset_rad_s, covariance_rad_s}) &&
           is_plausible_scale_error(scale_factor) &&
           are_plausible_variances(std::array{scale_variance, offset_variance_rad2_s2,
                                              between_drives_rad2_s2, between_drives_weight,
                                              temperature_k}) &&
           covariance_rad_s * covariance_rad_s <=
               kRounded * scale_variance * offset_variance_rad2_s2 &&
           between_drives_weight > 0.0F && judge().is_possible() && drives <= references;
  }
  /// Judge of a source that has to prove itself again.
  [[nodiscard]] constexpr ReferenceJudge judge() const {
    return ReferenceJudge{{.noise_factor = noise_factor, .noise_weight = noise_weight}};
  }
  /// Lessons after a pause. Each hour ages like a drive. No variance grows beyond that before the
  /// first reference.
  /// @param growth variances that an hour adds to the scale factor and to the offset
  /// @param widest variances before the first reference
  [[nodiscard]] constexpr LearntMotion aged(float pause_s, const std::array<float, 2>& growth,
                                            const std::array<float, 2>& widest) const {
    constexpr float kHour_s = 3600.0F;
    const float hours = pause_s / kHour_s;
    LearntMotion older = *this;
    const auto age = [&](float& variance, std::size_t i) {
      variance = std::max(variance, std::min(variance + hours * growth[i], widest[i]));
    };
    age(older.scale_variance, 0);
    age(older.offset_variance_rad2_s2, 1);
    return older;
  }
};

}  // namespace zerorate::core
