#include "host_tools/lib/diagnose/selection/selection.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"
#include "host_tools/lib/parallel/parallel.hpp"

namespace zerorate::diagnose {
namespace {

struct Proposal {
  const Effect* effect;
  Candidate candidate;
};

/// Effects, and which of them may be chosen.
struct Catalogue {
  std::span<const std::unique_ptr<Effect>> effects;
  Scope scope;
  bool is_noise_alone = false;  ///< only effects that are noise

  [[nodiscard]] bool searches(const Effect& effect) const {
    return scope.is_searched(effect) && (effect.is_noise() || !is_noise_alone);
  }
};

/// Candidates of all effects that are not in the hypothesis yet, most surprising first.
std::vector<Proposal> proposals_for(const Hypothesis& without, const Catalogue& catalogue) {
  std::vector<std::optional<Candidate>> candidates(catalogue.effects.size());
  const auto examine = [&](std::size_t i) {
    const Effect& effect = *catalogue.effects[i];
    const bool is_in = std::ranges::any_of(
        without.parts(), [&](const Part& part) { return part.effect == effect.name(); });
    if (!is_in && catalogue.searches(effect)) candidates[i] = effect.examine(without);
  };
  parallel::for_each(candidates.size(), parallel::kAllThreads, examine, {});
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Effect& effect = *catalogue.effects[i];
    // Skip fits that diverged.
    if (candidates[i] && std::isfinite(candidates[i]->surprisal_nats) &&
        catalogue.scope.holds(effect, *candidates[i])) {
      proposals.push_back({&effect, std::move(*candidates[i])});
    }
  }
  std::ranges::stable_sort(proposals, std::greater{}, [](const Proposal& proposal) {
    return proposal.candidate.surprisal_nats;
  });
  // A cause that was measured beside the rate and is beyond doubt goes before any that was searched
  // for: with enough of them those draw everything.
  const auto measured = std::ranges::find_if(proposals, [](const Proposal& proposal) {
    return is_beyond_doubt(*proposal.effect, proposal.candidate.surprisal_nats);
  });
  if (!without.parts().empty() && measured != proposals.end()) {
    std::rotate(proposals.begin(), measured, measured + 1);
  }
  return proposals;
}

bool is_surprising(const std::vector<Proposal>& proposals) {
  return !proposals.empty() &&
         proposals.front().candidate.surprisal_nats > kSelectionThreshold_nats;
}

/// Two effects, the second found beside the first. Each may hide the other: Gauss-Markov noise that
/// lowers the estimate of the slow noise, say, and a jump that raises it.
struct Couple {
  Proposal first;
  Hypothesis beside;             ///< with the first
  std::vector<Proposal> second;  ///< the most surprising one first

  /// Surprises along a chain add up; two choices cost once more than one.
  [[nodiscard]] double surprisal_nats() const {
    return first.candidate.surprisal_nats + second.front().candidate.surprisal_nats -
           kSelectionThreshold_nats;
  }
};

/// Couple that begins with a proposal; nothing if nothing is surprising beside it.
std::optional<Couple> couple_of(const Hypothesis& without, const Proposal& first,
                                const Catalogue& catalogue) {
  Hypothesis beside = without.with(first.candidate.part);
  std::vector<Proposal> second = proposals_for(beside, catalogue);
  if (!is_surprising(second)) return std::nullopt;
  return Couple{first, std::move(beside), std::move(second)};
}

/// Not plain to see.
bool is_subtle(const Choice& choice) {
  constexpr double kPlain = 200.0;  // nats
  return choice.surprisal_nats < kPlain;
}

/// The best proposal, beside the others. One that goes first although another is more surprising is
/// not measured against that one.
Choice choice_of(const std::vector<Proposal>& proposals) {
  const Proposal& best = proposals.front();
  Choice choice{best.effect, best.candidate.gain_nats, best.candidate.surprisal_nats, {}};
  std::vector<Alternative> rivals;
  for (const Proposal& rival : std::span(proposals).subspan(1)) {
    const double behind = best.candidate.surprisal_nats - rival.candidate.surprisal_nats;
    if (std::abs(behind) <= kAlternativeNats) {
      choice.alternatives.push_back({std::string(rival.effect->name()), behind});
    }
    if (behind >= 0.0) rivals.push_back({std::string(rival.effect->name()), behind});
  }
  choice.explanations = weigh(best.effect->name(), choice.surprisal_nats, rivals);
  return choice;
}

class Selector {
 public:
  Selector(const FitData& data, const Catalogue& catalogue)
      : data_(data), catalogue_(catalogue), state_(data, {}) {}

