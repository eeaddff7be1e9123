#include "host_tools/lib/diagnose/presentation/presentation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::in_figures;

/// How far a row is outside, as the factor that a reader sees: below or above the nearer end.
double departure(const Misfit& row) {
  const double end = row.measured > row.simulated_hi ? row.simulated_hi : row.simulated_lo;
  const double least = 1e-300;
  return std::abs(
      std::log(std::max(std::abs(row.measured), least) / std::max(std::abs(end), least)));
}

bool is_positive(const Misfit& row) {
  return row.measured > 0.0 && row.simulated_lo > 0.0;
}

/// The figure of the recording with its unit: "0.0126 deg/s".
std::string measured(const Misfit& row) {
  const std::string_view unit = unit_of(row.statistic);
  return fmt::format("{}{}{}", in_figures(row.measured), unit.empty() ? "" : " ", unit);
}

/// "The Allan deviation (tau 200 s) is 0.0126 deg/s, 2.1 times the most that white noise, 1/f noise
/// and a constant give", or the simulations' range where a ratio means nothing.
std::string misfit_sentence(const Misfit& row, bool is_base_given) {
  const std::string_view base =
      is_base_given ? "simulations of the given model" : "white noise, 1/f noise and a constant";
  std::string what = plain_statistic(row.statistic);
  what[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(what[0])));
  const std::string where = row.where.empty() ? "" : fmt::format(" ({})", row.where);
  if (is_positive(row) && departure(row) > 0.05) {
    const bool above = row.measured > row.simulated_hi;
    const double end = above ? row.simulated_hi : row.simulated_lo;
    return fmt::format("{}{} is {}, {:.2g} times the {} that {} give.", what, where, measured(row),
                       row.measured / end, above ? "most" : "least", base);
  }
  return fmt::format("{}{} is {}, where {} give {} to {}.", what, where, measured(row), base,
                     in_figures(row.simulated_lo), in_figures(row.simulated_hi));
}

const Misfit* worst_misfit(const Diagnosis& diagnosis) {
  const Misfit* worst = nullptr;
  for (const Misfit& row : diagnosis.misfit) {
    if (!row.is_outside()) continue;
    if (worst == nullptr || (is_positive(row) && departure(row) > departure(*worst))) worst = &row;
  }
  return worst;
}

/// The next best effect that does not do, each added alone.
std::optional<std::string> rejected_rival(const Diagnosis& diagnosis) {
  const auto chosen = std::ranges::find(diagnosis.evidence, true, &SelectionEvidence::selected);
  if (chosen == diagnosis.evidence.end()) return std::nullopt;
  // Alternatives are compared this way: with the price of parameters and search taken off.
  const auto worth = [](const SelectionEvidence& evidence) {
    return evidence.gain_nats - evidence.price_nats;
  };
  const auto& alternatives = diagnosis.causes.front().alternatives;
  const auto is_rejected = [&](const SelectionEvidence& evidence) {
    return !evidence.selected && evidence.not_examined.empty() && worth(evidence) > 0.0 &&
           worth(*chosen) - worth(evidence) > kAlternativeNats &&
           std::ranges::find(alternatives, evidence.effect, &Alternative::effect) ==
               alternatives.end();
  };
  const auto rival = std::ranges::find_if(diagnosis.evidence, is_rejected);
  if (rival == diagnosis.evidence.end()) return std::nullopt;
  return fmt::format(" Of the others {} comes nearest and does not do ({:.0f} nats worse).",
                     plain_name(rival->effect), worth(*chosen) - worth(*rival));
}

/// "This recording cannot decide between rate random walk (56 %) and fractional order (41 %)."
std::string one_of(const Cause& cause) {
  std::vector<std::string> names;
  for (const Explanation& one : cause.set95) {
    names.push_back(fmt::format("{} ({:.0f} %)", plain_name(one.effect), 100.0 * one.probability));
  }
  return fmt::format(" This recording cannot decide: it is one of {}.", fmt::join(names, ", "));
}

std::string cause_sentences(const Diagnosis& diagnosis) {
  std::string text;
  for (const Cause* cause : causes_by_cost(diagnosis)) {
    text += " " + cause->sentence;
    if (!cause->stands_alone()) {
      text += one_of(*cause);
    } else if (!cause->alternatives.empty()) {
      const Alternative& rival = cause->alternatives.front();
      text += fmt::format(
          " {:.0f} % speak for it; {} explains it almost as well ({:.1f} nats less).",
          100.0 * cause->probability, plain_name(rival.effect), rival.less_likely_by_nats);
    }
  }
  if (diagnosis.causes.size() == 1 && diagnosis.causes.front().axes == 1)
    text += rejected_rival(diagnosis).value_or("");
  return text;
}

