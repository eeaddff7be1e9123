/// @file
/// Heading of a vehicle between references, and what references show of its gyro.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "core/base/numeric.hpp"
#include "core/base/units.hpp"
#include "core/heading/heading_state.hpp"
#include "core/heading/learnt_motion.hpp"
#include "core/heading/reference_judge.hpp"

namespace zerorate::core {

/// A Kalman filter of four states about the vertical axis: heading, error of the scale factor,
/// offset between the bias in motion and at rest, and error of the bias that was predicted at
/// departure. Between references the rate carries the heading on:
///
///     d heading / dt = (measured - predicted bias - offset - bias) / (1 + scale factor)
///
/// A reference of the heading measures the first state, one of a turn a sum of the others. Their
/// errors count as independent. The bias in motion differs from drive to drive, with a variance
/// that is learnt too. A ReferenceJudge decides which references teach; docs/design/references.md.
///
/// Angles are counter-clockwise about the axis that points up. Fixed memory; cost: some 100
/// floating-point operations a tick and a reference.
class HeadingFilter {
 public:
  using State = HeadingState;
  using Turn = State::Turn;
  static constexpr std::size_t kStates = State::kStates;
  static constexpr std::size_t kHeading = State::kHeading;
  static constexpr std::size_t kScale = State::kScale;
  static constexpr std::size_t kOffset = State::kOffset;
  static constexpr std::size_t kBias = State::kBias;

  /// Standard deviations before the first reference.
  struct Params {
    float scale_factor = 0.01F;
    float offset_rad_s = 0.007F * kRadPerDeg;  ///< vibration moves the bias of a consumer gyro so
    float between_drives_rad_s = 0.005F * kRadPerDeg;  ///< part of it that another drive has not
    float scale_factor_per_k = 1e-4F;  ///< change of the scale factor with the temperature
    float scale_factor_at_k = 0.0F;    ///< temperature at which it is known so; 0: not known
    float slope_variance_rad2 = 0.0F;  ///< variance of the turn that a slope feigns
  };
  constexpr explicit HeadingFilter(const Params& params)
      : variance_{0.0F, params.scale_factor * params.scale_factor,
                  params.offset_rad_s * params.offset_rad_s,
                  params.between_drives_rad_s * params.between_drives_rad_s},
        scale_factor_per_k_(params.scale_factor_per_k),
        slope_variance_rad2_(params.slope_variance_rad2) {
    state_.between_drives_rad2_s2 = variance_[kBias];
    state_.lessons.learnt_k = params.scale_factor_at_k;
    state_.covariance(kScale, kScale) = variance_[kScale];
    state_.covariance(kOffset, kOffset) = variance_[kOffset];
  }

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// Goes on, before the first reference, with what another run has learnt.
  constexpr void resume(const LearntMotion& learnt, float pause_s) {
    if (learnt.references == 0) return;
    const LearntMotion now =
        learnt.aged(pause_s, {kScaleGrowth, kOffsetGrowth * variance_[kOffset]},
                    {variance_[kScale], variance_[kOffset]});
    state_.x = {0.0F, now.scale_factor, now.offset_rad_s, 0.0F};
    state_.covariance(kScale, kScale) = now.scale_variance;
    state_.covariance(kOffset, kOffset) = now.offset_variance_rad2_s2;
    state_.covariance(kScale, kOffset) = now.covariance_rad_s;
    state_.between_drives_rad2_s2 = now.between_drives_rad2_s2;
    state_.between_drives_weight = now.between_drives_weight;
    state_.judge = now.judge();
    state_.lessons = {.references = now.references,
                      .drives = now.drives,
                      .references_before = now.references,
                      .learnt_k = now.temperature_k};
    state_.has_learnt = true;
  }

