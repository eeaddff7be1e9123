#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "core/base/numeric.hpp"
#include "firmware/model/node_model.hpp"
#include "firmware/model/source_headers.hpp"
#include "firmware/model/source_pieces.hpp"

namespace zerorate::model {
namespace {

using namespace source;

/// Names of core::Input in C++.
constexpr std::array<std::string_view, core::kInputs> kNamesInCpp{
    "none",           "temperature",    "temperature_squared", "temperature_rate",
    "acceleration_x", "acceleration_y", "acceleration_z",      "vibration"};

std::string nanoseconds(core::Duration duration) {
  return "core::Duration::nanoseconds(" + std::to_string(duration.ns()) + ")";
}

/// Nothing where there are none, likewise.
template <class Modes>
std::string modes_member(const std::string& name, const Modes& modes, std::size_t count) {
  if (count == 0) return {};
  const std::string indent = "              ";
  return indent + "." + name + " = {{\n" + mode_lines(indent + "    ", modes, count) + indent +
         "}},\n";
}

/// An infinite variance or limit, which is the default, has no literal.
std::string finite_member(const std::string& name, float value) {
  if (!core::is_finite(value)) return {};
  return ",\n    ." + name + " = " + literal(value);
}

/// Nothing where the bias follows no input, which is the default.
template <std::size_t K>
std::string inputs_member(const core::InputTerms<K>& inputs) {
  const std::size_t count = count_inputs(inputs);
  if (count == 0) return {};
  std::string text = "    .inputs = {.terms = {{\n";
  for (std::size_t i = 0; i < count; ++i) {
    const core::InputTerm& term = inputs.terms[i];
    text += "                   {.input = core::Input::" +
            std::string{kNamesInCpp.at(static_cast<std::size_t>(term.input))} +
            ", .sigma = " + literal(term.sigma) + ", .coefficient = {" +
            numbers(term.coefficient.data(), term.coefficient.size()) + "}},\n";
  }
  return text + "               }}, .reference_degc = " + literal(inputs.reference_degc) +
         ", .lag_s = " + literal(inputs.lag_s) + "},\n";
}

/// An end that there is not is the default.
std::string range(const core::MeasuringRange& range) {
  if (!core::is_finite(range.lower_rad_s) || !core::is_finite(range.upper_rad_s)) return {};
  return ",\n                .range = {.lower_rad_s = " + literal(range.lower_rad_s) +
         ", .upper_rad_s = " + literal(range.upper_rad_s) + "}";
}

std::string samples(const core::SampleModel& samples) {
  if (!samples.is_on()) return {};
  return "    .samples = {.outliers = {.probability = " + literal(samples.outliers.probability) +
         ", .variance_rad2_s2 = " + literal(samples.outliers.variance_rad2_s2) +
         "},\n                .motion = {.begin_probability = " +
         literal(samples.motion.begin_probability) +
         ", .end_probability = " + literal(samples.motion.end_probability) +
         ", .variance_rad2_s2 = " + literal(samples.motion.variance_rad2_s2) +
         "},\n                .level = {.variance = " + literal(samples.level.variance) +
         ", .time_constants_per_tick = " + literal(samples.level.time_constants_per_tick) + "}" +
         range(samples.range) + "},\n";
}

/// Hypotheses of the flicker; nothing where the model is taken at its word.
std::string hypotheses_member(const core::Hypotheses<kWidestLearningShape>& all,
                              std::size_t decaying) {
  if (all.count == 0) return {};
  return "    .hypotheses = {.count = " + std::to_string(all.count) +
         ", .kept = " + literal(all.kept) + ", .all = {{\n" + hypothesis_lines(all, decaying) +
         "    }}},\n";
}

/// Members that have the default stay out.
std::string motion_member(const core::MotionModel& motion) {
  const core::MotionModel silent{};
  const auto other = [](const char* name, float value, float usual) {
    return value == usual ? std::string{} : std::string{", ."} + name + " = " + literal(value);
  };
  return "    .motion = {.scale_factor = " + literal(motion.scale_factor) +
         ", .asymmetry = " + literal(motion.asymmetry) +
         other("slope_variance_rad2", motion.slope_variance_rad2, silent.slope_variance_rad2) +
         other("scale_factor_per_k", motion.scale_factor_per_k, silent.scale_factor_per_k) +
         other("scale_factor_at_k", motion.scale_factor_at_k, silent.scale_factor_at_k) + "},\n";
}

/// Nothing where no error of a scale factor is known, which is the default.
std::string scale_member(const core::ScaleCorrection& scale) {
  if (!scale.is_on()) return {};
  return "    .scale = {.factor = {" + numbers(scale.factor.data(), scale.factor.size()) + "}},\n";
}

/// Nothing where the model names no step, or no truncation, which is the default.
std::string step_members(float step_rad_s, const core::Truncation& truncation) {
  if (step_rad_s == 0.0F) return {};
  std::string step = "    .quantization_step_rad_s = " + literal(step_rad_s) + ",\n";
  if (!truncation.is_on()) return step;
  return step + "    .truncation = {.half_step_rad_s = " + literal(truncation.half_step_rad_s) +
         "},\n";
}

}  // namespace

std::string format_cpp_header(const SensorModel& model, core::Duration sample_period,
                              core::Duration filter_tick, std::int64_t held_ticks) {
  auto node = make_full_node_model(model, sample_period, filter_tick);
  require_places(filter_tick, held_ticks, "NodeCapacity::held_ticks");
  const auto [decaying, rotating] = move_active_to_front(node);
  const bool is_stationary = node.modes.start == core::Start::stationary;
  return "/// @file\n"
         "/// Sensor model: " +
         in_comment(model.name) +
         ".\n"
         "/// For " +
         rates(sample_period, filter_tick) +
         ".\n"
         "/// Made by `zerorate export --cpp`; change the model and make it again.\n"
         "#pragma once\n\n"
         "#include \"core/base/time.hpp\"\n"
         "#include \"core/noise/model_shape.hpp\"\n"
         "#include \"firmware/app/node_params.hpp\"\n\n"
         "namespace zerorate::exported {\n\n"
         "// clang-format off\n"
         "inline constexpr core::ModelShape kModelShape{.decaying = " +
         std::to_string(decaying) + ", .rotating = " + std::to_string(rotating) +
         ", .inputs = " + std::to_string(count_inputs(node.inputs)) +
         ", .has_accelerometer = " + (node.inputs.follows(core::is_inertial) ? "true" : "false") +
         ", .hypotheses = " + std::to_string(std::max(node.hypotheses.count, std::size_t{1})) +
         "};\n\n"
         "inline constexpr app::NodeParams<kModelShape> kNodeParams{.model = {\n"
         "    .modes = {.tick = " +
         nanoseconds(filter_tick) +
         ",\n"
         "              .start = core::Start::" +
         (is_stationary ? "stationary" : "zero") +
         ",\n"
         "              .is_stationary = " +
         (node.modes.is_stationary ? "true" : "false") +
         ",\n"
         "              .walk_variance = " +
         literal(node.modes.walk_variance) + ",\n" +
         modes_member("decaying", node.modes.decaying, decaying) +
         modes_member("rotating", node.modes.rotating, rotating) +
         "    },\n"
         "    .white_variance_rad2_s2 = " +
         literal(node.white_variance_rad2_s2) + ",\n    .measurement_floor_variance_rad2_s2 = " +
         literal(node.measurement_floor_variance_rad2_s2) +
         finite_member("turn_on_variance_rad2_s2", node.turn_on_variance_rad2_s2) +
         finite_member("largest_bias_rad_s", node.largest_bias_rad_s) +
         ",\n    .gate = {.threshold_sigma = " + literal(node.gate.threshold_sigma) +
         ", .longest_knock_ticks = " + std::to_string(node.gate.longest_knock_ticks) + "},\n" +
         inputs_member(node.inputs) + samples(node.samples) + motion_member(node.motion) +
         scale_member(node.scale) + "    .sample_period = " + nanoseconds(sample_period) + ",\n" +
         hypotheses_member(node.hypotheses, decaying) +
         step_members(node.quantization_step_rad_s, node.truncation) +
         "}};\n"
         "// clang-format on\n\n"
         "}  // namespace zerorate::exported\n";
}

}  // namespace zerorate::model
