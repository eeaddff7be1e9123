#include "host_tools/lib/diagnose/truncation_cause.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "host_tools/lib/diagnose/selection/selection.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

const std::string kTruncation = "truncation";

Cause cause_of(const Truncation& found, std::size_t axes) {
  const double step_dps = found.step_rad_s * kDegPerRad;
  const double error = 1e-3 * step_dps;
  Cause cause{
      .effect = kTruncation,
      .gain_nats = found.surprisal_nats,
      .p_value = std::exp(-found.surprisal_nats),
      .axes = axes,
      .parameters = {{"step_dps", step_dps, step_dps - error, step_dps + error},
                     {"width_of_cell_of_zero_steps", found.width, found.width_lo, found.width_hi}},
      .sentence = fmt::format(
          "The samples are cut toward zero, in steps of {:.3g} deg/s: the level 0 holds {:.2g} "
          "times "
          "as many as the levels beside it let expect. A bias that is learnt at rest is half a "
          "step, {:.2g} deg/s, too near zero for the rates on the move.",
          step_dps, found.width, 0.5 * step_dps)};
  cause.set95 = weigh(kTruncation, found.surprisal_nats, {});
  cause.probability = cause.set95.front().probability;
  return cause;
}

bool undoes_truncation(const model::SensorModel& model) {
  return model.quantization && model.quantization->method == model::QuantizationMethod::truncation;
}

}  // namespace

void add_truncation(const TruncationEvidence& truncation, Diagnosis& diagnosis) {
  SelectionEvidence evidence{.effect = kTruncation,
                             .gain_nats = truncation.surprisal_nats,
                             .price_nats = kTruncationThreshold_nats,
                             .selected = truncation.found.has_value()};
  if (!truncation.is_examined) evidence.not_examined = "too few samples on levels about zero";
  add_stronger({evidence}, diagnosis.evidence);
  if (!truncation.found || undoes_truncation(diagnosis.base_model)) return;
  diagnosis.causes.push_back(cause_of(*truncation.found, truncation.axes));
  auto& quantization = diagnosis.extended_model.quantization;
  if (!quantization) {
    quantization = model::Quantization{.step_rad_s = truncation.found->step_rad_s};
  }
  quantization->method = model::QuantizationMethod::truncation;
}

std::vector<std::string> remarks_on_truncation(const identify::RestSamples& samples,
                                               const identify::AcceptedDoubts& accepted) {
  const TruncationEvidence evidence = find_truncation(samples);
  if (!evidence.found) return {};
  const double step_dps = evidence.found->step_rad_s * kDegPerRad;
  const identify::RestDoubt doubt{
      identify::doubt::kTruncation,
      fmt::format("the level 0 holds {:.2g} times as many samples as its neighbours let expect: "
                  "truncated, not rounded, in steps of {:.3g} deg/s? The mean is then up to {:.2g} "
                  "deg/s too near zero. 'zerorate diagnose --model-out' makes a model that undoes "
                  "it",
                  evidence.found->width, step_dps, 0.5 * step_dps),
      false};
  std::vector<std::size_t> axes;
  return identify::require_rest({doubt}, accepted, axes);
}

}  // namespace zerorate::diagnose