  /// The vehicle departs with a bias that was learnt at rest.
  /// @param temperature_k of the sensor; 0: not known
  constexpr void depart(float bias_variance_rad2_s2, float temperature_k = 0.0F) {
    learn_from_drive();
    for (std::size_t i = 0; i < kStates; ++i) state_.covariance(kBias, i) = 0.0F;
    state_.bias_prior_rad2_s2 = bias_variance_rad2_s2 + state_.between_drives_rad2_s2;
    state_.covariance(kBias, kBias) = state_.bias_prior_rad2_s2;
    state_.x[kBias] = 0.0F;
    state_.bias_variance_rad2_s2 = bias_variance_rad2_s2;
    state_.bias_variance_at_departure_rad2_s2 = bias_variance_rad2_s2;
    state_.drift_rad2_s3 = 0.0F;
    state_.driven_s = 0.0F;
    state_.drive_sigma_rad = 0.0F;
    state_.covariance(kScale, kScale) +=
        kScaleGrowth + state_.lessons.depart(temperature_k, scale_factor_per_k_);
    state_.covariance(kOffset, kOffset) += kOffsetGrowth * variance_[kOffset];
  }

  /// The vehicle turned.
  /// @param noise_rad2 variance of the white noise and of gaps
  /// @param bias_variance_rad2_s2 of the predicted bias at the end of the turn
  constexpr void advance(const Turn& turn, float noise_rad2, float bias_variance_rad2_s2) {
    auto& p = state_.covariance;
    const auto f = sensitivity(turn);
    float heading_gain = noise_rad2;
    std::array<float, kStates> gain{};
    for (std::size_t j = kScale; j < kStates; ++j) {
      for (std::size_t k = kScale; k < kStates; ++k) gain[j] += f[k] * p(k, j);
      heading_gain += f[j] * (2.0F * p(kHeading, j) + gain[j]);
    }
    p(kHeading, kHeading) = std::max(p(kHeading, kHeading) + heading_gain, 0.0F);
    for (std::size_t j = kScale; j < kStates; ++j) p(kHeading, j) += gain[j];
    state_.drive_sigma_rad +=
        turn.length_s * square_root(std::min(state_.between_drives_rad2_s2, p(kBias, kBias)));
    const float growth = bias_growth(turn.length_s, bias_variance_rad2_s2);
    p(kBias, kBias) += growth;
    state_.bias_prior_rad2_s2 += growth;
    state_.x[kHeading] = wrapped(state_.x[kHeading] + scaled(turn.turn_rad));
    state_.since.turn_rad += turn.turn_rad;
    state_.since.length_s += turn.length_s;
  }

  /// A reference of the heading.
  /// @param ahead turn from the filter's time to that of the reference; negative: it is in the past
  /// @param variance_rad2 stated variance of the heading
  constexpr ReferenceVerdict take_heading(float heading_rad, float variance_rad2,
                                          const Turn& ahead) {
    const Turn since{state_.since.turn_rad + ahead.turn_rad,
                     state_.since.length_s + ahead.length_s};
    const float at_filter_rad = heading_rad - scaled(ahead.turn_rad);
    const bool has_nothing_to_compare = !state_.has_heading || state_.judge.is_new();
    if (state_.has_heading) state_.judge.note_compared(since.length_s);
    if (has_nothing_to_compare) return begin(at_filter_rad, variance_rad2);
    if (is_too_soon(since, variance_rad2)) return ReferenceVerdict::too_soon;
    auto h = sensitivity(ahead);
    h[kHeading] = 1.0F;
    const float error_rad = wrapped(at_filter_rad - state_.x[kHeading]);
    const ReferenceVerdict verdict =
        take(h, error_rad, variance_rad2, since, slope_noise_rad2(since.length_s));
    if (verdict == ReferenceVerdict::learnt) note_taken(variance_rad2, ahead);
    if (!state_.judge.leans()) return verdict;
    if (verdict == ReferenceVerdict::learnt) doubt_what_was_learnt(0.0F, since);
    state_.judge.note_jump();
    return begin(at_filter_rad, variance_rad2);
  }
  /// A reference of the angle that was turned meanwhile.
  /// @param variance_rad2 stated variance of the angle
  /// @param noise_rad2 variance of the white noise and of gaps
  constexpr ReferenceVerdict take_turn(float angle_rad, float variance_rad2, const Turn& turn,
                                       float noise_rad2) {
    return take(sensitivity(turn), angle_rad - scaled(turn.turn_rad), variance_rad2, turn,
                noise_rad2 + 2.0F * slope_variance_rad2_);
  }

