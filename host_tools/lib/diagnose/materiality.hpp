/// @file
/// Weight of what is left unexplained, measured by the heading.
#pragma once

#include <optional>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// Lets the node, with the model that it gets, drive through the record and through simulations of
/// the hypothesis (a parametric bootstrap): stops and drives alternate. The ratio of the heading
/// errors of record and simulations has an interval for each length of drives; all of them together
/// hold with 95 %. Disturbed samples that the hypothesis has replaced are replaced in the record,
/// and absent in simulations.
/// @param hypothesis  fitted to the whole record
/// @return nothing where fewer than eight drives of the shortest length fit, or the node cannot run
///         the model
[[nodiscard]] std::optional<Materiality> weigh_remainder(const Hypothesis& hypothesis,
                                                         const model::SensorModel& model);

}  // namespace zerorate::diagnose
