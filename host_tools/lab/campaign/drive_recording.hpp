/// @file
/// A blind hour of drives with a reference: effects in motion, sized by information.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "host_tools/lab/campaign/blind_recording.hpp"

namespace zerorate::campaign {

/// Rows of the matrix of answers.
inline constexpr std::array<std::string_view, 9> kDriveEffects{
    "scale_factor",    "scale_asymmetry", "bias_in_motion", "misalignment",      "g_sensitivity",
    "reference_delay", "reference_fault", "gap_in_turn",    "saturation_in_turn"};
inline constexpr std::array<std::string_view, 4> kDriveEffectsOutside{
    "scale_by_temperature", "reference_breathes", "magnetic_disturbance", "hysteresis_of_turns"};

/// Recordings of a round of drives.
inline constexpr std::size_t kDriveRound = 22;

/// A round has each sized effect and each fault once, four clean hours, three pairs and four
/// effects from outside. Every second clean hour has an odometer with backlash, which no heading
/// shows. A pure function of the options and the number of the run.
[[nodiscard]] BlindRecording draw_drive_recording(const BlindOptions& options, std::size_t run);

}  // namespace zerorate::campaign
