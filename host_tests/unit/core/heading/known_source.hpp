/// @file
/// A heading filter whose references have been compared for long.
#pragma once

#include "core/heading/heading_filter.hpp"

namespace zerorate::core {

constexpr float kSigma_rad = 0.5F * kRadPerDeg;
constexpr float kVariance = kSigma_rad * kSigma_rad;
constexpr float kBiasVariance = 1e-9F;
constexpr HeadingFilter::Params kParams{
    .scale_factor = 0.02F, .offset_rad_s = 0.01F * kRadPerDeg, .between_drives_rad_s = 0.0F};

/// Filter whose references have long been aligned.
inline HeadingFilter filter_of_known_source(const HeadingFilter::Params& params = kParams,
                                            float noise_factor = 9.0F) {
  HeadingFilter filter{params};
  HeadingFilter::State state = filter.state();
  state.judge = ReferenceJudge{{.noise_factor = noise_factor, .compared_s = 1000.0F}};
  filter.restore(state);
  return filter;
}
/// Filter whose factor of the references' noise begins at the stated one.
inline HeadingFilter filter_of_honest_references(const HeadingFilter::Params& params = kParams) {
  return filter_of_known_source(params, 1.0F);
}

}  // namespace zerorate::core
