/// @file
/// A diagnosis in words, for a firmware engineer.
#pragma once

#include <string>
#include <string_view>

#include "host_tools/lib/diagnose/result/diagnosis.hpp"
#include "host_tools/lib/odometry/odometer_findings.hpp"

namespace zerorate::diagnose {

/// Verdict, and whether what is left matters for the heading: "unexplained, but it does not matter
/// for the heading".
[[nodiscard]] std::string verdict_in_words(const Diagnosis& diagnosis);

/// One paragraph: what the simulation gets wrong, what explains it and what does not, what the
/// extended model buys; or that nothing is wrong; or what is left and that no cause is proven.
[[nodiscard]] std::string in_words(const Diagnosis& diagnosis);

/// Gain in heading of learning from the calm alone.
[[nodiscard]] std::string in_words(const odometry::HeadingGain& gain);

/// An effect as people read it: "rate random walk".
[[nodiscard]] std::string plain_name(std::string_view effect);

/// A statistic as people read it: "Allan deviation".
[[nodiscard]] std::string plain_statistic(std::string_view statistic);

}  // namespace zerorate::diagnose
