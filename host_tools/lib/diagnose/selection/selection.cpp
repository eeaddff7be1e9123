#include "host_tools/lib/diagnose/selection/selection.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace zerorate::diagnose {
namespace {

struct Candidate {
  const Effect* effect;
  Offer offer;
};

/// What every effect that is not in the hypothesis yet has to offer, most surprising first.
std::vector<Candidate> candidates_for(const Explanation& without,
                                      std::span<const std::unique_ptr<Effect>> effects) {
  std::vector<Candidate> candidates;
  for (const auto& effect : effects) {
    const bool is_in = std::ranges::any_of(
        without.parts(), [&](const Part& part) { return part.effect == effect->name(); });
    if (is_in) continue;
    std::optional<Offer> offer = effect->examine(without);
    // A fit that ran away is no offer.
    if (offer && std::isfinite(offer->surprise_nats))
      candidates.push_back({effect.get(), std::move(*offer)});
  }
  std::ranges::stable_sort(candidates, std::greater{}, [](const Candidate& candidate) {
    return candidate.offer.surprise_nats;
  });
  // A cause that was measured beside the rate and is beyond doubt goes before any that was searched
  // for: with enough of them those draw everything.
  const auto measured = std::ranges::find_if(candidates, [](const Candidate& candidate) {
    return is_beyond_doubt(*candidate.effect, candidate.offer.surprise_nats);
  });
  if (!without.parts().empty() && measured != candidates.end()) {
    std::rotate(candidates.begin(), measured, measured + 1);
  }
  return candidates;
}

bool is_surprising(const std::vector<Candidate>& candidates) {
  return !candidates.empty() && candidates.front().offer.surprise_nats > kLeastSurprise;
}

/// Not plain to see.
bool is_subtle(const Choice& choice) {
  constexpr double kPlain = 200.0;  // nats
  return choice.surprise_nats < kPlain;
}

Choice choice_of(const std::vector<Candidate>& candidates) {
  const Candidate& best = candidates.front();
  Choice choice{best.effect, best.offer.gain_nats, best.offer.surprise_nats, {}};
  for (const Candidate& rival : std::span(candidates).subspan(1)) {
    const double behind = best.offer.surprise_nats - rival.offer.surprise_nats;
    if (std::abs(behind) > kAlternativeNats) continue;
    choice.alternatives.push_back({std::string(rival.effect->name()), behind});
  }
  return choice;
}

class Selector {
 public:
  Selector(const Problem& problem, std::span<const std::unique_ptr<Effect>> effects)
      : problem_(problem), effects_(effects), state_(problem, {}) {}

