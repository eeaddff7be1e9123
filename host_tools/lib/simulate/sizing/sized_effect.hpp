/// @file
/// Effects whose size is set by information: by how many nats of likelihood the best base model
/// loses to the truth. docs/reference/hidden-effect-campaign.md says what that means for each.
#pragma once

#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/simulate/sizing/recording_setting.hpp"

namespace zerorate::sizing {

/// Physical figures under the names that the JSON has for them.
using Figures = std::map<std::string, double>;
inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;

/// An effect whose other parameters are drawn, and only the size is open.
struct SizedEffect {
  std::string name;
  std::function<Part(double size)> at;
  std::function<double(double size)> loss_nats;  ///< rises with the size
  /// Noise of a recording that has the effect, to those who know it. Most single samples that an
  /// effect changes leave the noise of the others as it was.
  std::function<BaseNoise(const BaseNoise& noise, double size)> noise_with =
      [](const BaseNoise& noise, double) { return noise; };
  double guess = 1.0;             ///< a size from which to search
  bool replaces_flicker = false;  ///< its noise stands for that of the base
  /// Parameters that a diagnosis should find, by their names; those that the size determines.
  std::function<Figures(double size)> figures = [](double) { return Figures{}; };
};

/// The size at which the base loses so much; nothing if no size does.
[[nodiscard]] std::optional<double> size_for(const SizedEffect& effect, double nats);

struct EffectEntry {
  std::string_view name;
  SizedEffect (*draw)(const RecordingSetting&, Draws&);
};

struct HiddenEffect {
  std::string name;
  Part part;
  double size;
  bool replaces_flicker;
  Figures figures;
};

/// Effects of one recording, each of a size at which the best model that knows all the others loses
/// so much. Nothing where no sizes do: two effects may be each other's double at any size.
[[nodiscard]] std::optional<std::vector<HiddenEffect>> size_together(
    std::span<const EffectEntry> entries, const RecordingSetting& setting, double nats,
    Draws& draws);

// Noise of another spectrum: expected Kullback-Leibler divergence to the nearest base spectrum.
[[nodiscard]] SizedEffect draw_rate_random_walk(const RecordingSetting& setting, Draws& draws);
[[nodiscard]] SizedEffect draw_fractional_order(const RecordingSetting& setting, Draws& draws);
[[nodiscard]] SizedEffect draw_correlated_noise(const RecordingSetting& setting, Draws& draws);
[[nodiscard]] SizedEffect draw_sensor_bandwidth(const RecordingSetting& setting, Draws& draws);

// A mean function: the same divergence, the base free to take it for noise.
[[nodiscard]] SizedEffect draw_temperature_drift(const RecordingSetting& setting, Draws& draws);
[[nodiscard]] SizedEffect draw_temperature_rate(const RecordingSetting& setting, Draws& draws);
[[nodiscard]] SizedEffect draw_warm_up_transient(const RecordingSetting& setting, Draws& draws);
[[nodiscard]] SizedEffect draw_rate_ramp(const RecordingSetting& setting, Draws& draws);
[[nodiscard]] SizedEffect draw_periodic_disturbance(const RecordingSetting& setting, Draws& draws);
[[nodiscard]] SizedEffect draw_bias_jump(const RecordingSetting& setting, Draws& draws);
[[nodiscard]] SizedEffect draw_relaxation(const RecordingSetting& setting, Draws& draws);

// Events at random times: a lower bound of the truth's likelihood, by the path that was realised,
// with the prior probability of that path paid for.
[[nodiscard]] SizedEffect draw_random_telegraph_noise(const RecordingSetting& setting,
                                                      Draws& draws);
[[nodiscard]] SizedEffect draw_outliers(const RecordingSetting& setting, Draws& draws);
[[nodiscard]] SizedEffect draw_motion_contamination(const RecordingSetting& setting, Draws& draws);

// Effects on single samples: the divergence is counted sample by sample.
[[nodiscard]] SizedEffect draw_variable_noise(const RecordingSetting& setting, Draws& draws);
[[nodiscard]] SizedEffect draw_quantization(const RecordingSetting& setting, Draws& draws);
[[nodiscard]] SizedEffect draw_saturation(const RecordingSetting& setting, Draws& draws);
[[nodiscard]] SizedEffect draw_dropped_samples(const RecordingSetting& setting, Draws& draws);

inline constexpr std::size_t kKnownEffects = 18;

/// The effects that the diagnosis has a name for.
[[nodiscard]] std::span<const EffectEntry> catalogue();

}  // namespace zerorate::sizing