  [[nodiscard]] constexpr bool has_heading() const { return state_.has_heading; }
  /// Time passed in which nothing was measured, or the axis was at full scale.
  constexpr void lose_heading() { state_.has_heading = false; }
  [[nodiscard]] constexpr float heading_rad(const Turn& ahead) const {
    return wrapped(state_.x[kHeading] + scaled(ahead.turn_rad));
  }
  /// @param ahead less than a tick, in which the error of the bias makes nothing of an angle
  [[nodiscard]] constexpr float heading_variance_rad2(const Turn& ahead) const {
    const auto& p = state_.covariance;
    const float m = scaled(ahead.turn_rad);
    const float known =
        p(kHeading, kHeading) + m * (m * p(kScale, kScale) - 2.0F * p(kHeading, kScale));
    return std::max(known, 0.0F) + slope_variance_rad2_;
  }
  /// Whether anything was learnt of the scale factor and the offset.
  [[nodiscard]] constexpr bool has_learnt() const { return state_.has_learnt; }
  [[nodiscard]] constexpr float scale_factor() const { return state_.x[kScale]; }
  [[nodiscard]] constexpr float scale_factor_variance() const {
    return state_.covariance(kScale, kScale);
  }
  /// How well the scale factor is known: 0 as before the first reference, 1 exactly.
  [[nodiscard]] constexpr float quality() const {
    if (!(variance_[kScale] > 0.0F)) return 1.0F;
    const float left = square_root(state_.covariance(kScale, kScale) / variance_[kScale]);
    return std::max(1.0F - left, 0.0F);
  }
  /// Offset that is to be taken off the rate in motion, with the bias since departure.
  [[nodiscard]] constexpr float bias_in_motion_rad_s() const {
    return state_.x[kOffset] + state_.x[kBias];
  }
  [[nodiscard]] constexpr float offset_rad_s() const { return state_.x[kOffset]; }
  [[nodiscard]] constexpr float offset_variance_rad2_s2() const {
    return state_.covariance(kOffset, kOffset);
  }
  /// Variance of the error of a bias in motion, of which the predictor states its own part.
  [[nodiscard]] constexpr float bias_variance_rad2_s2(float predicted_rad2_s2) const {
    if (!state_.has_learnt) return predicted_rad2_s2;
    const auto& p = state_.covariance;
    return std::min(predicted_rad2_s2 + state_.between_drives_rad2_s2 + p(kOffset, kOffset),
                    p(kBias, kBias) + 2.0F * p(kBias, kOffset) + p(kOffset, kOffset));
  }
  /// Variance of the error of a turn, beside that of the bias at rest, if no reference comes
  /// meanwhile: by the scale factor, the offset, and the bias in motion that another drive has not.
  [[nodiscard]] constexpr float turn_variance_rad2(const Turn& turn) const {
    return turn_variance_rad2(turn, turn.length_s * square_root(state_.between_drives_rad2_s2));
  }
  /// Likewise of the turn since departure: references in the drive have shown some of its bias.
  [[nodiscard]] constexpr float driven_variance_rad2(const Turn& since_departure) const {
    return turn_variance_rad2(since_departure, state_.drive_sigma_rad);
  }
  /// A turn by the scale factor that is known now.
  [[nodiscard]] constexpr float scaled(float turn_rad) const {
    return turn_rad / (1.0F + state_.x[kScale]);
  }
  [[nodiscard]] constexpr float unscaled(float turn_rad) const {
    return turn_rad * (1.0F + state_.x[kScale]);
  }
  /// Whether references and gyro cannot both be right.
  [[nodiscard]] constexpr bool disagrees() const { return state_.judge.disagrees(); }

 private:
  using Row = std::array<float, kStates>;

