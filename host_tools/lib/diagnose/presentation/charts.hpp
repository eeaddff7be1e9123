/// @file
/// The charts of a diagnosis. Internal to its report.
#pragma once

#include "host_tools/lib/diagnose/result/diagnosis.hpp"
#include "host_tools/lib/report/chart.hpp"

namespace zerorate::diagnose {

[[nodiscard]] report::Chart allan_chart(const Diagnosis& diagnosis);
[[nodiscard]] report::Chart density_chart(const Diagnosis& diagnosis);
/// The recording with an effect drawn over it.
[[nodiscard]] report::Chart effect_chart(const Diagnosis& diagnosis, const Drawing& drawing);
[[nodiscard]] report::BarChart evidence_chart(const Diagnosis& diagnosis);
/// Errors of prediction, extended over base.
[[nodiscard]] report::BarChart error_chart(const Gain& gain);
[[nodiscard]] report::BarChart coverage_chart(const Gain& gain);

}  // namespace zerorate::diagnose
