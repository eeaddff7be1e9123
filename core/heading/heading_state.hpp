/// @file
/// State of the filter of the heading, as memory.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/numeric.hpp"
#include "core/base/symmetric_matrix.hpp"
#include "core/heading/learnt_motion.hpp"
#include "core/heading/reference_judge.hpp"

namespace zerorate::core {

/// Memory of a HeadingFilter.
struct HeadingState {
  static constexpr std::size_t kStates = 4;
  /// Index of each state.
  static constexpr std::size_t kHeading = 0;
  static constexpr std::size_t kScale = 1;
  static constexpr std::size_t kOffset = 2;
  static constexpr std::size_t kBias = 3;

  /// Turn by the gyro, not yet divided by its scale factor.
  struct Turn {
    float turn_rad = 0.0F;
    float length_s = 0.0F;

    constexpr bool operator==(const Turn&) const = default;
  };

  std::array<float, kStates> x{};
  SymmetricMatrix<kStates> covariance{};
  Turn since;                          ///< since the newest reference that was taken
  float newest_variance_rad2 = 0.0F;   ///< variance of that reference
  float bias_variance_rad2_s2 = 0.0F;  ///< variance of the predicted bias, newest
  float bias_variance_at_departure_rad2_s2 = 0.0F;
  float drift_rad2_s3 = 0.0F;  ///< growth of that variance in the first two minutes, a second
  float driven_s = 0.0F;       ///< since departure
  /// Deviation of the turn since departure by the bias in motion that another drive has not.
  float drive_sigma_rad = 0.0F;
  float between_drives_rad2_s2 = 0.0F;  ///< variance of the bias in motion from drive to drive
  float between_drives_weight = 1.0F;   ///< information on it; 1: the guess before the first
  float bias_prior_rad2_s2 = 0.0F;      ///< variance of the bias, had no reference come
  ReferenceJudge judge;
  Lessons lessons;
  bool has_heading = false;
  bool has_learnt = false;

  constexpr bool operator==(const HeadingState&) const = default;

  /// Whether memory from outside may be such a state.
  [[nodiscard]] bool is_possible() const {
    for (std::size_t i = 0; i < kStates; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        if (!is_plausible(covariance(i, j))) return false;
      }
      if (!(covariance(i, i) >= 0.0F)) return false;
    }
    return are_bools(has_heading, has_learnt) && are_plausible(x) &&
           is_plausible_scale_error(x[kScale]) &&
           are_plausible(std::array{since.turn_rad, since.length_s}) &&
           are_plausible_variances(std::array{newest_variance_rad2, bias_variance_rad2_s2,
                                              bias_variance_at_departure_rad2_s2, drift_rad2_s3,
                                              driven_s, drive_sigma_rad, between_drives_rad2_s2,
                                              between_drives_weight, bias_prior_rad2_s2}) &&
           between_drives_weight > 0.0F && judge.is_possible() && lessons.is_possible();
  }

  /// Lessons, without the heading and the drive.
  [[nodiscard]] constexpr LearntMotion learnt() const {
    return {.scale_factor = x[kScale],
            .scale_variance = covariance(kScale, kScale),
            .offset_rad_s = x[kOffset],
            .offset_variance_rad2_s2 = covariance(kOffset, kOffset),
            .covariance_rad_s = covariance(kScale, kOffset),
            .between_drives_rad2_s2 = between_drives_rad2_s2,
            .between_drives_weight = between_drives_weight,
            .noise_factor = judge.state().noise_factor,
            .noise_weight = judge.state().noise_weight,
            .temperature_k = lessons.newest_k(),
            .references = lessons.references,
            .drives = lessons.drives};
  }
};

}  // namespace zerorate::core
