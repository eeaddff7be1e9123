#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "firmware/model/node_model.hpp"
#include "firmware/model/source_headers.hpp"
#include "firmware/model/source_pieces.hpp"

namespace zerorate::model {
namespace {

using namespace source;

/// Shape of a library that was compiled for every input.
constexpr core::ModelShape kWidestCApiShape = with_all_inputs(kCApiShape);

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

/// Nothing where there are none: an empty array takes no initialiser.
template <class Modes>
std::string modes(std::string_view name, const Modes& modes, std::size_t count) {
  if (count == 0) return {};
  return field(name, "{\n" + mode_lines("        ", modes, count) + "    }");
}

std::string turn_on(float variance) {
  return core::is_finite(variance) ? literal(variance) : "ZERORATE_UNKNOWN_VARIANCE";
}

template <std::size_t K>
bool follows_temperature(const core::InputTerms<K>& inputs) {
  return inputs.terms[0].input == core::Input::temperature;
}

/// Nothing where the model follows no temperature: C makes zeros of it.
template <std::size_t K>
std::string temperature(const core::InputTerms<K>& inputs) {
  if (!follows_temperature(inputs)) return {};
  const auto& [slope, curvature] = std::tie(inputs.terms[0], inputs.terms[1]);
  return field("temperature",
               "{.reference_degc = " + literal(inputs.reference_degc) +
                   ",\n        .slope_rad_s_per_k = " + literal(slope.coefficient[0]) +
                   ", .slope_sigma_rad_s_per_k = " + literal(slope.sigma) +
                   ",\n        .curvature_rad_s_per_k2 = " + literal(curvature.coefficient[0]) +
                   ", .curvature_sigma_rad_s_per_k2 = " + literal(curvature.sigma) +
                   ",\n        .lag_s = " + literal(inputs.lag_s) + "}");
}

/// Names of core::Input in C; slope and curvature of the temperature stand apart there.
constexpr std::array<std::string_view, core::kInputs> kNamesInC{"",
                                                                "",
                                                                "",
                                                                "ZERORATE_TEMPERATURE_RATE",
                                                                "ZERORATE_ACCELERATION_X",
                                                                "ZERORATE_ACCELERATION_Y",
                                                                "ZERORATE_ACCELERATION_Z",
                                                                "ZERORATE_VIBRATION"};

/// Terms of a model in C beside those of the temperature.
template <std::size_t K>
std::vector<core::InputTerm> other_inputs(const core::InputTerms<K>& inputs) {
  std::vector<core::InputTerm> others;
  std::ranges::copy_if(inputs.terms, std::back_inserter(others), [](const auto& term) {
    return !kNamesInC.at(static_cast<std::size_t>(term.input)).empty();
  });
  return others;
}

std::string input_fields(const std::vector<core::InputTerm>& inputs) {
  if (inputs.empty()) return {};
  std::string text;
  for (const core::InputTerm& term : inputs) {
    text +=
        "        {.quantity = " + std::string{kNamesInC.at(static_cast<std::size_t>(term.input))} +
        ", .sigma = " + literal(term.sigma) +
        ", .coefficient = " + numbers(term.coefficient.data(), term.coefficient.size()) + "},\n";
  }
  return field("inputs", "{\n" + text + "    }");
}

/// Refusal of a library that is too small for the model, by the compiler.
std::string size_guard(std::string_view size, std::size_t needed) {
  if (needed == 0) return {};
  return "#if " + std::string{size} + " < " + std::to_string(needed) +
         "\n#error \"this model needs " + std::string{size} + " of " + std::to_string(needed) +
         " or more\"\n#endif\n";
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

/// Nothing where it is what C makes of zeros.
std::string scale_of_temperature(const core::MotionModel& motion) {
  const core::MotionModel silent{};
  constexpr float kNone = 1e-12F;  // zero is what is usual
  std::string fields;
  if (motion.scale_factor_per_k != silent.scale_factor_per_k) {
    fields += field("scale_factor_sigma_per_k", std::max(motion.scale_factor_per_k, kNone));
  }
  if (motion.scale_factor_at_k != silent.scale_factor_at_k) {
    fields += field("scale_factor_at_k", motion.scale_factor_at_k);
  }
  return fields;
}

/// Nothing where the axis is vertical.
std::string slopes(const core::MotionModel& motion) {
  if (motion.slope_variance_rad2 == 0.0F) return {};
  return field("slope_variance_rad2", motion.slope_variance_rad2);
}

/// Nothing where none is known: C makes zeros of it.
std::string scale_factor_error(const std::vector<float>& errors) {
  if (errors.empty()) return {};
  return field("scale_factor_error", numbers(errors.data(), errors.size()));
}

/// Hypotheses of the flicker; nothing where the model is taken at its word.
std::string hypotheses(const core::Hypotheses<kWidestCApiShape>& all, std::size_t decaying) {
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
  auto node = make_node_model<kWidestCApiShape>(model, sample_period, filter_tick);
  const auto [decaying, rotating] = move_active_to_front(node);
  if (node.samples.is_on()) {
    throw std::invalid_argument(
        "the model \"" + model.name +
        "\" describes single samples (outliers, motion_contamination, variable_noise or "
        "saturation); the C interface takes none of these tables");
  }
  require_places(filter_tick, held_ticks, "ZERORATE_HELD_TICKS");
  const std::vector<float> errors = scale_factor_errors(model);
  const std::vector<core::InputTerm> others = other_inputs(node.inputs);
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
         size_guard("ZERORATE_TEMPERATURE", follows_temperature(node.inputs) ? 1 : 0) +
         size_guard("ZERORATE_INPUTS", others.size()) +
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
         field("scale_factor_sigma", node.motion.scale_factor) + scale_of_temperature(node.motion) +
         field("asymmetry_sigma", node.motion.asymmetry) + slopes(node.motion) +
         scale_factor_error(errors) +
         (node.truncation.is_on() ? field("truncation_step_rad_s", node.quantization_step_rad_s)
                                  : std::string{}) +
         field("gate_threshold_sigma", node.gate.threshold_sigma) +
         field("gate_longest_knock_ticks", std::to_string(node.gate.longest_knock_ticks)) +
         modes("decaying", node.modes.decaying, decaying) +
         modes("rotating", node.modes.rotating, rotating) + temperature(node.inputs) +
         input_fields(others) + hypotheses(node.hypotheses, decaying) +
         "};\n"
         "// clang-format on\n\n"
         "#endif\n";
}

}  // namespace zerorate::model
