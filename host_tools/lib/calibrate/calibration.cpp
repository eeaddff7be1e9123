#include "host_tools/lib/calibrate/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_tools/lib/live/view.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::calibrate {
namespace {

using units::kDegPerRad;

/// A tilt that takes 0.14 %, which is the 95 % interval of ten turns.
constexpr double kSmallTilt_rad = 3.0 / kDegPerRad;
/// The rate of a turn by hand changes by 20 deg/s within a second: over such a gap the turn is sure
/// to 0.7 deg (TurnSum).
constexpr double kLongestSilence_s = 0.25;
/// Scale factor errors that a model states are below.
constexpr double kLargestError = 0.2;

double tilt_rad(const GuidedTurn& turn) {
  const std::size_t axis = turn.axis();
  const double others = std::hypot(turn.angle_rad[(axis + 1) % 3], turn.angle_rad[(axis + 2) % 3]);
  return std::atan2(others, std::abs(turn.angle_rad[axis]));
}

/// Whether the bias took up a part of the turn. The change of the bias, times the length of the
/// turn, is compared with its interval and with a hundredth of a full turn.
bool takes_turn_for_bias(const GuidedTurn& turn, std::size_t axis) {
  constexpr double kSmall_rad = 0.02 * std::numbers::pi;
  const double changed_rad = turn.bias_step_rad_s[axis] * turn.length_s;
  return changed_rad > 5.0 * std::hypot(turn.sigma_rad[axis], kSmall_rad);
}

/// The reason why one turn cannot be used; empty where it can.
std::string problem_of(const GuidedTurn& turn, const Calibration& calibration) {
  const double counted = std::abs(turn.rounds(calibration.axis));
  const int wanted = calibration.settings.turns;
  if (!turn.is_over) return "the messages end before it stood still; stand still at the end";
  if (turn.axis() != calibration.axis) {
    return fmt::format("it was about axis {}, the first about {}; turn about one axis",
                       "xyz"[turn.axis()], "xyz"[calibration.axis]);
  }
  if (turn.alarms.saturated) return "the gyro was at full scale; turn more slowly";
  if (!std::isfinite(turn.sigma_rad[calibration.axis])) {
    return "the node lost the turn, or had no bias before it; stand still for longer";
  }
  if (turn.silence_s > kLongestSilence_s) {
    return fmt::format("the gyro gave no sample for {:.2g} s; turn again", turn.silence_s);
  }
  if (takes_turn_for_bias(turn, calibration.axis)) {
    return fmt::format(
        "the bias of the node changed by {:.2g} deg/s meanwhile: it takes a long steady turn for a "
        "change of the bias; turn unevenly or faster",
        turn.bias_step_rad_s[calibration.axis] * kDegPerRad);
  }
  if (counted < 0.5) {
    return fmt::format("it went there and back, {:.1f} turns; stand still for as long in between",
                       0.5 * turn.farthest_rad[calibration.axis] / std::numbers::pi);
  }
  if (const long nearest = std::lround(counted); nearest != wanted) {
    return fmt::format("{:.2f} turns are nearer to {} than to {}; count again, or say --turns {}",
                       counted, nearest, wanted, nearest);
  }
  return {};
}

void find_problems(const TurnGuide& guide, Calibration& calibration) {
  if (calibration.turns.empty()) {
    for (const GuidedTurn& turn : guide.early_turns()) {
      calibration.problems.push_back(
          fmt::format("{:.1f} turns began after a rest of {:.0f} s only; stand still for longer",
                      0.5 * turn.farthest_rad[turn.axis()] / std::numbers::pi, turn.rest_s));
    }
    if (calibration.problems.empty()) {
      calibration.problems.emplace_back(
          guide.is_calibrated()
              ? "no turn was seen; turn it at least once around after it stood still"
              : "the node has measured no bias; stand still until it has");
    }
  }
  for (std::size_t i = 0; i < calibration.turns.size(); ++i) {
    const std::string problem = problem_of(calibration.turns[i], calibration);
    if (!problem.empty())
      calibration.problems.push_back(fmt::format("turn {}: {}", i + 1, problem));
  }
}

ScaleFit fit_of(const Calibration& calibration) {
  std::vector<CountedTurn> counted;
  for (const GuidedTurn& turn : calibration.turns) {
    const double angle_rad = turn.angle_rad[calibration.axis];
    const int turns = calibration.settings.turns;
    counted.push_back({.measured_rad = angle_rad,
                       .sigma_rad = turn.sigma_rad[calibration.axis],
                       .turns = angle_rad > 0.0 ? turns : -turns});
  }
  return fit_scale(counted, {.mark_sigma_rad = calibration.settings.mark_sigma_rad,
                             .asymmetry_sigma = calibration.settings.tolerance.asymmetry_sigma});
}

/// Alarms that belong to a turn by hand are none: a turn without pulses contradicts an odometer.
std::string alarms_of(const GuidedTurn& turn) {
  app::Health alarms = turn.alarms;
  alarms.calibrated = true;
  alarms.odometer_disagreement = false;
  return alarms == app::Health{.calibrated = true} ? "" : live::describe(alarms);
}

void note_turns(const TurnGuide& guide, Calibration& calibration) {
  for (std::size_t i = 0; i < calibration.turns.size(); ++i) {
    const GuidedTurn& turn = calibration.turns[i];
    if (const std::string alarms = alarms_of(turn); !alarms.empty()) {
      calibration.notes.push_back(fmt::format("in turn {} the node reported: {}", i + 1, alarms));
    }
    if (turn.lost_messages > 0) {
      calibration.notes.push_back(
          fmt::format("in turn {} {} messages were lost, which costs nothing: the node has the sum",
                      i + 1, turn.lost_messages));
    }
  }
  if (!guide.early_turns().empty() && !calibration.turns.empty()) {
    calibration.notes.push_back(fmt::format(
        "{} turns that began after too short a rest were left out", guide.early_turns().size()));
  }
  if (guide.restarts() > 0) {
    calibration.notes.push_back(fmt::format(
        "the node started anew {} times, and a turn meanwhile was left out", guide.restarts()));
  }
}

void note_fit(Calibration& calibration) {
  if (calibration.tilt_rad > kSmallTilt_rad) {
    calibration.notes.push_back(fmt::format(
        "the axis is askew by {:.1f} deg: it measures the cosine, {:.2f} % less, and the figure "
        "contains that. It is right for a vehicle in which the sensor stands the same way",
        calibration.tilt_rad * kDegPerRad, 100.0 * calibration.tilt_loss()));
  }
  if (!calibration.settings.taken_off) {
    calibration.notes.emplace_back(
        "the model of the node is not known here (--model): the error comes on top of the one that "
        "this model states in error_percent");
  } else if (const double known = (*calibration.settings.taken_off).at(calibration.axis);
             known != 0.0) {
    calibration.notes.push_back(
        fmt::format("the node takes {:+.3f} % off already, and the turns show what is left: "
                    "error_percent is of both",
                    100.0 * known));
  }
  if (!calibration.fit->asymmetry) {
    calibration.notes.emplace_back(
        "all turns had the same sense: an asymmetry is part of the figure; turn the other way, "
        "too");
  }
  const CalibrationSettings& settings = calibration.settings;
  if (statistics::kHalfWidth95 * settings.tolerance.sigma * settings.turns > 0.5) {
    calibration.notes.push_back(fmt::format(
        "with a tolerance of {:g} % the gyro cannot tell whether {} turns were miscounted by one; "
        "begin with {} turns",
        100.0 * settings.tolerance.sigma, settings.turns,
        std::max(1, static_cast<int>(0.25 / settings.tolerance.sigma))));
  }
}

}  // namespace

