#include "host_tools/lib/diagnose/inputs/input_words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <utility>

#include "host_tools/lib/diagnose/inputs/input_effects.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

Parameter parameter_of(std::string name, double value_rad_s, double error_rad_s) {
  const double value = value_rad_s * kDegPerRad;
  const double reach = statistics::kHalfWidth95 * error_rad_s * kDegPerRad;
  return {std::move(name), value, value - reach, value + reach};
}

/// "The biases of the 38 standstills then scatter by 0.021 instead of 0.083 deg/s."
std::string scatter_in_words(const Spread& spread) {
  if (spread.standstills < 2) return "";
  return fmt::format(
      " Without its share the biases of the {} standstills scatter by {} instead of {} deg/s.",
      spread.standstills, units::in_figures(spread.after_rad_s * kDegPerRad),
      units::in_figures(spread.before_rad_s * kDegPerRad));
}

std::string sensitivity_in_words(const InputEffect& effect) {
  std::vector<std::string> told;
  std::vector<std::string_view> untold;
  constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    if (std::isfinite(effect.standard_error_rad_s[axis])) {
      told.push_back(
          fmt::format("{:.2g} along {}", effect.value_rad_s[axis] * kDegPerRad, kAxes[axis]));
    } else {
      untold.push_back(kAxes[axis]);
    }
  }
  std::string text = "The bias follows the acceleration";
  if (!told.empty()) text += fmt::format(", by {} deg/s per g", fmt::join(told, ", "));
  text += ".";
  if (!untold.empty()) {
    text += fmt::format(
        " The attitudes do not tell the sensitivity along {}: there it is one with the bias.",
        fmt::join(untold, " and "));
  }
  return text;
}

std::string worth_in_words(const InputEffect& effect) {
  if (!effect.worth || !effect.pays()) return "";
  return fmt::format(" Each of the {} standstills held out is predicted {:.2g} nats better.",
                     effect.worth->standstills, effect.worth->gain_nats_a_standstill);
}

}  // namespace

std::vector<Parameter> parameters_of(const InputEffect& effect) {
  if (effect.name == kVibrationRectification) {
    return {parameter_of("rectification_dps_per_g2", effect.value_rad_s[0],
                         effect.standard_error_rad_s[0])};
  }
  std::vector<Parameter> parameters;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(effect.standard_error_rad_s[axis])) continue;
    parameters.push_back(parameter_of(fmt::format("along_{}_dps_per_g", "xyz"[axis]),
                                      effect.value_rad_s[axis], effect.standard_error_rad_s[axis]));
  }
  return parameters;
}

std::string sentence_of(const InputEffect& effect, const Spread& spread) {
  const std::string text =
      effect.name == kVibrationRectification
          ? fmt::format("The bias follows the vibration, by {:.3g} deg/s per g^2.",
                        effect.value_rad_s[0] * kDegPerRad)
          : sensitivity_in_words(effect);
  return text + scatter_in_words(spread) + worth_in_words(effect);
}

std::string reason_to_leave_out(const InputEffect& effect) {
  if (effect.pays()) return "";
  return fmt::format("on the {} standstills held out it predicts no better: {:.2g} nats each",
                     effect.worth->standstills, effect.worth->gain_nats_a_standstill);
}

std::string remark_on(std::size_t standstills) {
  return fmt::format(
      "Whether the bias follows the acceleration cannot be told: in {} a g sensitivity and a "
      "constant bias are one. Record eight attitudes or more, with each side of the sensor "
      "downwards once, at rest for half a minute in each.",
      standstills < 2 ? "one attitude" : "so few attitudes");
}

}  // namespace zerorate::diagnose
