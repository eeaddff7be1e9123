/// @file
/// Export of a hypothesis as a model that the node runs.
#pragma once

#include <span>
#include <string>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/selection/selection.hpp"

namespace zerorate::diagnose {

/// White and flicker noise of a hypothesis, extended by its effects.
[[nodiscard]] model::SensorModel model_of(const Hypothesis& hypothesis,
                                          std::span<const Choice> choices,
                                          const std::string& source);

/// The noise of the model as it stands: white noise with that of its steps, flicker noise, random
/// walk, Gauss-Markov processes and lines. What the node learns anew at each start, warm-up, ramp
/// and the share of the temperature (if the record has one), is fitted in size.
[[nodiscard]] Hypothesis hypothesis_of(const FitData& data, const model::SensorModel& model);

/// White and 1/f noise fitted beside the sensor's low-pass, lines and disturbed samples, without
/// these. At the frequencies of flicker noise no other part disturbs the fit.
/// @param base  white and 1/f noise fitted alone; returned where there is no such effect
/// @param full  hypothesis with all effects
[[nodiscard]] Hypothesis base_beside_fast_effects(const Hypothesis& base, const Hypothesis& full);

/// Whether effects that were fitted, beside white and flicker noise of any strength, gain no more
/// than chance over the hypothesis of the model. False where one of them neither changes the
/// spectrum nor the mean, and is no rounding that the model has.
[[nodiscard]] bool is_enough(const Hypothesis& given, const model::SensorModel& model,
                             const Hypothesis& fitted);

}  // namespace zerorate::diagnose
