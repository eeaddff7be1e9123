#pragma once

#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// Single wild samples (a bit error, a disturbed transfer): a normal error is added to a share of
/// the samples, chosen independently.
struct Outliers {
  static constexpr std::string_view kName = "outliers";

  double sigma_rad_s = 0.0;
  double probability = 0.0;

  void apply(Signal& signal, const random::RandomStream& stream) const {
    const random::RandomStream sizes = stream.substream("size");
    for (std::size_t k = 0; k < signal.size(); ++k) {
      const auto index = static_cast<std::int64_t>(k);
      if (stream.uniform(index) < probability) {
        signal.rate_rad_s[k] += sigma_rad_s * sizes.normal(index);
      }
    }
  }
};

}  // namespace zerorate::simulate
