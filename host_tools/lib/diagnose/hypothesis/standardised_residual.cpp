#include "host_tools/lib/diagnose/hypothesis/standardised_residual.hpp"

namespace zerorate::diagnose {

StandardisedResidual::StandardisedResidual(const Hypothesis& of)
    : hypothesis(&of), values(of.whitened()) {
  for (const Part& part : of.parts()) {
    for (std::size_t k = 0; k < part.relative_sigma.size(); ++k) {
      values[k] /= double{part.relative_sigma[k]};
    }
  }
}

}  // namespace zerorate::diagnose
