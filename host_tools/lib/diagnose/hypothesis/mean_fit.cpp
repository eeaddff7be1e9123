#include "host_tools/lib/diagnose/hypothesis/mean_fit.hpp"

#include <utility>

namespace zerorate::diagnose {

std::optional<MeanFit> fit_mean(const Hypothesis& without, const MeanSearch& search) {
  std::optional<MeanFit> best;
  std::optional<Part> part = search(ColumnSearch(without));
  for (int round = 0; part && round < 2; ++round) {
    std::vector<Part> parts = without.parts();
    parts.push_back(*part);
    const std::size_t last = parts.size() - 1;
    const Hypothesis with(without.data(), std::move(parts), &without);
    const double gain = with.log_likelihood() - without.log_likelihood();
    if (!best || gain > best->gain_nats) best = {std::move(*part), gain, with};
    if (round == 0) part = search(ColumnSearch(with, last));
  }
  return best;
}

}  // namespace zerorate::diagnose
