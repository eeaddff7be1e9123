#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "host_tools/lib/diagnose/inputs/input_effects.hpp"
#include "host_tools/lib/diagnose/inputs/input_words.hpp"

namespace zerorate::diagnose {

void add_inputs_to_model(const InputFindings& findings, std::optional<std::size_t> axis,
                         model::SensorModel& model) {
  using model::InputQuantity;
  constexpr std::array kAccelerations{InputQuantity::acceleration_x, InputQuantity::acceleration_y,
                                      InputQuantity::acceleration_z};
  for (const InputEffect& effect : findings.effects) {
    if (!effect.pays()) continue;
    for (std::size_t i = 0; i < effect.value_rad_s.size(); ++i) {
      if (!std::isfinite(effect.standard_error_rad_s[i])) continue;
      const bool is_vibration = effect.name == kVibrationRectification;
      model::Input input{.quantity = is_vibration ? InputQuantity::vibration : kAccelerations.at(i),
                         .sigma_rad_s_per_unit = effect.standard_error_rad_s[i],
                         .source = std::string(kSourceOfInputs)};
      for (std::size_t k = 0; k < input.coefficient_rad_s_per_unit.size(); ++k) {
        if (!axis || *axis == k) input.coefficient_rad_s_per_unit.at(k) = effect.value_rad_s[i];
      }
      model.inputs.push_back(std::move(input));
    }
  }
}

void take_off_vibration(const InputFindings& findings, Record& record) {
  if (findings.vibration_share_rad_s.empty()) return;
  const InputTicks& ticks = record.inputs;
  const double tick_s = static_cast<double>(ticks.tick.ns()) * 1e-9;
  const double half_sample_s = 0.5 * static_cast<double>(ticks.sample_period.ns()) * 1e-9;
  std::vector<double> share;
  share.reserve(record.size());
  std::size_t at = 0;
  for (const double time_s : record.time_s) {
    const double tick = std::floor((time_s + half_sample_s) / tick_s);
    while (at + 1 < ticks.size() && static_cast<double>(ticks.means[at + 1].tick) <= tick) ++at;
    share.push_back(findings.vibration_share_rad_s[at]);
  }
  const double mean =
      std::accumulate(share.begin(), share.end(), 0.0) / static_cast<double>(share.size());
  for (std::size_t k = 0; k < share.size(); ++k) record.rate_rad_s[k] -= share[k] - mean;
}

}  // namespace zerorate::diagnose