  /// Begins with choices that stay.
  /// @param parts  of the choices, of values
  void keep(std::vector<Choice> choices, std::vector<Part> parts) {
    choices_ = std::move(choices);
    kept_ = choices_.size();
    state_ = Hypothesis(data_, std::move(parts), &state_);
  }

  Selection select() {
    Selection selection;
    std::vector<Proposal> proposals = proposals_for(state_, catalogue_);
    selection.evidence = evidence_of(proposals);
    add_not_examined(selection.evidence);
    grow(std::move(proposals));
    if (split()) grow(proposals_for(state_, catalogue_));
    selection.parts = state_.parts();
    for (Part& part : selection.parts) {
      if (!part.starts.empty()) part.starts = {state_.noise().spectrum};
    }
    selection.choices = choices_;
    mark_selected(selection);
    selection.log_likelihood = state_.log_likelihood();
    return selection;
  }

 private:
  /// True if more choices fit. Kept slow choices do not count towards kMostCauses.
  [[nodiscard]] bool has_room(std::size_t more = 1) const {
    return diagnose::has_room(std::span(state_.parts()).subspan(kept_),
                              std::span(choices_).subspan(kept_), more);
  }

  void grow(std::vector<Proposal> proposals) {
    while (has_room()) {
      if (is_surprising(proposals)) {
        add(proposals);
      } else if (const std::optional<Couple> couple = surprising_couple(proposals)) {
        add(*couple);
      } else {
        return;
      }
      if (choices_.size() > kept_ + 1) reconsider();
      if (has_room()) proposals = proposals_for(state_, catalogue_);
    }
  }

  /// The most surprising couple of effects, where neither is surprising by itself and there is room
  /// for both.
  /// @param proposals  for the state
  [[nodiscard]] std::optional<Couple> surprising_couple(
      const std::vector<Proposal>& proposals) const {
    constexpr std::size_t kMostFirst = 3;
    if (!has_room(2)) return std::nullopt;
    std::optional<Couple> best;
    double most = kSelectionThreshold_nats;
    for (const Proposal& first :
         std::span(proposals).first(std::min(kMostFirst, proposals.size()))) {
      if (first.candidate.surprisal_nats < 0.5 * kSelectionThreshold_nats) break;
      std::optional<Couple> couple = couple_of(state_, first, catalogue_);
      if (!couple || couple->surprisal_nats() <= most || !stands_beside_second(*couple)) continue;
      most = couple->surprisal_nats();
      best = std::move(couple);
    }
    return best;
  }

  /// The first effect needs the second to be seen, and not only the other way round.
  [[nodiscard]] bool stands_beside_second(const Couple& couple) const {
    const Hypothesis with_second = state_.with(couple.second.front().candidate.part);
    const std::optional<Candidate> first = couple.first.effect->examine(with_second);
    return first && first->surprisal_nats > kSelectionThreshold_nats;
  }

  void add(const std::vector<Proposal>& proposals) {
    choices_.push_back(choice_of(proposals));
    state_ = state_.with(proposals.front().candidate.part);
  }

  void add(const Couple& couple) {
    const Candidate& first = couple.first.candidate;
    choices_.push_back({couple.first.effect, first.gain_nats, first.surprisal_nats, {}});
    state_ = couple.beside;
    add(couple.second);
  }

