#include "host_tools/lib/diagnose/held_out_gain.hpp"

#include <utility>

#include "host_tools/lib/diagnose/forecast_gain/gain.hpp"
#include "host_tools/lib/diagnose/hypothesis/prepared_axis.hpp"
#include "host_tools/lib/diagnose/selection/model_export.hpp"

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

}  // namespace

Gain held_out_gain(const Record& record, const std::vector<Choice>& wanted,
                   const std::optional<OrderProfile>& others, const HoldOut& hold_out) {
  const double share = 1.0 - hold_out.share;
  const Record first =
      beginning_of(record, static_cast<std::size_t>(share * static_cast<double>(record.size())));
  if (hold_out.share <= 0.0 || first.size() < kFewestSamples) return {};
  const PreparedAxis axis(first, hold_out.seed);
  const FitData& data = axis.data();
  const Hypothesis base(data, {});
  Hypothesis extended = base;
  std::vector<Choice> choices;
  for (const Choice& choice : wanted) {
    std::optional<Part> part = part_of(choice, others, extended);
    if (!part) continue;
    std::vector<Part> parts = extended.parts();
    parts.push_back(std::move(*part));
    choices.push_back(choice);
    extended = Hypothesis(data, std::move(parts), &extended);
  }
  const model::SensorModel base_model =
      hold_out.base_model.value_or(model_of(base, {}, hold_out.recording));
  return measure_gain(record, base_model, model_of(extended, choices, hold_out.recording),
                      hold_out.share, hold_out.seed);
}

}  // namespace zerorate::diagnose
