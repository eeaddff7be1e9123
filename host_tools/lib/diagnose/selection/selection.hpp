/// @file
/// Selection of the effects that a record needs: forward selection with second thoughts.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/diagnose/effects/effect.hpp"
#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// Least surprisal of an effect that is selected [nats]. Of 18 effects together one is found by
/// chance in some 180 clean recordings: 18 exp(-8.1) = 1 / 183.
inline constexpr double kSelectionThreshold_nats = 8.1;

/// A chosen effect, and the effects that could take its place.
struct Choice {
  const Effect* effect = nullptr;
  double gain_nats = 0.0;
  double surprisal_nats = 0.0;
  std::vector<Alternative> alternatives;
  std::vector<Explanation> explanations = {};  ///< fitted explanations, weighed; see weigh()
  std::size_t axes = 1;                        ///< axes that gain and surprise hold for
  bool is_of_means = false;                    ///< it was chosen for means of the record
  bool in_model = true;                        ///< it is an extension of the model that is written
  std::string left_out_because;                ///< reason where it is not
  std::optional<statistics::BootstrapFigure> heading_drift_ratio{};  ///< see Cause

  /// Price: the gain had to exceed it.
  [[nodiscard]] double price_nats() const {
    return kSelectionThreshold_nats + gain_nats - surprisal_nats;
  }
};

/// Effects that a record needs. It outlives the data, and the parts bring the starts from which an
/// hypothesis of them is found at once.
struct Selection {
  std::vector<Part> parts;
  std::vector<Choice> choices;  ///< one for each part, in their order
  std::vector<SelectionEvidence>
      evidence;  ///< evidence for each effect on its own, strongest first
  double log_likelihood = 0.0;
};

/// True if the cause was measured beside the rate and the part is beyond doubt.
[[nodiscard]] bool is_beyond_doubt(const Effect& effect, double surprisal_nats);

/// A function of time or noise that a bias wanders by.
[[nodiscard]] bool is_slow(const Part& part);

/// True while so many more causes may be added. Obvious causes that are neither functions of time
/// nor slow noise do not count towards the limit: they cannot fit arbitrary data.
[[nodiscard]] bool has_room(std::span<const Part> parts, std::span<const Choice> choices,
                            std::size_t more = 1);

/// Marks the evidence of the effects that were chosen.
void mark_selected(Selection& selection);

/// Effects that a selection may choose: those of one pace. An effect of either pace belongs to the
/// scale on which its candidate changes.
struct Scope {
  Pace pace = Pace::either;  ///< either: all effects
  double slow_from_s = 0.0;  ///< time scale from which on a candidate is slow

  [[nodiscard]] bool is_searched(const Effect& effect) const;
  [[nodiscard]] bool holds(const Effect& effect, const Candidate& candidate) const;
};

/// Adds the most surprising effect until none is surprising enough, or there is no room. After each
/// addition every earlier effect is examined again beside the others: it goes if they have made it
/// superfluous, and another takes its place if that explains more.
[[nodiscard]] Selection select_effects(const FitData& data,
                                       std::span<const std::unique_ptr<Effect>> effects,
                                       const Scope& scope = {});

/// Part for the values of a record, of one that was fitted to their means.
[[nodiscard]] Part carried_over(Part part, const FitData& means, const FitData& values);

/// Selects effects of the values of a record beside those that were chosen for their means, which
/// stay. Evidence of an effect of either pace is that of the scale on which it is stronger.
/// @param chosen  for the means
[[nodiscard]] Selection select_beside(const FitData& values,
                                      std::span<const std::unique_ptr<Effect>> effects,
                                      const Scope& scope, const FitData& means, Selection chosen);

}  // namespace zerorate::diagnose
