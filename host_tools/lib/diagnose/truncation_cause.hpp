/// @file
/// A cut toward zero as a cause of the diagnosis, and as a doubt of the characterization.
#pragma once

#include <string>
#include <vector>

#include "host_tools/lib/diagnose/record/truncation.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"
#include "host_tools/lib/identify/rest_doubt.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::diagnose {

/// Adds the evidence and, where the cut was found, the cause and the table `[quantization]` of the
/// extended model. Where the given base model undoes it, it is no cause.
void add_truncation(const TruncationEvidence& truncation, Diagnosis& diagnosis);

/// Sentence on a cut of samples that are characterized as they stand; none where it is accepted.
[[nodiscard]] std::vector<std::string> remarks_on_truncation(
    const identify::RestSamples& samples, const identify::AcceptedDoubts& accepted);

}  // namespace zerorate::diagnose
