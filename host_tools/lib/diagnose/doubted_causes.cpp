#include "host_tools/lib/diagnose/doubted_causes.hpp"

#include <algorithm>
#include <functional>
#include <string>

namespace zerorate::diagnose {
namespace {

bool is_slow_and_inferred(const Choice& choice, const Part& part) {
  return is_slow(part) && !choice.effect->has_measured_cause();
}

void add_explanation(Choice& choice) {
  auto& all = choice.explanations;
  if (all.empty()) all.push_back({std::string(choice.effect->name()), 1.0});
  for (Explanation& one : all) one.probability *= 0.5;
  all.push_back({std::string(kByBiasTakenOut), 0.5});
  std::ranges::stable_sort(all, std::greater{}, &Explanation::probability);
}

}  // namespace

void doubt_many_slow_causes(const std::vector<Choice>& choices, const Hypothesis& hypothesis,
                            Adequacy& adequacy) {
  constexpr std::size_t kTooMany = 3;
  std::size_t slow = 0;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (is_slow_and_inferred(choices[i], hypothesis.parts()[i])) ++slow;
  }
  if (slow < kTooMany) return;
  adequacy.holds = false;
  adequacy.failures.emplace_back(
      "three slow effects at once would be needed, and so many can draw any recording");
}

void doubt_causes_after_correction(std::vector<Choice>& choices, const Hypothesis& hypothesis,
                                   Adequacy& adequacy) {
  bool is_any = false;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (!is_slow_and_inferred(choices[i], hypothesis.parts()[i])) continue;
    is_any = true;
    add_explanation(choices[i]);
  }
  if (!is_any) return;
  adequacy.holds = false;
  adequacy.failures.insert(adequacy.failures.begin(),
                           "the mean is so near zero that a bias was likely taken out upstream, "
                           "and slow noise with it");
}

}  // namespace zerorate::diagnose
