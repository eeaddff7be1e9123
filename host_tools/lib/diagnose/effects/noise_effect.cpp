#include "host_tools/lib/diagnose/effects/noise_effect.hpp"

#include <utility>
#include <vector>

namespace zerorate::diagnose {
namespace {

Hypothesis joined(const Hypothesis& without, const Part& part) {
  std::vector<Part> parts = without.parts();
  parts.push_back(part);
  return {without.data(), std::move(parts), &without};
}

}  // namespace

Candidate candidate_with(const Hypothesis& without, Part part) {
  const Hypothesis with = joined(without, part);
  return {std::move(part), with.log_likelihood() - without.log_likelihood(), 0.0};
}

Candidate placed_candidate(const Hypothesis& without, Part part) {
  const Hypothesis with = joined(without, part);
  part.starts = {with.noise().spectrum};
  return {std::move(part), with.log_likelihood() - without.log_likelihood(), 0.0};
}

}  // namespace zerorate::diagnose
