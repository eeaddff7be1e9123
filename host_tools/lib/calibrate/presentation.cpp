#include "host_tools/lib/calibrate/presentation.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include "host_tools/lib/units/units.hpp"

namespace zerorate::calibrate {
namespace {

using units::kDegPerRad;

constexpr double kPercent = 100.0;

std::string percent(const RelativeError& error) {
  return fmt::format("{:+.3f} +- {:.3f} %", kPercent * error.value, kPercent * error.half_width());
}

nlohmann::ordered_json to_json(const RelativeError& error) {
  return {{"percent", kPercent * error.value},
          {"sigma_percent", kPercent * error.sigma},
          {"half_width95_percent", kPercent * error.half_width()}};
}

nlohmann::ordered_json to_json(const model::ScaleFactor& scale_factor) {
  nlohmann::ordered_json errors = nlohmann::ordered_json::array();
  for (const double error : scale_factor.error) errors.push_back(kPercent * error);
  return {{"error_percent", errors},
          {"sigma_percent", kPercent * scale_factor.sigma},
          {"asymmetry_percent", kPercent * scale_factor.asymmetry_sigma}};
}

nlohmann::ordered_json to_json(const GuidedTurn& turn, std::size_t axis) {
  // A deviation that is not finite is null.
  return {{"begin_s", turn.begin_s},
          {"length_s", turn.length_s},
          {"turns", turn.rounds(axis)},
          {"angle_deg", turn.angle_rad[axis] * kDegPerRad},
          {"sigma_deg", turn.sigma_rad[axis] * kDegPerRad}};
}

std::string verdict(const Calibration& calibration) {
  const double tolerance = kPercent * calibration.settings.tolerance.sigma;
  if (!calibration.contradicts_tolerance()) {
    return fmt::format("within the tolerance of {:g} % (standard deviation)\n", tolerance);
  }
  return fmt::format(
      "contradicts the tolerance of {:g} % (standard deviation): part of a turn too much, another\n"
      "full scale than the driver's, or a part that is out of its specification. Turn once more\n",
      tolerance);
}

/// A table for the model file.
std::string table(const Calibration& calibration) {
  const model::ScaleFactor scale_factor = calibrated_scale_factor(calibration);
  const auto& error = scale_factor.error;
  std::string text = fmt::format(
      "[scale_factor]\nerror_percent = [{:.3f}, {:.3f}, {:.3f}]\nsigma_percent = {:.3f}\n",
      kPercent * error[0], kPercent * error[1], kPercent * error[2], kPercent * scale_factor.sigma);
  if (scale_factor.asymmetry_sigma > 0.0) {
    text += fmt::format("asymmetry_percent = {:.3f}\n", kPercent * scale_factor.asymmetry_sigma);
  }
  return text;
}

}  // namespace

std::string instruction(const TurnGuide& guide, const TurnGuide::Settings& settings, int turns) {
  const GuidedTurn current = guide.current();
  const double turned = current.rounds(current.axis());
  const std::string rest = fmt::format("{:.0f} of {:.0f} s", guide.rest_s(), settings.rest_s);
  switch (guide.stage()) {
    case TurnGuide::Stage::rest:
      return guide.is_calibrated() || guide.rest_s() < settings.rest_s ? "stand still: " + rest
                                                                       : "stand still: no bias yet";
    case TurnGuide::Stage::ready:
      return fmt::format("turn it {} times{}, stop at the mark", turns,
                         guide.turns().empty() ? "" : " the other way");
    case TurnGuide::Stage::turning:
      return fmt::format("{:+.2f} of {} turns", turned, turns);
    case TurnGuide::Stage::pausing:
      return fmt::format("{:+.2f} of {} turns, stand still: {}", turned, turns, rest);
    case TurnGuide::Stage::done:
      return "done";
  }
  return {};
}

std::string to_text(const Calibration& calibration) {
  const ScaleFit& fit = *calibration.fit;
  std::string text;
  for (const GuidedTurn& turn : calibration.turns) {
    text += fmt::format("turned by {:+.4f} turns in {:.0f} s, +- {:.2f} deg by bias and noise\n",
                        turn.rounds(calibration.axis), turn.length_s,
                        turn.sigma_rad[calibration.axis] * kDegPerRad * statistics::kHalfWidth95);
  }
  text += fmt::format("scale factor error of axis {}: {} (95 % interval)\n",
                      "xyz"[calibration.axis], percent(fit.scale));
  if (fit.asymmetry) text += fmt::format("asymmetry: {}\n", percent(*fit.asymmetry));
  text += verdict(calibration);
  for (const std::string& note : calibration.notes) text += "note: " + note + "\n";
  return text +
         fmt::format(
             "\nWith this in its model (--model-out) a node takes the error off. The tolerance is "
             "that of axis\n{} and of what is left, with {:g} % for temperature and age:\n\n{}",
             "xyz"[calibration.axis], kPercent * calibration.settings.drift_sigma,
             table(calibration));
}

std::string to_json(const Calibration& calibration) {
  nlohmann::ordered_json json{
      {"schema", "zerorate.calibrate-turns/1"},
      {"axis", std::string(1, "xyz"[calibration.axis])},
      {"turns_wanted", calibration.settings.turns},
      {"mark_sigma_deg", calibration.settings.mark_sigma_rad * kDegPerRad},
      {"tolerance_percent", kPercent * calibration.settings.tolerance.sigma},
      {"taken_off_percent", nullptr},
      {"scale_factor", nullptr},
      {"asymmetry", nullptr},
      {"model", nullptr},
      {"contradicts_tolerance", calibration.contradicts_tolerance()},
      {"tilt_deg", calibration.tilt_rad * kDegPerRad},
      {"turns", nlohmann::ordered_json::array()},
      {"problems", calibration.problems},
      {"notes", calibration.notes}};
  if (calibration.settings.taken_off) {
    json["taken_off_percent"] = kPercent * calibration.settings.taken_off->at(calibration.axis);
  }
  if (calibration.fit) {
    json["model"] = to_json(calibrated_scale_factor(calibration));
    json["scale_factor"] = to_json(calibration.fit->scale);
    if (calibration.fit->asymmetry) json["asymmetry"] = to_json(*calibration.fit->asymmetry);
  }
  for (const GuidedTurn& turn : calibration.turns) {
    json["turns"].push_back(to_json(turn, calibration.axis));
  }
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace zerorate::calibrate
