#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "core/standstill/hold_back_line.hpp"
#include "core/standstill/standstill.hpp"
#include "firmware/model/node_model.hpp"
#include "firmware/model/source_headers.hpp"

namespace zerorate::model {
namespace {

bool is_identifier(std::string_view name) {
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  return !name.empty() && is_letter(name.front()) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return is_letter(c) || is_digit(c); });
}

/// Words that C or C++ keeps for itself: firmware of either includes the header.
bool is_keyword(std::string_view name) {
  static constexpr auto kKeywords = std::to_array<std::string_view>(
      {"alignas",     "alignof",   "and",          "asm",      "auto",     "bool",
       "break",       "case",      "catch",        "char",     "class",    "const",
       "const_cast",  "constexpr", "continue",     "decltype", "default",  "delete",
       "do",          "double",    "dynamic_cast", "else",     "enum",     "explicit",
       "export",      "extern",    "false",        "float",    "for",      "friend",
       "goto",        "if",        "inline",       "int",      "long",     "mutable",
       "namespace",   "new",       "noexcept",     "not",      "nullptr",  "operator",
       "or",          "private",   "protected",    "public",   "register", "restrict",
       "return",      "short",     "signed",       "sizeof",   "static",   "static_assert",
       "static_cast", "struct",    "switch",       "template", "this",     "thread_local",
       "throw",       "true",      "try",          "typedef",  "typeid",   "typename",
       "union",       "unsigned",  "using",        "virtual",  "void",     "volatile",
       "wchar_t",     "while",     "xor"});
  return std::ranges::find(kKeywords, name) != kKeywords.end();
}

std::string field(std::string_view name, const std::string& value) {
  return "    ." + std::string{name} + " = " + value + ",\n";
}
std::string field(std::string_view name, float value) {
  return field(name, literal(value));
}
std::string field(std::string_view name, bool value) {
  return field(name, std::string{value ? "true" : "false"});
}
std::string field(std::string_view name, core::Duration value) {
  return field(name, "INT64_C(" + std::to_string(value.ns()) + ")");
}

/// One line for each of the first modes, which have an effect. C makes zeros of the others, and
/// that is what unused means.
template <class Modes>
std::string mode_lines(const std::string& indent, const Modes& modes, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    text += indent + "{.one_minus_phi = " + literal(modes[i].one_minus_phi) +
            ", .noise_variance = " + literal(modes[i].noise_variance) +
            ", .initial_variance = " + literal(modes[i].initial_variance) +
            ", .initial_mean = " + literal(modes[i].initial_mean) + "},\n";
  }
  return text;
}

/// Nothing where there are none: an empty array takes no initialiser.
template <class Modes>
std::string modes(std::string_view name, const Modes& modes, std::size_t count) {
  if (count == 0) return {};
  return field(name, "{\n" + mode_lines("        ", modes, count) + "    }");
}

std::string turn_on(float variance) {
  return core::is_finite(variance) ? literal(variance) : "ZERORATE_UNKNOWN_VARIANCE";
}

/// In braces. @param ends what stands at both ends  @param middle what stands between the lines
std::string temperature(const core::TemperatureDrift& drift, const std::string& ends,
                        const std::string& middle) {
  return "{.reference_degc = " + literal(drift.reference_degc) + ends +
         ".slope_rad_s_per_k = " + literal(drift.slope_rad_s_per_k) +
         ", .slope_sigma_rad_s_per_k = " + literal(drift.slope_sigma_rad_s_per_k) + middle +
         ".curvature_rad_s_per_k2 = " + literal(drift.curvature_rad_s_per_k2) +
         ", .curvature_sigma_rad_s_per_k2 = " + literal(drift.curvature_sigma_rad_s_per_k2) + ends +
         ".lag_s = " + literal(drift.lag_s) + "}";
}

/// A list of the first numbers in braces.
std::string numbers(const float* first, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += (i == 0 ? "" : ", ") + literal(first[i]);
  return "{" + text + "}";
}

/// Refusal of a library that is too small for the model, by the compiler.
std::string size_guard(std::string_view size, std::size_t needed) {
  if (needed == 0) return {};
  return "#if " + std::string{size} + " < " + std::to_string(needed) +
         "\n#error \"this model needs " + std::string{size} + " of " + std::to_string(needed) +
         " or more\"\n#endif\n";
}

