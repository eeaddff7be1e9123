#include "host_tools/lib/diagnose/selection/node_models.hpp"

#include <cmath>
#include <utility>

#include "host_tools/lib/diagnose/selection/model_export.hpp"
#include "host_tools/lib/identify/characterize.hpp"

namespace zerorate::diagnose {
namespace {

/// Order of the flicker noise that all axes have in common, if it is among the extensions.
std::optional<double> common_order_in(std::span<const Choice> choices, const Hypothesis& full,
                                      const std::vector<bool>& is_in) {
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (is_in[i] && choices[i].axes > 1) return full.parts()[i].terms.given_order;
  }
  return std::nullopt;
}

/// A part that changes what flicker noise is found; an order is one of the flicker noise itself.
bool is_slow_extension(const Part& part) {
  return is_slow(part) && !part.terms.has_order();
}

}  // namespace

bool is_in_base(const Choice& choice) {
  return choice.axes == 1 && choice.effect->is_in_base();
}

NodeModels::NodeModels(const Record& record, const Hypothesis& full,
                       std::span<const Choice> choices, std::string source)
    : record_(&record), full_(&full), choices_(choices), source_(std::move(source)) {
  const identify::RestSamples samples = samples_of(record);
  tick_ = identify::identification_tick(samples);
  ticks_ = identify::average_ticks(samples, tick_);
  fit_ = fit_noise(std::nullopt);
}

model::SensorModel NodeModels::data_sheet() const {
  return model_of(fit_.data_sheet());
}

bool NodeModels::is_base_data_sheet() const {
  return !fit_.flicker || fit_.flicker->order.value == kOrderOfBase;
}

core::Duration NodeModels::period() const {
  return core::Duration::nanoseconds(std::llround(record_->mean_period_s * 1e9));
}

identify::InnovationsFit NodeModels::fit_noise(std::optional<double> order) const {
  return identify::fit_noise({ticks_, period(), tick_}, order);
}

model::SensorModel NodeModels::model_of(const identify::InnovationsFit& fit) const {
  return identify::model_of(fit, period(), source_, record_->axis);
}

model::SensorModel NodeModels::with(const std::vector<bool>& is_in) const {
  for (std::size_t i = 0; i < choices_.size(); ++i) {
    if (is_in[i] && is_slow_extension(full_->parts()[i])) return beside_fast_effects(is_in);
  }
  const std::optional<double> order = common_order_in(choices_, *full_, is_in);
  model::SensorModel model = order ? model_of(fit_noise(*order)) : base();
  for (std::size_t i = 0; i < choices_.size(); ++i) {
    if (is_in[i] && !is_in_base(choices_[i])) choices_[i].effect->add_to_model({*full_, i}, model);
  }
  return model;
}

model::SensorModel NodeModels::beside_fast_effects(const std::vector<bool>& is_in) const {
  std::vector<Part> parts;
  std::vector<std::size_t> places;  // places of the choices
  for (std::size_t i = 0; i < choices_.size(); ++i) {
    if (!is_in[i] && is_slow_extension(full_->parts()[i])) continue;
    parts.push_back(full_->parts()[i]);
    places.push_back(i);
  }
  const Hypothesis hypothesis(full_->data(), std::move(parts), full_);
  model::SensorModel model =
      diagnose::model_of(hypothesis, {}, source_ + ", axis " + record_->axis);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Choice& choice = choices_[places[k]];
    if (is_in[places[k]] || is_in_base(choice)) choice.effect->add_to_model({hypothesis, k}, model);
  }
  return model;
}

}  // namespace zerorate::diagnose
