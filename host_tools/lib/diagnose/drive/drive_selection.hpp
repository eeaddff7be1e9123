/// @file
/// Choice of the effects that explain the errors of drives.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host_tools/lib/diagnose/drive/motion_effect.hpp"

namespace zerorate::diagnose {

/// An effect in the place that it has beside others.
struct MotionChoice {
  const MotionEffect* effect = nullptr;
  Variant variant;
  double gain_nats = 0.0;       ///< log likelihood that is lost without it
  double surprisal_nats = 0.0;  ///< log of the odds of such a gain by chance, its variants counted
  double evidence_nats = 0.0;   ///< gain less what the freedom of its coefficients costs
};

/// Effects beside each other.
struct MotionSet {
  std::vector<MotionChoice> choices;  ///< each weighed beside those before it
  double evidence_nats = 0.0;
};

class MotionSelection {
 public:
  MotionSelection(const DriveRecord& record,
                  std::span<const std::unique_ptr<MotionEffect>> effects);

  /// The likeliest set of at most three effects that are all plain beside each other. Each comes as
  /// a surprise beside those before it, or two at once do: one may hide the other.
  [[nodiscard]] std::vector<MotionChoice> choose() const;
  /// Every effect that can be examined, in its best variant beside those that are chosen; the most
  /// likely one first.
  [[nodiscard]] std::vector<MotionChoice> examine(const std::vector<MotionChoice>& chosen) const;
  /// A choice, weighed beside the others.
  [[nodiscard]] MotionChoice weighed(const MotionEffect& effect, const Variant& variant,
                                     const std::vector<MotionChoice>& others) const;
  /// Variants of an effect that the record can show.
  [[nodiscard]] const std::vector<Variant>& variants_of(const MotionEffect& effect) const;
  [[nodiscard]] DriveFit fit(const std::vector<MotionChoice>& choices) const;

 private:
  /// An effect that the record can show.
  struct Candidate {
    const MotionEffect* effect = nullptr;
    std::vector<Variant> variants;
  };

  /// Adds every set that a set and candidates from the first-th on make.
  void grow(const MotionSet& set, std::size_t first, std::vector<MotionSet>& sets) const;
  /// The choices, each weighed beside all others.
  [[nodiscard]] std::vector<MotionChoice> weighed_together(
      const std::vector<MotionChoice>& set) const;
  [[nodiscard]] bool is_plain(const MotionChoice& choice,
                              const std::vector<MotionChoice>& others) const;
  /// Log of the odds of what two effects gain by chance, as many pairs counted as there are.
  [[nodiscard]] double surprisal_of_pair(const MotionChoice& one, const MotionChoice& other,
                                         const std::vector<MotionChoice>& others) const;
  /// Whether steps of one surprising effect, or of two at once, lead to a set.
  [[nodiscard]] bool is_reached(const std::vector<MotionChoice>& set) const;
  /// Whether a choice is still surprising with any one drive left out: a single drive in which the
  /// reference is at fault makes no cause.
  [[nodiscard]] bool rests_on_many_drives(const MotionChoice& choice,
                                          const std::vector<MotionChoice>& others) const;

  const DriveRecord& record_;
  double effects_;  ///< number of all effects
  std::vector<Candidate> candidates_;
  DriveRegression regression_;
};

/// Shares of some rows.
[[nodiscard]] Share picked(const Share& share, const std::vector<std::size_t>& rows);

/// Shares of all choices side by side.
[[nodiscard]] Share joint_share(const std::vector<MotionChoice>& choices,
                                const DriveRecord& record);

/// The choices without one of them.
[[nodiscard]] std::vector<MotionChoice> without(const std::vector<MotionChoice>& choices,
                                                std::size_t left_out);

}  // namespace zerorate::diagnose
