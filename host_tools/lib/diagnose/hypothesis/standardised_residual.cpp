#include "host_tools/lib/diagnose/hypothesis/standardised_residual.hpp"

namespace zerorate::diagnose {

Remainder::Remainder(const Explanation& hypothesis)
    : explanation(&hypothesis), values(hypothesis.whitened()) {
  for (const Part& part : hypothesis.parts()) {
    for (std::size_t k = 0; k < part.relative_sigma.size(); ++k) {
      values[k] /= double{part.relative_sigma[k]};
    }
  }
}

}  // namespace zerorate::diagnose
