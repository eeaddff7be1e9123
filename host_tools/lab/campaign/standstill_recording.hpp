/// @file
/// A blind recording of several standstills with motion between: effects that one stretch of rest
/// in one attitude does not show.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "host_tools/lab/campaign/blind_recording.hpp"

namespace zerorate::campaign {

inline constexpr std::array<std::string_view, 3> kStandstillEffects{
    "g_sensitivity", "vibration_rectification", "truncation"};

/// Twelve standstills in attitudes of any kind, each with a vibration of its own, a quarter of the
/// time moving. A pure function of the options and the number of the run; of six recordings each
/// effect has one, and three are clean.
[[nodiscard]] BlindRecording draw_standstill_recording(const BlindOptions& options,
                                                       std::size_t run);

}  // namespace zerorate::campaign