  Selection select() {
    Selection selection;
    std::vector<Candidate> candidates = candidates_for(state_, effects_);
    selection.evidence = evidence_of(candidates);
    grow(std::move(candidates));
    if (split()) grow(candidates_for(state_, effects_));
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
  [[nodiscard]] bool has_room() const { return diagnose::has_room(state_.parts(), choices_); }

  void grow(std::vector<Candidate> candidates) {
    while (has_room() && is_surprising(candidates)) {
      add(candidates);
      if (choices_.size() > 1) reconsider();
      if (has_room()) candidates = candidates_for(state_, effects_);
    }
  }

  void add(const std::vector<Candidate>& candidates) {
    std::vector<Part> parts = state_.parts();
    parts.push_back(candidates.front().offer.part);
    choices_.push_back(choice_of(candidates));
    state_ = Explanation(problem_, std::move(parts), &state_);
  }

  /// Each part but the latest, beside all others; but what is plain to see only beside the like of
  /// it.
  void reconsider() {
    const bool is_subtle_added = is_subtle(choices_.back());
    std::size_t i = 0;
    for (std::size_t left = choices_.size() - 1; left > 0; --left) {
      if ((is_subtle_added && !is_subtle(choices_[i])) || stands_beside_latest(i)) {
        ++i;
        continue;
      }
      const Explanation without = without_part(i);
      const std::vector<Candidate> candidates = candidates_for(without, effects_);
      choices_.erase(choices_.begin() + static_cast<std::ptrdiff_t>(i));
      state_ = without;
      if (is_surprising(candidates)) add(candidates);
      // What was added stands last now, so that the next earlier one is at place i again.
    }
  }

  /// A cause that was measured beside the rate and is beyond doubt may be the shadow of one other,
  /// but not of several functions of time and slow noise: with enough of them those draw it too.
  [[nodiscard]] bool stands_beside_latest(std::size_t i) const {
    const Choice& choice = choices_[i];
    if (!is_beyond_doubt(*choice.effect, choice.surprise_nats)) return false;
    std::vector<Part> others;
    for (std::size_t j = 0; j < choices_.size(); ++j) {
      const bool is_latest = j + 1 == choices_.size();
      if (j != i && (is_latest || !is_slow(state_.parts()[j]))) others.push_back(state_.parts()[j]);
    }
    const std::optional<Offer> offer =
        choice.effect->examine(Explanation(problem_, std::move(others), &state_));
    return offer && offer->surprise_nats > kLeastSurprise;
  }

  [[nodiscard]] Explanation without_part(std::size_t i) const {
    std::vector<Part> others = state_.parts();
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    return {problem_, std::move(others), &state_};
  }

  /// One slow noise may describe a function of the temperature and another noise so well that
  /// beside it neither of the two adds much. So what was measured beside the rate is tried in its
  /// place, with the best part that is then left. True if something was changed.
  bool split() {
    for (const auto& effect : effects_) {
      if (!effect->is_measured()) continue;
      for (std::size_t i = 0; i < choices_.size() && has_room(); ++i) {
        if (state_.parts()[i].terms.wanders() && split(i, *effect)) return true;
      }
    }
    return false;
  }

  bool split(std::size_t i, const Effect& measured) {
    if (std::ranges::find(choices_, &measured, &Choice::effect) != choices_.end()) return false;
    const Explanation without = without_part(i);
    const Choice one = choices_[i];
    const std::optional<Offer> whole = one.effect->examine(without);
    const std::optional<Offer> first = measured.examine(without);
    if (!whole || !first || !(first->surprise_nats > kLeastSurprise)) return false;
    std::vector<Part> parts = without.parts();
    parts.push_back(first->part);
    Explanation beside(problem_, std::move(parts), &without);
    const std::vector<Candidate> second = candidates_for(beside, effects_);
    if (!is_surprising(second)) return false;
    // Surprises along a chain add up; two choices cost once more than one.
    const double better = first->surprise_nats + second.front().offer.surprise_nats -
                          kLeastSurprise - whole->surprise_nats;
    if (better <= 0.0) return false;
    choices_.erase(choices_.begin() + static_cast<std::ptrdiff_t>(i));
    choices_.push_back({&measured, first->gain_nats, first->surprise_nats, {}});
    state_ = std::move(beside);
    add(second);
    add_alternative(*one.effect, better);
    reconsider();
    return true;
  }

  /// To the latest choice, if it is near and not named there yet.
  void add_alternative(const Effect& effect, double behind) {
    std::vector<Alternative>& known = choices_.back().alternatives;
    if (behind > kAlternativeNats || effect.name() == choices_.back().effect->name() ||
        std::ranges::find(known, effect.name(), &Alternative::effect) != known.end()) {
      return;
    }
    known.push_back({std::string(effect.name()), behind});
    std::ranges::stable_sort(known, {}, &Alternative::behind_nats);
  }

  static std::vector<Evidence> evidence_of(const std::vector<Candidate>& candidates) {
    std::vector<Evidence> all;
    all.reserve(candidates.size());
    for (const Candidate& candidate : candidates) {
      const Offer& offer = candidate.offer;
      all.push_back({std::string(candidate.effect->name()),
                     offer.gain_nats,
                     kLeastSurprise + offer.gain_nats - offer.surprise_nats,
                     false,
                     {}});
    }
    return all;
  }

  const Problem& problem_;
  std::span<const std::unique_ptr<Effect>> effects_;
  Explanation state_;
  std::vector<Choice> choices_;
};

}  // namespace

bool is_beyond_doubt(const Effect& effect, double surprise_nats) {
  constexpr double kBeyondDoubt = 50.0;  // nats
  return effect.is_measured() && surprise_nats > kBeyondDoubt;
}

bool is_slow(const Part& part) {
  return !part.columns.empty() || part.terms.wanders();
}

bool has_room(std::span<const Part> parts, std::span<const Choice> choices) {
  std::size_t taken = 0;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (is_subtle(choices[i]) || is_slow(parts[i])) ++taken;
  }
  return taken < kMostCauses;
}

void mark_selected(Selection& selection) {
  for (Evidence& evidence : selection.evidence) {
    evidence.selected = std::ranges::any_of(selection.choices, [&](const Choice& choice) {
      return choice.effect->name() == evidence.effect;
    });
  }
}

Selection select_effects(const Problem& problem, std::span<const std::unique_ptr<Effect>> effects) {
  return Selector(problem, effects).select();
}

}  // namespace zerorate::diagnose