/// Heading and coverage of drives of one length through the node, each after a stop.
std::string drive_sentences(const Gain& gain) {
  const BootstrapFigure& after = gain.heading_drift_extended_deg;
  const double ratio = gain.heading_drift_ratio.value;
  const double covered = 100.0 * gain.coverage95_extended.value;
  const double covered_before = 100.0 * gain.coverage95_base.value;
  const bool same = gain.heading_drift_ratio.lo <= 1.0 && gain.heading_drift_ratio.hi >= 1.0;
  const bool same_coverage = std::abs(covered - covered_before) < 0.5;
  if (same && std::abs(ratio - 1.0) < 0.02 && same_coverage) {
    return fmt::format(
        " Neither the heading drift ({} deg in a drive of {:.0f} s) nor the coverage of the 95 % "
        "interval ({:.0f} %) changes.",
        in_figures(after.value), gain.drive_s, covered);
  }
  return fmt::format(
      " With its extensions the heading drift in a drive of {:.0f} s {} from {} to {} deg "
      "[{}, {}], and the 95 % interval covers {:.0f} % {} {:.0f} %.",
      gain.drive_s, ratio < 1.0 ? "falls" : "rises", in_figures(gain.heading_drift_base_deg.value),
      in_figures(after.value), in_figures(after.lo), in_figures(after.hi), covered,
      same_coverage ? "as before, nominal is" : "instead of",
      same_coverage ? 95.0 : covered_before);
}

std::string gain_sentence(const Gain& gain) {
  if (!gain.is_measured()) return "";
  constexpr double kShortDrive_s = 30.0;
  if (gain.has_drives()) {
    return drive_sentences(gain) +
           (gain.drive_s < kShortDrive_s
                ? " Longer drives do not fit into the part of the recording that was held out."
                : "");
  }
  const auto& score = gain.log_score_gain_nats_per_sample;
  if (!std::isfinite(score.value)) return "";
  return fmt::format(
      " With it each sample that was held out is predicted {:.2g} nats better "
      "[{:.2g}, {:.2g}].",
      score.value, score.lo, score.hi);
}

/// Sentences on the causes that the model has, those that it leaves out and why, and its gain.
std::string model_sentences(const Diagnosis& diagnosis) {
  std::string text;
  bool is_extended = false;
  for (const Cause& cause : diagnosis.causes) {
    is_extended |= cause.in_model;
    if (cause.in_model) continue;
    text += fmt::format(" The model leaves out the {}: {}.", plain_name(cause.effect),
                        cause.left_out_because);
  }
  if (is_extended) return text + gain_sentence(diagnosis.gain);
  return text + " The model is that of zerorate characterize.";
}

std::string what_is_left(const Diagnosis& diagnosis) {
  const auto& failures = diagnosis.extended_adequacy.failures;
  std::string text = diagnosis.causes.empty()
                         ? " No effect of the catalogue explains it"
                         : " Not everything is explained, so no cause is proven";
  text += failures.empty() ? "." : fmt::format(": {}.", failures.front());
  return text;
}

}  // namespace

std::vector<const Cause*> causes_by_cost(const Diagnosis& diagnosis) {
  std::vector<const Cause*> causes;
  for (const Cause& cause : diagnosis.causes) causes.push_back(&cause);
  std::ranges::stable_sort(causes, {}, [](const Cause* cause) {
    return cause->heading_drift_ratio ? cause->heading_drift_ratio->value
                                      : std::numeric_limits<double>::infinity();
  });
  return causes;
}