bool Calibration::contradicts_tolerance() const {
  if (!fit) return false;
  const double sigma = std::hypot(settings.tolerance.sigma, fit->scale.sigma);
  return std::abs(fit->scale.value) > statistics::kHalfWidth95 * sigma;
}

double whole_error(const Calibration& calibration, double found) {
  const auto taken_off = calibration.settings.taken_off.value_or(std::array<double, 3>{});
  return (1.0 + taken_off.at(calibration.axis)) * (1.0 + found) - 1.0;
}

Calibration calibrate(const TurnGuide& guide, const CalibrationSettings& settings) {
  Calibration calibration{.settings = settings, .turns = guide.turns()};
  if (!calibration.turns.empty()) calibration.axis = calibration.turns.front().axis();
  for (const GuidedTurn& turn : calibration.turns) {
    calibration.tilt_rad = std::max(calibration.tilt_rad, tilt_rad(turn));
  }
  find_problems(guide, calibration);
  note_turns(guide, calibration);
  if (!calibration.problems.empty()) return calibration;
  const ScaleFit fit = fit_of(calibration);
  const double error = whole_error(calibration, fit.scale.value);
  if (!(std::abs(error) < kLargestError)) {
    calibration.problems.push_back(fmt::format(
        "the scale factor would be off by {:.0f} %, more than a gyro's; stop at the mark "
        "from which it began",
        100.0 * error));
    return calibration;
  }
  calibration.fit = fit;
  note_fit(calibration);
  return calibration;
}

model::ScaleFactor calibrated_scale_factor(const Calibration& calibration) {
  const ScaleFit& fit = *calibration.fit;
  const CalibrationSettings& settings = calibration.settings;
  model::ScaleFactor scale_factor = settings.tolerance;
  const double error = whole_error(calibration, fit.scale.value);
  scale_factor.error.at(calibration.axis) = error;
  scale_factor.sigma = std::hypot(fit.scale.sigma, settings.drift_sigma);
  scale_factor.source = fmt::format(
      "zerorate calibrate turns: {} turns about axis {}, error {:+.3f} +- {:.3f} %; the tolerance "
      "is what is left, with a drift of {:g} %",
      settings.turns, "xyz"[calibration.axis], 100.0 * error, 100.0 * fit.scale.half_width(),
      100.0 * settings.drift_sigma);
  const auto& asymmetry = fit.asymmetry;
  if (asymmetry && std::abs(asymmetry->value) > asymmetry->half_width()) {
    scale_factor.asymmetry_sigma = std::hypot(asymmetry->value, asymmetry->sigma);
  }
  return scale_factor;
}

}  // namespace zerorate::calibrate