  /// @param drive_rad deviation by the bias in motion that another drive has not
  [[nodiscard]] constexpr float turn_variance_rad2(const Turn& turn, float drive_rad) const {
    const auto& p = state_.covariance;
    const float m = scaled(turn.turn_rad);
    const float slopes = 2.0F * slope_variance_rad2_;
    if (!state_.has_learnt) return m * m * p(kScale, kScale) + slopes;
    const float t = turn.length_s;
    const float lasting =
        m * m * p(kScale, kScale) + t * t * p(kOffset, kOffset) + 2.0F * m * t * p(kScale, kOffset);
    return std::max(lasting, 0.0F) + drive_rad * drive_rad + slopes;
  }
  /// Variance that slopes add to a reference. Those of the same slope share its error: as many as
  /// come within one count as one.
  [[nodiscard]] constexpr float slope_noise_rad2(float since_s) const {
    constexpr float kSlope_s = 10.0F;
    constexpr float kShortest_s = 0.1F;
    return slope_variance_rad2_ * std::max(kSlope_s / std::max(since_s, kShortest_s), 1.0F);
  }
  /// Growth of the variances from drive to drive: of the scale factor, and of the offset as a share
  /// of what was known of it at first.
  static constexpr float kScaleGrowth = 1e-4F * 1e-4F;
  static constexpr float kOffsetGrowth = 0.02F * 0.02F;

  [[nodiscard]] static constexpr float wrapped(float angle_rad) {
    constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;
    const float turns = angle_rad / kTurn;
    const auto whole = static_cast<std::int32_t>(turns + (turns < 0.0F ? -0.5F : 0.5F));
    return angle_rad - kTurn * static_cast<float>(whole);
  }
  /// Derivatives of a turn by the states.
  [[nodiscard]] constexpr Row sensitivity(const Turn& turn) const {
    return {0.0F, -scaled(turn.turn_rad), -turn.length_s, -turn.length_s};
  }
  [[nodiscard]] constexpr Row product(const Row& h) const {
    Row result{};
    for (std::size_t i = 0; i < kStates; ++i) {
      for (std::size_t j = 0; j < kStates; ++j) result[i] += state_.covariance(i, j) * h[j];
    }
    return result;
  }
  [[nodiscard]] static constexpr float dot(const Row& a, const Row& b) {
    float sum = 0.0F;
    for (std::size_t i = 0; i < kStates; ++i) sum += a[i] * b[i];
    return sum;
  }
  [[nodiscard]] constexpr float spread(const Row& h) const { return dot(h, product(h)); }

  /// Growth of the variance of the bias: as predicted, and after two minutes as in these. A bias
  /// that was followed for an hour goes on to wander, while that of the predictor has long done so.
  constexpr float bias_growth(float length_s, float variance_rad2_s2) {
    constexpr float kFresh_s = 120.0F;
    if (!is_finite(variance_rad2_s2)) return 0.0F;  // no bias was measured yet
    const float growth = std::max(variance_rad2_s2 - state_.bias_variance_rad2_s2, 0.0F);
    state_.bias_variance_rad2_s2 = std::max(variance_rad2_s2, state_.bias_variance_rad2_s2);
    state_.driven_s += length_s;
    if (state_.driven_s < kFresh_s) return growth;
    if (state_.drift_rad2_s3 == 0.0F) {
      state_.drift_rad2_s3 =
          (state_.bias_variance_rad2_s2 - state_.bias_variance_at_departure_rad2_s2) /
          state_.driven_s;
    }
    return std::max(growth, state_.drift_rad2_s3 * length_s);
  }
  constexpr ReferenceVerdict begin(float heading_rad, float variance_rad2) {
    for (std::size_t i = 0; i < kStates; ++i) state_.covariance(kHeading, i) = 0.0F;
    state_.covariance(kHeading, kHeading) =
        state_.judge.variance(variance_rad2) + slope_variance_rad2_;
    state_.x[kHeading] = wrapped(heading_rad);
    state_.has_heading = true;
    note_taken(variance_rad2, {});
    return ReferenceVerdict::begun;
  }
  constexpr void note_taken(float variance_rad2, const Turn& ahead) {
    state_.since = {-ahead.turn_rad, -ahead.length_s};
    state_.newest_variance_rad2 = variance_rad2;
  }
  /// A second reference of a stop has the error of the first one.
  [[nodiscard]] constexpr bool is_too_soon(const Turn& since, float variance_rad2) const {
    constexpr float kSoon_s = 0.5F;
    return since.length_s < kSoon_s && variance_rad2 > 0.25F * state_.newest_variance_rad2;
  }