/// Places of the hold-back line that a node with the default hold-back needs.
std::int64_t places_needed(core::Duration filter_tick) {
  return core::places_needed(core::Standstill::Params{}.hold_back, filter_tick);
}

/// Refusal of a filter rate whose ticks find no place in the line.
/// @param capacity  what the firmware names the number of places
void require_places(core::Duration filter_tick, std::int64_t held_ticks,
                    const std::string& capacity) {
  constexpr core::Duration kHoldBack = core::Standstill::Params{}.hold_back;
  const std::int64_t needed = places_needed(filter_tick);
  if (needed <= held_ticks) return;
  const std::int64_t slowest_refused = held_ticks - core::kPlacesOfWork + 1;
  const std::string most =
      slowest_refused > 0
          ? "lower the filter rate (--filter-rate) below " +
                rate_of(core::Duration::nanoseconds(kHoldBack.ns() / slowest_refused)) + ", or "
          : std::string{};
  throw std::invalid_argument(
      "a filter of " + rate_of(filter_tick) + " needs " + std::to_string(needed) +
      " places for the ticks that the default configuration holds back, and the firmware has " +
      std::to_string(held_ticks) + ": " + most + "compile it with " + capacity + " of " +
      std::to_string(needed) + " and export with --held-ticks " + std::to_string(needed));
}

template <core::ModelShape Shape>
std::string hypothesis_lines(const core::Hypotheses<Shape>& hypotheses, std::size_t decaying) {
  std::string text;
  for (std::size_t m = 0; m < hypotheses.count; ++m) {
    const auto& one = hypotheses.all[m];
    text +=
        "        {.strength = " + numbers(one.strength.data(), decaying) +
        ",\n         .log_prior = " + literal(one.log_prior) + ", .level = " + literal(one.level) +
        ", .order = " + literal(one.order) +
        ",\n         .bias_instability_rad_s = " + literal(one.bias_instability_rad_s) +
        ", .angle_random_walk_rad_per_sqrt_s = " + literal(one.angle_random_walk_rad_per_sqrt_s) +
        "},\n";
  }
  return text;
}

/// Known errors of the scale factors, to the last axis that has one.
std::vector<float> scale_factor_errors(const SensorModel& model) {
  std::vector<float> errors;
  for (const double error : model.scale_factor.value_or(ScaleFactor{}).error) {
    errors.push_back(static_cast<float>(error));
  }
  while (!errors.empty() && errors.back() == 0.0F) errors.pop_back();
  return errors;
}
/// Nothing where none is known: C makes zeros of it.
std::string scale_factor_error(const std::vector<float>& errors) {
  if (errors.empty()) return {};
  return field("scale_factor_error", numbers(errors.data(), errors.size()));
}

/// Hypotheses of the flicker; nothing where the model is taken at its word.
std::string hypotheses(const core::Hypotheses<kCApiShape>& all, std::size_t decaying) {
  if (all.count == 0) return {};
  return "#if ZERORATE_HYPOTHESES >= " + std::to_string(all.count) + "\n" +
         field("hypothesis_count", std::to_string(all.count)) + field("evidence_kept", all.kept) +
         field("hypotheses", "{\n" + hypothesis_lines(all, decaying) + "    }") + "#endif\n";
}

}  // namespace

