/// @file
/// A model as C or C++ source, for firmware that has no file system to read it from.
#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/complex.hpp"
#include "core/base/time.hpp"
#include "core/noise/inputs.hpp"
#include "firmware/model/hypotheses.hpp"
#include "firmware/model/sensor_model.hpp"

namespace zerorate::model {

/// The modes that a node behind the C interface has room for.
inline constexpr core::ModelShape kCApiShape{.decaying = 7,
                                             .rotating = 1,
                                             .inputs = core::TemperatureDrift::kTerms,
                                             .hypotheses = kMostHypotheses};

/// Places of the hold-back line behind the C interface and in a node, as they are by default.
inline constexpr std::int64_t kCApiHeldTicks = 16;
inline constexpr std::int64_t kNodeHeldTicks = 64;

/// A header that defines `static const zerorate_model NAME`. Every number is the shortest decimal
/// from which the compiler makes the same bits. The step of a quantizer is left out: the node sees
/// it in the samples. Throws what make_node_model() throws, and std::invalid_argument where `name`
/// is no identifier or the default hold-back needs more than `held_ticks` places, which
/// zerorate_init() refuses.
[[nodiscard]] std::string format_c_header(const SensorModel& model, core::Duration sample_period,
                                          core::Duration filter_tick, std::string_view name,
                                          std::int64_t held_ticks = kCApiHeldTicks);

/// A header that defines the constants of namespace zerorate::exported: `kModelShape` and
/// `kNodeParams`, an app::NodeParams with exactly the modes that the model needs and the default
/// times of standstill. Every number is the shortest decimal from which the compiler makes the
/// same bits. Throws what make_full_node_model() throws, and std::invalid_argument where the
/// default hold-back needs more than `held_ticks` places, which a node refuses.
[[nodiscard]] std::string format_cpp_header(const SensorModel& model, core::Duration sample_period,
                                            core::Duration filter_tick,
                                            std::int64_t held_ticks = kNodeHeldTicks);

/// The shortest decimal from which a compiler makes the same bits. The value must be finite.
[[nodiscard]] inline std::string literal(float value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  std::string text{digits.data(), end};
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text + "F";
}
[[nodiscard]] inline std::string literal(const core::Complex& value) {
  return "{" + literal(value.re) + ", " + literal(value.im) + "}";
}

/// Rate of what comes once a period, in whole millihertz.
[[nodiscard]] inline std::string rate_of(core::Duration period) {
  constexpr std::int64_t kMilliseconds = 1'000'000'000'000;
  const std::int64_t millihertz = (kMilliseconds + period.ns() / 2) / period.ns();
  std::string fraction = std::to_string(millihertz % 1000 + 1000).substr(1);
  return std::to_string(millihertz / 1000) + "." + fraction + " Hz";
}

/// For a comment: the rates that a model was exported for.
[[nodiscard]] inline std::string rates(core::Duration sample_period, core::Duration filter_tick) {
  return rate_of(sample_period) + " samples and " + rate_of(filter_tick) + " ticks of the filter";
}

/// For a comment: a name cannot end it and go on as source.
[[nodiscard]] inline std::string in_comment(std::string text) {
  for (char& character : text) {
    const bool is_control = static_cast<unsigned char>(character) < ' ';
    if (is_control || character == '\\' || character == '*') character = ' ';
  }
  return text;
}

}  // namespace zerorate::model