  /// @param error_rad reference less expectation  @param since turn since the one before
  constexpr ReferenceVerdict take(const Row& h, float error_rad, float variance_rad2,
                                  const Turn& since, float noise_rad2) {
    const float noise = state_.judge.variance(variance_rad2);
    const float expected = spread(h) + noise_rad2 + noise;
    const float error = error_rad / square_root(expected);
    if (h[kHeading] != 0.0F) state_.judge.note_error(error);
    const bool is_far = error * error > ReferenceJudge::kGate;
    if (is_far && !can_tolerance_explain(error_rad * error_rad, expected, since)) {
      state_.judge.refuse(noise / expected, error);
      return ReferenceVerdict::refused;
    }
    const bool teaches = state_.judge.teaches();
    state_.judge.agree(noise / expected, error);
    if (is_far) doubt_what_was_learnt(h[kHeading], since);
    learn(h, error_rad, noise_rad2 + state_.judge.variance(variance_rad2), teaches);
    return ReferenceVerdict::learnt;
  }
  /// Whether an error is possible if nothing had been learnt of scale factor and offset.
  [[nodiscard]] constexpr bool can_tolerance_explain(float squared, float expected,
                                                     const Turn& since) const {
    constexpr float kLikely = 9.0F;
    const float m = scaled(since.turn_rad);
    const float t = since.length_s;
    return squared < kLikely * (expected + m * m * variance_[kScale] + t * t * variance_[kOffset]);
  }
  /// Adds the tolerance to what is known: what was learnt is wrong, or the reference is.
  constexpr void doubt_what_was_learnt(float heading_share, const Turn& since) {
    auto& p = state_.covariance;
    const Row f = sensitivity(since);
    for (const std::size_t i : {kScale, kOffset}) {
      const float added = std::max(variance_[i] - p(i, i), 0.0F);
      p(i, i) += added;
      if (heading_share == 0.0F) continue;
      p(kHeading, i) += f[i] * added;
      p(kHeading, kHeading) += f[i] * f[i] * added;
    }
    state_.judge.doubt();
  }
  /// Learns from the drive that is over how much its bias differed from that of the others (maximum
  /// likelihood, a step of Fisher's scoring). The guess before the first drive counts as much as
  /// one drive whose bias references have shown exactly.
  constexpr void learn_from_drive() {
    constexpr float kMost = 1e3F;
    const float prior = state_.bias_prior_rad2_s2;
    if (!state_.has_learnt || !(prior > 0.0F) || !(variance_[kBias] > 0.0F)) return;
    const float left = state_.covariance(kBias, kBias);
    const float shown = 1.0F - left / prior;
    const float guess = std::min(variance_[kBias] / prior, kMost);
    float& weight = state_.between_drives_weight;
    weight += shown * shown * (guess * guess - weight / LearntMotion::kMostDrives);
    const float surplus = state_.x[kBias] * state_.x[kBias] + left - prior;
    state_.between_drives_rad2_s2 =
        std::max(state_.between_drives_rad2_s2 + guess * guess * surplus / weight, 0.0F);
  }
  constexpr void learn(const Row& h, float error_rad, float variance_rad2, bool teaches) {
    const Row ph = product(h);
    const float expected = variance_rad2 + dot(h, ph);
    const std::size_t last = teaches ? kStates : std::size_t{1};
    for (std::size_t i = 0; i < last; ++i) {
      const float gain = ph[i] / expected;
      state_.x[i] += gain * error_rad;
      for (std::size_t j = 0; j < kStates; ++j) {
        if (j <= i || j >= last) state_.covariance(i, j) -= gain * ph[j];
      }
    }
    for (std::size_t i = 0; i < kStates; ++i) {
      state_.covariance(i, i) = std::max(state_.covariance(i, i), 0.0F);
    }
    state_.x[kHeading] = wrapped(state_.x[kHeading]);
    state_.has_learnt = state_.has_learnt || teaches;
    state_.lessons.references += teaches ? 1U : 0U;
  }

  Row variance_;  ///< variances before the first reference
  float scale_factor_per_k_;
  float slope_variance_rad2_;
  State state_{};
};

}  // namespace zerorate::core