  /// Each part but the latest and those that stay, beside all others; but what is plain to see only
  /// beside the like of it.
  void reconsider() {
    const bool is_subtle_added = is_subtle(choices_.back());
    std::size_t i = kept_;
    for (std::size_t left = choices_.size() - 1 - kept_; left > 0; --left) {
      if ((is_subtle_added && !is_subtle(choices_[i])) || stands_beside_latest(i)) {
        ++i;
        continue;
      }
      const Hypothesis without = without_part(i);
      const std::vector<Proposal> proposals = proposals_for(without, catalogue_);
      choices_.erase(choices_.begin() + static_cast<std::ptrdiff_t>(i));
      state_ = without;
      if (is_surprising(proposals)) add(proposals);
      // The added part stands last now, so that the next earlier one is at place i again.
    }
  }

  /// A cause that was measured beside the rate and is beyond doubt may be the shadow of one other,
  /// but not of several functions of time and slow noise: with enough of them those draw it too.
  [[nodiscard]] bool stands_beside_latest(std::size_t i) const {
    const Choice& choice = choices_[i];
    if (!is_beyond_doubt(*choice.effect, choice.surprisal_nats)) return false;
    std::vector<Part> others;
    for (std::size_t j = 0; j < choices_.size(); ++j) {
      const bool is_latest = j + 1 == choices_.size();
      if (j != i && (is_latest || !is_slow(state_.parts()[j]))) others.push_back(state_.parts()[j]);
    }
    const std::optional<Candidate> candidate =
        choice.effect->examine(Hypothesis(data_, std::move(others), &state_));
    return candidate && candidate->surprisal_nats > kSelectionThreshold_nats;
  }

  [[nodiscard]] Hypothesis without_part(std::size_t i) const {
    std::vector<Part> others = state_.parts();
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    return {data_, std::move(others), &state_};
  }

  /// One slow noise may describe two effects so well that beside it neither of them adds much: a
  /// function of the temperature and another noise, or a random walk and Gauss-Markov noise. So two
  /// are tried in its place. True if something was changed.
  bool split() {
    for (std::size_t i = kept_; i < choices_.size() && has_room(); ++i) {
      if (state_.parts()[i].terms.has_slow_noise() && split(i)) return true;
    }
    return false;
  }

  bool split(std::size_t i) {
    const Hypothesis without = without_part(i);
    const Choice one = choices_[i];
    const std::optional<Candidate> whole = one.effect->examine(without);
    if (!whole) return false;
    for (const auto& effect : catalogue_.effects) {
      const bool is_tried = effect->has_measured_cause() || effect->is_noise();
      if (!is_tried || !catalogue_.searches(*effect) || is_chosen(*effect)) continue;
      std::optional<Candidate> first = effect->examine(without);
      if (!first || !(first->surprisal_nats > kSelectionThreshold_nats)) continue;
      Catalogue seconds = catalogue_;
      seconds.is_noise_alone = effect->is_noise();
      const auto couple = couple_of(without, {effect.get(), *std::move(first)}, seconds);
      if (!couple || couple->surprisal_nats() <= whole->surprisal_nats) continue;
      choices_.erase(choices_.begin() + static_cast<std::ptrdiff_t>(i));
      add(*couple);
      add_alternative(*one.effect, couple->surprisal_nats() - whole->surprisal_nats);
      reconsider();
      return true;
    }
    return false;
  }

  [[nodiscard]] bool is_chosen(const Effect& effect) const {
    return std::ranges::find(choices_, &effect, &Choice::effect) != choices_.end();
  }

