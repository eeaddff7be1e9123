/// @file
/// The gain of the chosen effects, refitted to the first part of a record and judged on the rest.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/record/record.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"
#include "host_tools/lib/diagnose/selection/common_order.hpp"
#include "host_tools/lib/diagnose/selection/selection.hpp"

namespace zerorate::diagnose {

/// Settings of the judgement; see DiagnoseOptions.
struct HoldOut {
  std::string recording;
  std::optional<model::SensorModel> base_model;
  double share = 0.3;
  std::uint64_t seed = 1;
};

/// Fits the effects that the whole record needed to its first part and judges them on the rest.
/// Measures nothing where the first part has too few samples. Throws ModelCannotRun.
/// @param wanted  choices of the whole record
/// @param others  profile of the other axes where an order is in common
[[nodiscard]] Gain held_out_gain(const Record& record, const std::vector<Choice>& wanted,
                                 const std::optional<OrderProfile>& others,
                                 const HoldOut& hold_out);

}  // namespace zerorate::diagnose
