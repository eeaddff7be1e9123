/// @file
/// Choice of the extensions that the model of the node gets: those that pay on data held out.
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

struct ExtensionChoice {
  std::vector<bool> is_in;  ///< mark of each choice
  /// Reason for each choice that is not an extension of the model; empty for those that are.
  std::vector<std::string> reasons;
  /// Heading drift of each choice that was tried, with its extension over without.
  std::vector<std::optional<BootstrapFigure>> drift_ratios;
  Gain gain;                  ///< gain of the chosen model over the base
  Gain gain_over_data_sheet;  ///< gain of the chosen model over white and 1/f noise
};

/// Fits the effects that the whole record needed to its first part, adds one extension after the
/// other to the base, and keeps those that predict every second drive of the rest better. The other
/// drives measure the gain of the model that was chosen. Keeps all, and measures nothing, where the
/// first part has too few samples.
/// @param wanted  choices of the whole record
/// @param others  profile of the other axes where an order is in common
[[nodiscard]] ExtensionChoice choose_extensions(const Record& record,
                                                const std::vector<Choice>& wanted,
                                                const std::optional<OrderProfile>& others,
                                                const HoldOut& hold_out);

}  // namespace zerorate::diagnose