  /// Names the part beside the latest choice, if it is near and not named there yet.
  void add_alternative(const Effect& effect, double behind) {
    std::vector<Alternative>& known = choices_.back().alternatives;
    if (behind > kAlternativeNats || effect.name() == choices_.back().effect->name() ||
        std::ranges::find(known, effect.name(), &Alternative::effect) != known.end()) {
      return;
    }
    known.push_back({std::string(effect.name()), behind});
    std::ranges::stable_sort(known, {}, &Alternative::less_likely_by_nats);
    Choice& latest = choices_.back();
    latest.explanations = weigh(latest.effect->name(), latest.surprisal_nats, known);
  }

  static std::vector<SelectionEvidence> evidence_of(const std::vector<Proposal>& proposals) {
    std::vector<SelectionEvidence> all;
    all.reserve(proposals.size());
    for (const Proposal& proposal : proposals) {
      const Candidate& candidate = proposal.candidate;
      all.push_back({std::string(proposal.effect->name()),
                     candidate.gain_nats,
                     kSelectionThreshold_nats + candidate.gain_nats - candidate.surprisal_nats,
                     false,
                     {}});
    }
    return all;
  }

  void add_not_examined(std::vector<SelectionEvidence>& all) const {
    for (const auto& effect : catalogue_.effects) {
      if (!catalogue_.scope.is_searched(*effect)) continue;
      const std::string_view obstacle = effect->obstacle(state_);
      if (obstacle.empty()) continue;
      all.push_back({.effect = std::string(effect->name()), .not_examined = std::string(obstacle)});
    }
  }

  const FitData& data_;
  Catalogue catalogue_;
  Hypothesis state_;
  std::vector<Choice> choices_;
  std::size_t kept_ = 0;  ///< choices that stay
};

}  // namespace

bool is_beyond_doubt(const Effect& effect, double surprisal_nats) {
  constexpr double kBeyondDoubt = 50.0;  // nats
  return effect.has_measured_cause() && surprisal_nats > kBeyondDoubt;
}

bool is_slow(const Part& part) {
  return !part.columns.empty() || part.terms.has_slow_noise();
}

bool has_room(std::span<const Part> parts, std::span<const Choice> choices, std::size_t more) {
  std::size_t taken = 0;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (is_subtle(choices[i]) || is_slow(parts[i])) ++taken;
  }
  return taken + more <= kMostCauses;
}

void mark_selected(Selection& selection) {
  for (SelectionEvidence& evidence : selection.evidence) {
    evidence.selected = std::ranges::any_of(selection.choices, [&](const Choice& choice) {
      return choice.effect->name() == evidence.effect;
    });
  }
}

bool Scope::is_searched(const Effect& effect) const {
  return pace == Pace::either || effect.pace() == Pace::either || effect.pace() == pace;
}

bool Scope::holds(const Effect& effect, const Candidate& candidate) const {
  if (pace == Pace::either || effect.pace() != Pace::either) return true;
  return (candidate.time_scale_s >= slow_from_s) == (pace == Pace::slow);
}

Selection select_effects(const FitData& data, std::span<const std::unique_ptr<Effect>> effects,
                         const Scope& scope) {
  return Selector(data, {effects, scope}).select();
}

Part carried_over(Part part, const FitData& means, const FitData& values) {
  for (Column& column : part.columns) column = column_of_values(values, means, column);
  for (NoiseSpectrum& start : part.starts) {
    start = start.of_single_values(means.period_s() / values.period_s());
  }
  return part;
}

Selection select_beside(const FitData& values, std::span<const std::unique_ptr<Effect>> effects,
                        const Scope& scope, const FitData& means, Selection chosen) {
  for (Part& part : chosen.parts) part = carried_over(std::move(part), means, values);
  for (Choice& choice : chosen.choices) choice.is_of_means = true;
  Selector selector(values, {effects, scope});
  selector.keep(std::move(chosen.choices), std::move(chosen.parts));
  Selection selection = selector.select();
  add_stronger(std::move(chosen.evidence), selection.evidence);
  mark_selected(selection);
  return selection;
}

}  // namespace zerorate::diagnose
