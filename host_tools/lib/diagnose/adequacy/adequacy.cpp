#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace zerorate::diagnose {

Adequacy examine_adequacy(const Hypothesis& hypothesis) {
  const StandardisedResidual residual(hypothesis);
  Tests tests = test_spectrum(residual);
  const auto add = [&](Tests more) {
    tests.insert(tests.end(), std::make_move_iterator(more.begin()),
                 std::make_move_iterator(more.end()));
  };
  add(test_spectrum_over_time(residual));
  add(test_temperature(residual));
  // Means over ticks of unequal numbers of samples have unequal variances.
  const bool values_are_alike = !hypothesis.data().series().is_ticks && !hypothesis.is_coarse();
  if (values_are_alike) {
    add(test_variance(residual));
    add(test_distribution(residual));
    add(test_levels(residual));
  }
  std::ranges::stable_sort(tests, {}, &Test::log_p);
  const auto count = static_cast<double>(tests.size());
  Adequacy adequacy;
  adequacy.p_value = -std::expm1(count * std::log1p(-std::exp(std::min(-1e-12, tests[0].log_p))));
  const double threshold = std::log(kFamilyError / count);
  for (const Test& test : tests) {
    if (test.log_p < threshold) adequacy.failures.push_back(test.words);
  }
  adequacy.holds = adequacy.failures.empty();
  return adequacy;
}

}  // namespace zerorate::diagnose
