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

#include "host_tests/evidence/hidden_effect/setting.hpp"

namespace zerorate::hidden_effect {

/// Physical figures under the names that the JSON has for them.
using Figures = std::map<std::string, double>;
inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;

/// An effect whose other parameters are drawn, and only the size is open.
struct Sizable {
  std::string name;
  std::function<Part(double size)> at;
  std::function<double(double size)> loss_nats;  ///< rises with the size
  double guess = 1.0;                            ///< a size from which to search
  bool replaces_flicker = false;                 ///< its noise stands for that of the base
  /// Parameters that a diagnosis should find, by their names; those that the size determines.
  std::function<Figures(double size)> figures = [](double) { return Figures{}; };
};

/// The size at which the base loses so much; nothing if no size does.
[[nodiscard]] std::optional<double> size_for(const Sizable& effect, double nats);

// Noise of another spectrum: expected Kullback-Leibler divergence to the nearest base spectrum.
[[nodiscard]] Sizable draw_rate_random_walk(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_fractional_order(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_correlated_noise(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_sensor_bandwidth(const Setting& setting, Draws& draws);

// A mean function: the same divergence, the base free to take it for noise.
[[nodiscard]] Sizable draw_temperature_drift(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_warm_up_transient(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_rate_ramp(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_periodic_disturbance(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_bias_jump(const Setting& setting, Draws& draws);

// Events at random times: a lower bound of the truth's likelihood, by the path that was realised,
// with the prior probability of that path paid for.
[[nodiscard]] Sizable draw_random_telegraph_noise(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_outliers(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_motion_contamination(const Setting& setting, Draws& draws);

// Effects on single samples: the divergence is counted sample by sample.
[[nodiscard]] Sizable draw_variable_noise(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_quantization(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_saturation(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_dropped_samples(const Setting& setting, Draws& draws);

// Not in the catalogue of zerorate. Sized by what is left when the nearest effects of the catalogue
// have taken their share.
[[nodiscard]] Sizable draw_chirp(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_temperature_hysteresis(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_sawtooth(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_burst_noise(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_skewed_noise(const Setting& setting, Draws& draws);
[[nodiscard]] Sizable draw_deadband(const Setting& setting, Draws& draws);

struct EffectEntry {
  std::string_view name;
  Sizable (*draw)(const Setting&, Draws&);
};

/// The sixteen effects that zerorate knows, and some that it does not.
[[nodiscard]] std::span<const EffectEntry> catalogue();
[[nodiscard]] std::span<const EffectEntry> outside_catalogue();

}  // namespace zerorate::hidden_effect
