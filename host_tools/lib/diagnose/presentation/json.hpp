/// @file
/// Diagnoses as JSON of the schema zerorate.diagnosis/1, docs/reference/diagnosis-json.md.
#pragma once

#include <span>
#include <string>

#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// One axis: the object itself; several: a list of such objects under "axes".
[[nodiscard]] std::string to_json(std::span<const Diagnosis> axes);

}  // namespace zerorate::diagnose
