#include "host_tools/lib/diagnose/effects/effect.hpp"

#include <cmath>

namespace zerorate::diagnose {

double FittedPart::amplitude(std::size_t i) const {
  return hypothesis.amplitudes()[hypothesis.first_amplitude(index) + i];
}

double FittedPart::amplitude_error(std::size_t i) const {
  return std::sqrt(hypothesis.amplitude_variances()[hypothesis.first_amplitude(index) + i]);
}

std::optional<Candidate> Effect::examine(const Hypothesis& without) const {
  if (!obstacle(without).empty()) return std::nullopt;
  return find(without);
}

}  // namespace zerorate::diagnose
