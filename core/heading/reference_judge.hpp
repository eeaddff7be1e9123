/// @file
/// Trust in references of the heading, by their errors.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/base/numeric.hpp"

namespace zerorate::core {

/// Outcome of a reference.
enum class ReferenceVerdict : std::uint8_t {
  learnt,    ///< it agrees, and was learnt from
  begun,     ///< a beginning, nothing to compare: the source is new, or has jumped
  too_soon,  ///< hardly anything was turned since the reference before
  refused,   ///< too far from what was expected: it jumps, comes late or has another sense
  no_bias,   ///< no stop was learnt from, or the turn is not known
  bad_time,  ///< later than the newest sample, or further back than is remembered
};

/// Follows how large the errors of references are, whether they are noise, and whether references
/// and gyro can both be right. An error counts in standard deviations of what was expected.
///
/// The stated variance is multiplied by a factor that is learnt: it begins at 9, because many
/// receivers state too little. Noise changes its sign. Errors of one sign, again and again, are a
/// jump of the references or a wrong lesson. docs/design/references.md.
class ReferenceJudge {
 public:
  static constexpr float kGate = 12.0F;  ///< normalised error squared that is refused

  struct State {
    float noise_factor = 9.0F;  ///< variance of the references over the stated one
    float noise_weight = 1.0F;  ///< references that the factor rests on
    float lean = 0.0F;          ///< mean of the newest normalised errors
    float compared_s = 0.0F;    ///< time in motion since the first reference, up to the newest
    std::uint8_t unsure = 0;    ///< references that will not teach, because the ones before jumped
    std::uint8_t doubt = 0;     ///< three for each that was refused; one that agrees takes one off

    constexpr bool operator==(const State&) const = default;
  };

  constexpr ReferenceJudge() = default;
  constexpr explicit ReferenceJudge(const State& state) : state_(state) {}

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr bool operator==(const ReferenceJudge&) const = default;
  /// Whether memory from outside may be such a judge.
  [[nodiscard]] bool is_possible() const {
    return state_.noise_factor >= 1.0F && state_.noise_factor <= kMostFactor &&
           state_.noise_weight >= 1.0F && state_.noise_weight <= kMostWeight &&
           are_plausible(std::array{state_.lean}) && is_plausible_variance(state_.compared_s);
  }

  /// Variance of a reference that states one.
  [[nodiscard]] constexpr float variance(float stated) const {
    return state_.noise_factor * stated;
  }
  /// Whether a new source may still be aligning: many do so in the first minutes of motion.
  [[nodiscard]] constexpr bool is_new() const { return state_.compared_s < kAligning_s; }
  [[nodiscard]] constexpr bool teaches() const { return state_.unsure == 0; }
  /// Whether the newest errors have one sign.
  [[nodiscard]] constexpr bool leans() const {
    constexpr float kMost = 1.5F;  // six standard deviations of such a mean
    return state_.lean > kMost || state_.lean < -kMost;
  }
  /// Whether references and gyro cannot both be right.
  [[nodiscard]] constexpr bool disagrees() const { return state_.doubt >= kDoubtful; }

  /// A reference was compared after so long a motion.
  constexpr void note_compared(float length_s) {
    if (is_new()) state_.compared_s += std::max(length_s, 0.0F);
  }
  /// An error of a heading, in standard deviations.
  constexpr void note_error(float error) {
    constexpr float kShare = 0.125F;
    constexpr float kMostOfOne = 3.5F;  // the root of the gate
    state_.lean += kShare * (std::clamp(error, -kMostOfOne, kMostOfOne) - state_.lean);
  }
  /// A reference that agrees.
  /// @param share of the references in what was expected
  /// @param error in standard deviations
  constexpr void agree(float share, float error) {
    follow_noise(share, error);
    if (state_.unsure > 0) --state_.unsure;
    if (state_.doubt > 0) --state_.doubt;
  }
  /// A reference that is too far off.
  constexpr void refuse(float share, float error) {
    if (error * state_.lean <= 0.0F) follow_noise(share, error);
    add(3, kMostDoubt, state_.doubt);
    add(8, kMostUnsure, state_.unsure);
  }
  /// The references begin anew after a jump.
  constexpr void note_jump() {
    state_.lean = 0.0F;
    add(30, kMostUnsure, state_.unsure);
  }
  /// Either what was learnt is wrong, or the references are.
  constexpr void doubt() { add(2 * kDoubtful, kMostDoubt, state_.doubt); }

 private:
  static constexpr float kAligning_s = 180.0F;
  static constexpr std::uint8_t kDoubtful = 4;  ///< doubt from which references disagree
  static constexpr std::uint8_t kMostDoubt = 16;
  static constexpr std::uint8_t kMostUnsure = 240;
  static constexpr float kMostFactor = 400.0F;
  static constexpr float kMostWeight = 32.0F;

  static constexpr void add(int more, int most, std::uint8_t& count) {
    count = static_cast<std::uint8_t>(std::min(count + more, most));
  }
  /// Learns the factor of the references' variance (maximum likelihood, a step of Newton's).
  constexpr void follow_noise(float share, float error) {
    state_.noise_weight = std::min(state_.noise_weight + share * share, kMostWeight);
    const float change = share * (std::min(error * error, kGate) - 1.0F) / state_.noise_weight;
    state_.noise_factor = std::clamp(state_.noise_factor * (1.0F + change), 1.0F, kMostFactor);
  }

  State state_{};
};

}  // namespace zerorate::core
