/// @file
/// Models of a record for the node: the base, and the base with some of the extensions.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/record/record.hpp"
#include "host_tools/lib/diagnose/selection/selection.hpp"
#include "host_tools/lib/identify/innovations_fit.hpp"

namespace zerorate::diagnose {

/// Models of one record.
class NodeModels {
 public:
  /// Fits the base by identify::fit_noise(). Throws recording::DataError for fewer than 64 ticks.
  /// @param record  as long as that of the hypothesis; both outlive this object
  /// @param full  hypothesis with one part for each choice, in their order
  /// @param source  name of the recording, for the models
  NodeModels(const Record& record, const Hypothesis& full, std::span<const Choice> choices,
             std::string source);

  /// White and flicker noise, as `zerorate characterize` writes them.
  [[nodiscard]] model::SensorModel base() const { return model_of(fit_); }
  /// White and 1/f noise alone (d = 1/2), which N and B of a data sheet stand for.
  [[nodiscard]] model::SensorModel data_sheet() const;
  /// True if base() is of that order already.
  [[nodiscard]] bool is_base_data_sheet() const;
  /// The base with extensions. Where one of them changes the slow noise or the mean, white and
  /// flicker noise are those of a hypothesis with these extensions and all fast effects; the noise
  /// of the base holds what the extension explains.
  /// @param is_in  mark of each choice
  [[nodiscard]] model::SensorModel with(const std::vector<bool>& is_in) const;

 private:
  [[nodiscard]] core::Duration period() const;
  [[nodiscard]] identify::InnovationsFit fit_noise(std::optional<double> order) const;
  [[nodiscard]] model::SensorModel model_of(const identify::InnovationsFit& fit) const;
  [[nodiscard]] model::SensorModel beside_fast_effects(const std::vector<bool>& is_in) const;

  const Record* record_;
  const Hypothesis* full_;
  std::span<const Choice> choices_;
  std::string source_;
  core::Duration tick_;
  std::vector<identify::TickMean> ticks_;
  identify::InnovationsFit fit_;
};

/// True if a choice is no extension: the base has it, or it does not concern the rate.
[[nodiscard]] bool is_in_base(const Choice& choice);

}  // namespace zerorate::diagnose
