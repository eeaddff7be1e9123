#include "host_tools/lib/diagnose/result/diagnosis.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

namespace zerorate::diagnose {
namespace {

/// Surprisal beyond the threshold, by which effects are chosen; what was not examined has the
/// least.
double strength(const SelectionEvidence& evidence) {
  return evidence.not_examined.empty() ? evidence.gain_nats - evidence.price_nats
                                       : -std::numeric_limits<double>::infinity();
}

}  // namespace

std::string_view name(Verdict verdict) {
  switch (verdict) {
    case Verdict::consistent:
      return "consistent";
    case Verdict::explained:
      return "explained";
    case Verdict::unexplained:
      return "unexplained";
  }
  return "unexplained";
}

std::vector<Explanation> weigh(std::string_view best, double surprisal_nats,
                               std::span<const Alternative> rivals) {
  std::vector<Explanation> all{{std::string(best), 1.0}};
  for (const Alternative& rival : rivals) {
    all.push_back({rival.effect, std::exp(-rival.less_likely_by_nats)});
  }
  constexpr double kPlaces = 8.0;
  const double surprisal = std::max(1.0, surprisal_nats);
  all.push_back({std::string(kByChance), kPlaces * surprisal * std::exp(1.0 - surprisal)});
  double sum = 0.0;
  for (const Explanation& one : all) sum += one.probability;
  for (Explanation& one : all) one.probability /= sum;
  std::ranges::stable_sort(all, std::greater{}, &Explanation::probability);
  return all;
}

void add_stronger(std::vector<SelectionEvidence> more, std::vector<SelectionEvidence>& all) {
  for (SelectionEvidence& evidence : more) {
    const auto known = std::ranges::find(all, evidence.effect, &SelectionEvidence::effect);
    if (known == all.end()) {
      all.push_back(std::move(evidence));
    } else if (strength(evidence) > strength(*known)) {
      *known = std::move(evidence);
    }
  }
  std::ranges::stable_sort(all, std::greater{}, &SelectionEvidence::gain_nats);
}

std::vector<Explanation> set95_of(const std::vector<Explanation>& explanations) {
  std::vector<Explanation> set;
  double sum = 0.0;
  for (const Explanation& one : explanations) {
    if (sum >= 0.95) break;
    set.push_back(one);
    sum += one.probability;
  }
  return set;
}

}  // namespace zerorate::diagnose