std::string causes_in_words(std::span<const Cause* const> causes) {
  std::vector<std::string> names;
  for (const Cause* cause : causes) {
    names.push_back(
        fmt::format("{} ({:.0f} % sure)", plain_name(cause->effect), 100.0 * cause->probability));
  }
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

std::string causes_in_words(const Diagnosis& diagnosis) {
  return causes_in_words(causes_by_cost(diagnosis));
}

std::string change_in_words(double before_deg, double after_deg) {
  const std::string before = in_figures(before_deg);
  const std::string after = in_figures(after_deg);
  return before == after ? before + " deg" : fmt::format("{} to {} deg", before, after);
}

std::string drift_in_words(const Diagnosis& diagnosis) {
  const Gain& gain = diagnosis.gain;
  if (!gain.has_drives()) return {};
  return fmt::format(
      "{} in {} s",
      change_in_words(gain.heading_drift_base_deg.value, gain.heading_drift_extended_deg.value),
      in_figures(gain.drive_s, 2));
}

std::string p_value_in_words(double p) {
  return p < 1e-6 ? "below 1e-6" : fmt::format("{:.2g}", p);
}

std::string plain_name(std::string_view effect) {
  std::string name(effect);
  std::ranges::replace(name, '_', ' ');
  return name;
}

std::string plain_statistic(std::string_view statistic) {
  if (statistic.starts_with("allan_deviation")) return "the Allan deviation";
  if (statistic.starts_with("density")) return "the noise density";
  constexpr std::string_view kUnit = "_dps";
  if (statistic.ends_with(kUnit)) statistic.remove_suffix(kUnit.size());
  return "the " + plain_name(statistic);
}

namespace {

struct NameOfUnit {
  std::string_view suffix;
  std::string_view unit;
};
/// Suffixes of names in JSON. A suffix that ends another one comes after it.
constexpr std::array kUnits{NameOfUnit{"_dps_per_sqrt_hz", "deg/s/sqrt(Hz)"},
                            NameOfUnit{"_dps_per_sqrt_s", "deg/s/sqrt(s)"},
                            NameOfUnit{"_dps_per_s", "deg/s^2"},
                            NameOfUnit{"_dps_per_k", "deg/s/K"},
                            NameOfUnit{"_dps_per_k2", "deg/s/K^2"},
                            NameOfUnit{"_dps_per_g", "deg/s/g"},
                            NameOfUnit{"_dps_per_g2", "deg/s/g^2"},
                            NameOfUnit{"_deg_per_k", "deg/K"},
                            NameOfUnit{"_dps", "deg/s"},
                            NameOfUnit{"_degc", "deg C"},
                            NameOfUnit{"_hz", "Hz"},
                            NameOfUnit{"_samples", "samples"},
                            NameOfUnit{"_percent", "%"},
                            NameOfUnit{"_deg", "deg"},
                            NameOfUnit{"_s", "s"}};

const NameOfUnit* find_unit(std::string_view name) {
  const auto at = std::ranges::find_if(
      kUnits, [&](const NameOfUnit& one) { return name.ends_with(one.suffix); });
  return at == kUnits.end() ? nullptr : &*at;
}

}  // namespace

std::string_view unit_of(std::string_view name) {
  const NameOfUnit* const found = find_unit(name);
  return found == nullptr ? "" : found->unit;
}

std::string plain_parameter(std::string_view name) {
  const NameOfUnit* const found = find_unit(name);
  if (found == nullptr) return plain_name(name);
  name.remove_suffix(found->suffix.size());
  return fmt::format("{}, {}", plain_name(name), found->unit);
}

std::string_view matter_in_words(std::optional<bool> is_material) {
  if (!is_material) return "not decided";
  return *is_material ? "it matters" : "no matter";
}

std::string verdict_in_words(const Diagnosis& diagnosis) {
  std::string text(name(diagnosis.verdict));
  if (diagnosis.verdict != Verdict::unexplained) return text;
  const std::optional<bool> is_material = diagnosis.is_material();
  if (!is_material) return text + ", and the recording does not show whether it matters";
  return text + (*is_material ? ", and it matters for the heading"
                              : ", but it does not matter for the heading");
}

std::string remainder_in_words(const Diagnosis& diagnosis) {
  if (!diagnosis.materiality) return {};
  std::vector<std::string> drives;
  for (const HeadingExcess& excess : diagnosis.materiality->by_drive) {
    drives.push_back(fmt::format("{:.2f} [{:.2f}, {:.2f}] times over {:.0f} s ({})",
                                 excess.ratio.value, excess.ratio.lo, excess.ratio.hi,
                                 excess.drive_s, matter_in_words(excess.is_material())));
  }
  return fmt::format("The heading error is {} that of simulations with the causes below. ",
                     fmt::join(drives, ", "));
}

std::string in_words(const Diagnosis& diagnosis) {
  const std::string_view base = diagnosis.is_base_given
                                    ? "The given model describes"
                                    : "White noise, 1/f noise and a constant describe";
  if (diagnosis.verdict == Verdict::consistent) {
    return fmt::format(
        "{} this recording: over {} samples every statistic lies where simulations of that model "
        "lie.",
        base, diagnosis.samples);
  }
  const Misfit* worst = worst_misfit(diagnosis);
  std::string text =
      worst == nullptr
          ? std::string(
                diagnosis.is_base_given
                    ? "The given model does not describe this recording."
                    : "White noise, 1/f noise and a constant do not describe this recording.")
          : misfit_sentence(*worst, diagnosis.is_base_given);
  text.insert(0, remainder_in_words(diagnosis));
  text += cause_sentences(diagnosis);
  if (diagnosis.verdict == Verdict::unexplained) text += what_is_left(diagnosis);
  if (!diagnosis.causes.empty()) text += model_sentences(diagnosis);
  return text;
}

std::string in_words(const odometry::HeadingGain& gain) {
  return fmt::format(
      "Learnt from every stop by the odometer, the bias leaves a heading error of {:.2f} deg rms "
      "over "
      "{} drives, {:.0f} % of them inside the 95 % interval; learnt from the calm in the stops, "
      "{:.2f} "
      "deg and {:.0f} %.",
      gain.every_stop_rms_rad * units::kDegPerRad, gain.drives, 100.0 * gain.every_stop_coverage95,
      gain.calm_rms_rad * units::kDegPerRad, 100.0 * gain.calm_coverage95);
}

}  // namespace zerorate::diagnose
