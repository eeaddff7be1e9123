#pragma once

#include <cmath>
#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// Samples that are lost on the way, in runs of geometric length (a busy bus, a full FIFO). The run
/// of lost samples and the run between two losses are both memoryless.
struct DroppedSamples {
  static constexpr std::string_view kName = "dropped_samples";

  double probability = 0.0;  ///< that a run of losses begins at a sample after one that arrived
  double mean_run_samples = 1.0;  ///< at least 1

  void apply(Signal& signal, const random::RandomStream& stream) const {
    bool lost = false;
    for (std::size_t k = 0; k < signal.size(); ++k) {
      const double loss = lost ? 1.0 - 1.0 / mean_run_samples : probability;
      lost = stream.uniform(static_cast<std::int64_t>(k)) < loss;
      if (lost) signal.missing[k] = true;
    }
  }
};

}  // namespace zerorate::simulate