std::string format_c_header(const SensorModel& model, core::Duration sample_period,
                            core::Duration filter_tick, std::string_view name,
                            std::int64_t held_ticks) {
  if (!is_identifier(name) || is_keyword(name)) {
    throw std::invalid_argument(
        "the name \"" + std::string{name} +
        "\" cannot name a constant in C; expected letters, digits and _, and no "
        "keyword");
  }
  auto node = make_node_model<kCApiShape>(model, sample_period, filter_tick);
  const auto [decaying, rotating] = move_active_to_front(node);
  if (node.samples.is_on()) {
    throw std::invalid_argument(
        "the model \"" + model.name +
        "\" describes single samples (outliers, motion_contamination, variable_noise or "
        "saturation); the C interface takes none of these tables");
  }
  require_places(filter_tick, held_ticks, "ZERORATE_HELD_TICKS");
  const std::vector<float> errors = scale_factor_errors(model);
  const std::int64_t places = places_needed(filter_tick);
  const std::string constant{name};
  std::string guard = constant + "_H";
  std::transform(guard.begin(), guard.end(), guard.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return "/** @file Sensor model: " + in_comment(model.name) +
         ".\n"
         " *  For " +
         rates(sample_period, filter_tick) +
         ".\n"
         " *  Made by `zerorate export --c`; change the model and make it again. */\n"
         "#ifndef " +
         guard + "\n#define " + guard +
         "\n\n"
         "#include <zerorate.h>\n\n" +
         size_guard("ZERORATE_DECAYING_MODES", decaying) +
         size_guard("ZERORATE_ROTATING_MODES", rotating) +
         size_guard("ZERORATE_AXES", errors.size()) +
         size_guard("ZERORATE_TEMPERATURE", node.temperature.is_on() ? 1 : 0) +
         size_guard("ZERORATE_HELD_TICKS",
                    places > kCApiHeldTicks ? static_cast<std::size_t>(places) : 0) +
         "\n// clang-format off\n"
         "static const zerorate_model " +
         constant + " = {\n" + field("sample_period_ns", sample_period) +
         field("tick_ns", filter_tick) +
         field("starts_stationary", node.modes.start == core::Start::stationary) +
         field("is_stationary", node.modes.is_stationary) +
         field("walk_variance_rad2_s2", node.modes.walk_variance) +
         field("white_variance_rad2_s2", node.white_variance_rad2_s2) +
         field("measurement_floor_variance_rad2_s2", node.measurement_floor_variance_rad2_s2) +
         field("turn_on_variance_rad2_s2", turn_on(node.turn_on_variance_rad2_s2)) +
         (core::is_finite(node.largest_bias_rad_s)
              ? field("largest_bias_rad_s", node.largest_bias_rad_s)
              : std::string{}) +
         field("scale_factor_sigma", node.motion.scale_factor) +
         field("asymmetry_sigma", node.motion.asymmetry) + scale_factor_error(errors) +
         field("gate_threshold_sigma", node.gate.threshold_sigma) +
         field("gate_longest_knock_ticks", std::to_string(node.gate.longest_knock_ticks)) +
         modes("decaying", node.modes.decaying, decaying) +
         modes("rotating", node.modes.rotating, rotating) +
         (node.temperature.is_on()
              ? field("temperature", temperature(node.temperature, ",\n        ", ",\n        "))
              : std::string{}) +
         hypotheses(node.hypotheses, decaying) +
         "};\n"
         "// clang-format on\n\n"
         "#endif\n";
}

namespace {

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

std::string temperature_member(const core::TemperatureDrift& drift) {
  if (!drift.is_on()) return {};
  return "    .temperature = " + temperature(drift, ", ", ",\n                    ") + ",\n";
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
std::string hypotheses_member(const core::Hypotheses<kLargestLearningShape>& all,
                              std::size_t decaying) {
  if (all.count == 0) return {};
  return "    .hypotheses = {.count = " + std::to_string(all.count) +
         ", .kept = " + literal(all.kept) + ", .all = {{\n" + hypothesis_lines(all, decaying) +
         "    }}},\n";
}

/// Nothing where no error of a scale factor is known, which is the default.
std::string scale_member(const core::ScaleCorrection& scale) {
  if (!scale.is_on()) return {};
  return "    .scale = {.factor = {" + numbers(scale.factor.data(), scale.factor.size()) + "}},\n";
}

/// Nothing where the model names no step, which is the default.
std::string step_member(float step_rad_s) {
  if (step_rad_s == 0.0F) return {};
  return "    .quantization_step_rad_s = " + literal(step_rad_s) + ",\n";
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
         ", .temperature_weights = " +
         std::to_string(node.temperature.is_on() ? kLargestShape.temperature_weights : 0) +
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
         temperature_member(node.temperature) + samples(node.samples) +
         "    .motion = {.scale_factor = " + literal(node.motion.scale_factor) +
         ", .asymmetry = " + literal(node.motion.asymmetry) + "},\n" + scale_member(node.scale) +
         "    .sample_period = " + nanoseconds(sample_period) + ",\n" +
         hypotheses_member(node.hypotheses, decaying) + step_member(node.quantization_step_rad_s) +
         "}};\n"
         "// clang-format on\n\n"
         "}  // namespace zerorate::exported\n";
}

}  // namespace zerorate::model
