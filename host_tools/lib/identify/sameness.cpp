#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::identify {
namespace {

constexpr double kOrderWithoutFlicker = 0.5;

/// Fit of flicker noise whether it is significant or not: the test compares nested models.
InnovationsFitOptions at_order(InnovationsFitOptions options, double order) {
  options.order = order;
  options.significance = 1.0;
  return options;
}

}  // namespace

Sameness test_sameness(std::span<const AxisTicks> recordings, std::optional<double> order) {
  std::vector<InnovationsLikelihood> likelihoods;
  std::vector<InnovationsFitOptions> options;
  InnovationsFitOptions of_all{.order = order};
  for (const AxisTicks& recording : recordings) {
    PreparedFit prepared = prepare_fit(recording, order);
    likelihoods.push_back(std::move(prepared.likelihood));
    of_all.starts.insert(of_all.starts.end(), prepared.options.starts.begin(),
                         prepared.options.starts.end());
    of_all.shortest_time_constant_s = prepared.options.shortest_time_constant_s;
    options.push_back(std::move(prepared.options));
  }
  Sameness result{.together = fit_by_innovations(likelihoods, of_all),
                  .degrees_of_freedom = 2 * (recordings.size() - 1)};
  const double common =
      result.together.flicker ? result.together.flicker->order.value : kOrderWithoutFlicker;
  result.likelihood_ratio =
      result.together.flicker
          ? result.together.minus_two_log_likelihood
          : fit_by_innovations(likelihoods, at_order(of_all, common)).minus_two_log_likelihood;
  for (std::size_t i = 0; i < likelihoods.size(); ++i) {
    result.alone.push_back(fit_by_innovations(likelihoods[i], at_order(options[i], common)));
    result.likelihood_ratio -= result.alone.back().minus_two_log_likelihood;
  }
  result.p_value = statistics::chi_squared_tail(std::max(0.0, result.likelihood_ratio),
                                                static_cast<double>(result.degrees_of_freedom));
  result.threshold = Sameness::kSize;
  return result;
}

void compare_recordings(const RestSamples& samples, std::span<const RestSamples> further,
                        const CharacterizeOptions& options, Characterization& result) {
  std::vector<RestSamples> all{measurements_of(samples)};
  for (const RestSamples& one : further) all.push_back(measurements_of(one));
  std::vector<std::vector<TickMean>> means;
  std::vector<core::Duration> ticks;
  for (const RestSamples& one : all) {
    ticks.push_back(identification_tick(one));
    means.push_back(average_ticks(one, ticks.back()));
  }
  for (const std::size_t axis : options.axes) {
    std::vector<AxisTicks> recordings;
    for (std::size_t i = 0; i < all.size(); ++i) {
      recordings.push_back({means[i], all[i].mean_period, ticks[i], axis});
    }
    Sameness sameness = test_sameness(recordings, options.order);
    sameness.axis = samples.axis_name(axis);
    sameness.threshold = Sameness::kSize / static_cast<double>(options.axes.size());
    sameness.model =
        model_of(sameness.together, samples.mean_period,
                 fmt::format("{} and {} more", options.recording, further.size()), sameness.axis);
    result.sameness.push_back(std::move(sameness));
  }
}

}  // namespace zerorate::identify
