#include "host_tools/lib/diagnose/extension_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_tools/lib/diagnose/forecast_gain/gain.hpp"
#include "host_tools/lib/diagnose/hypothesis/fit_data.hpp"
#include "host_tools/lib/diagnose/selection/node_models.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {
namespace {

/// The part of a choice beside other parts, fitted anew.
std::optional<Part> part_of(const Choice& choice, const std::optional<OrderProfile>& others,
                            const Hypothesis& without) {
  if (choice.axes > 1) {
    OrderProfile all(without);
    return part_of_order((all += *others).peak());
  }
  std::optional<Candidate> candidate = choice.effect->examine(without);
  if (!candidate) return std::nullopt;
  return std::move(candidate->part);
}

/// Effects of the whole record in its first part.
struct Refitted {
  Hypothesis full;
  std::vector<Choice> choices;      ///< choices found again, one for each part
  std::vector<std::size_t> places;  ///< places of these choices among all
};

/// Finds each choice where the whole record showed it: in the values, or in their means.
/// @param means  of the values; null where no choice was made for them, or there are too few
Refitted refit(const FitData& values, const FitData* means, const std::vector<Choice>& wanted,
               const std::optional<OrderProfile>& others) {
  Refitted refitted{.full = Hypothesis(values, {})};
  std::optional<Hypothesis> of_means;
  if (means != nullptr) of_means.emplace(*means, std::vector<Part>{});
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const bool is_of_means = of_means && wanted[i].is_of_means;
    std::optional<Part> part = part_of(wanted[i], others, is_of_means ? *of_means : refitted.full);
    if (!part) continue;
    if (is_of_means) {
      of_means = of_means->with(*part);
      part = carried_over(std::move(*part), *means, values);
    }
    refitted.full = refitted.full.with(std::move(*part));
    refitted.choices.push_back(wanted[i]);
    refitted.places.push_back(i);
  }
  return refitted;
}

double standard_error(const BootstrapFigure& figure) {
  return 0.5 * (figure.hi - figure.lo) / statistics::kHalfWidth95;
}

/// Empty where an extension pays: the samples are predicted better by more than one standard error,
/// and the heading does not drift further by more than one standard error. Chance alone decides
/// below that.
std::string reason_against(const Gain& gain) {
  constexpr double kMostDrift = 1.005;
  const BootstrapFigure& score = gain.log_score_gain_nats_per_sample;
  const BootstrapFigure& drift = gain.heading_drift_ratio;
  if (drift.value - standard_error(drift) > kMostDrift) {
    return fmt::format(
        "on the data held out the heading drift is {:.3f} [{:.3f}, {:.3f}] times that without it",
        drift.value, drift.lo, drift.hi);
  }
  if (score.value > standard_error(score)) return {};
  return fmt::format(
      "on the data held out it predicts no better: {:.2g} nats a sample "
      "[{:.2g}, {:.2g}]",
      score.value, score.lo, score.hi);
}

}  // namespace

ExtensionChoice choose_extensions(const Record& record, const std::vector<Choice>& wanted,
                                  const std::optional<OrderProfile>& others,
                                  const HoldOut& hold_out) {
  ExtensionChoice chosen{.is_in = std::vector<bool>(wanted.size(), true),
                         .reasons = std::vector<std::string>(wanted.size()),
                         .drift_ratios{wanted.size(), std::nullopt}};
  const Record first = beginning_of(
      record,
      static_cast<std::size_t>((1.0 - hold_out.share) * static_cast<double>(record.size())));
  if (hold_out.share <= 0.0 || first.size() < kFewestSamples) return chosen;
  const PreparedAxis axis(first, hold_out.seed);
  const std::size_t values = values_a_slow_mean(axis.series());
  std::optional<PreparedAxis> means;
  if (values > 1 && std::ranges::any_of(wanted, &Choice::is_of_means)) {
    means.emplace(means_of(axis.series(), values), hold_out.seed);
  }
  const Refitted refitted = refit(axis.data(), means ? &means->data() : nullptr, wanted, others);
  const NodeModels models(first, refitted.full, refitted.choices, hold_out.recording);
  HeldOutDrives held_out(record, hold_out.share, hold_out.seed);

  chosen.is_in.assign(wanted.size(), false);
  chosen.reasons.assign(wanted.size(),
                        "the part of the recording before the data held out does "
                        "not show it");
  std::vector<bool> is_in(refitted.choices.size());
  model::SensorModel model = models.base();
  for (std::size_t i = 0; i < refitted.choices.size(); ++i) {
    std::string& reason = chosen.reasons[refitted.places[i]];
    if (is_in_base(refitted.choices[i])) {
      reason = "the base has it: its noise is that of tick means";
      continue;
    }
    is_in[i] = true;
    try {
      model::SensorModel extended = models.with(is_in);
      const Gain gain = held_out.gain(model, extended, HeldOutPart::to_choose);
      if (gain.has_drives()) chosen.drift_ratios[refitted.places[i]] = gain.heading_drift_ratio;
      reason = reason_against(gain);
      if (reason.empty()) model = std::move(extended);
    } catch (const ModelCannotRun& cannot) {
      reason = std::string("the node cannot run it: ") + cannot.what();
    }
    is_in[i] = reason.empty();
    chosen.is_in[refitted.places[i]] = is_in[i];
  }
  chosen.gain =
      held_out.gain(hold_out.base_model.value_or(models.base()), model, HeldOutPart::to_measure);
  const bool is_same = hold_out.base_model || models.is_base_data_sheet();
  chosen.gain_over_data_sheet =
      is_same ? chosen.gain : held_out.gain(models.data_sheet(), model, HeldOutPart::to_measure);
  return chosen;
}

}  // namespace zerorate::diagnose
