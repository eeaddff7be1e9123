/// @file
/// A cut toward zero as a cause of the diagnosis.
#pragma once

#include "host_tools/lib/diagnose/record/truncation.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// Adds the evidence and, where the cut was found, the cause and the table `[quantization]` of the
/// extended model. Where the given base model undoes it, it is no cause.
void add_truncation(const TruncationEvidence& truncation, Diagnosis& diagnosis);

}  // namespace zerorate::diagnose
