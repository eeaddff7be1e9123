/// @file
/// Shares of a bias that the inputs explain, by input, the same for every receiver.
#pragma once

#include <array>
#include <string_view>

#include "firmware/app/rate_message.hpp"

namespace zerorate::wire {

/// Share of the bias that follows one kind of input.
struct ExplainedShare {
  std::string_view input;
  std::string_view name;  ///< member of the JSON message, list of x, y and z [deg/s]
  core::AngularRate app::ExplainedBias::*rate;
};

/// Shares in the order of the rate frame.
inline constexpr std::array<ExplainedShare, 3> kExplainedShares{{
    {"temperature", "explained_temperature_dps", &app::ExplainedBias::temperature},
    {"acceleration", "explained_acceleration_dps", &app::ExplainedBias::acceleration},
    {"vibration", "explained_vibration_dps", &app::ExplainedBias::vibration},
}};

}  // namespace zerorate::wire
