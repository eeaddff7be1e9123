/// @file
/// Diagnosis of one axis: the verdict, the causes, what they explain and what they buy.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {

using statistics::BootstrapFigure;

enum class Verdict {
  /// White + 1/f + constant does, or the model that was given, as far as this recording can show.
  consistent,
  explained,    ///< the causes are needed, and with them nothing is left
  unexplained,  ///< with the best extension something is still wrong: no cause is proven
};

[[nodiscard]] std::string_view name(Verdict verdict);

/// A physical figure of an effect with its 95 % interval, in the unit that ends its name, such as
/// "coefficient_dps_per_sqrt_s".
struct Parameter {
  std::string name;
  double value = 0.0;
  double lo = 0.0;
  double hi = 0.0;
};

/// Another effect that explains the recording nearly as well.
struct Alternative {
  std::string effect;
  double less_likely_by_nats = 0.0;
};

/// An effect, or chance, that may stand in a cause's place.
struct Explanation {
  std::string effect;  ///< kByChance: nothing is there
  double probability = 0.0;
};
inline constexpr std::string_view kByChance = "chance";

/// Weighs explanations of the same: e^(-nats behind) each, and chance by the bound on its Bayes
/// factor, -e p log p (Sellke, Bayarri and Berger 2001), of which every record has as many places
/// as a catalogue has effects.
/// @param rivals  of the best one, whose surprisal is given; most probable first
/// @return shares that sum to 1, most probable first
[[nodiscard]] std::vector<Explanation> weigh(std::string_view best, double surprisal_nats,
                                             std::span<const Alternative> rivals);

/// The most probable explanations, until they hold 95 %.
/// @param explanations most probable first
[[nodiscard]] std::vector<Explanation> set95_of(const std::vector<Explanation>& explanations);

/// Probability from which on a name stands alone; below it the answer is "one of".
inline constexpr double kStandsAlone = 0.8;

struct Cause {
  std::string effect;      ///< name in the catalogue, e.g. "rate_random_walk"
  double gain_nats = 0.0;  ///< log likelihood that is lost without it
  double p_value = 1.0;    ///< probability of so large a gain by chance, the search included
  std::size_t axes = 1;    ///< axes that have it in common; gain and p hold for all of them
  std::vector<Parameter> parameters;
  std::vector<Alternative> alternatives;  ///< within kAlternativeNats, best first
  /// Probability that the effect is among the causes, if the catalogue holds them all.
  double probability = 1.0;
  /// Smallest set that holds the cause with 95 %, most probable first.
  std::vector<Explanation> set95;
  std::string sentence;  ///< for a firmware engineer, e.g. "A random walk of ... explains it."
  bool in_model = true;  ///< the extended model has it
  std::string left_out_because;  ///< reason where it has not
  /// Heading drift of the node with its extension over that without, on data held out. Below 1 the
  /// extension pays. Nothing where the node cannot follow the cause.
  std::optional<BootstrapFigure> heading_drift_ratio{};

  [[nodiscard]] bool stands_alone() const { return probability >= kStandsAlone; }
};

inline constexpr double kAlternativeNats = 3.0;
inline constexpr std::size_t kMostCauses = 3;  ///< causes reported at most

/// A statistic of the recording beside its range in simulations of the base model.
struct Misfit {
  std::string statistic;  ///< "allan_deviation_dps", "density_dps_per_sqrt_hz", ...
  std::string where;      ///< "tau 200 s", ".5 Hz to 1 Hz"; empty where the whole is meant
  double measured = 0.0;
  double simulated_lo = 0.0;  ///< 95 % of simulations, all rows of the statistic together
  double simulated_hi = 0.0;

  [[nodiscard]] bool is_outside() const {
    return !(measured >= simulated_lo && measured <= simulated_hi);
  }
};

/// Whether a model is enough, by a family of tests whose error is controlled as a whole.
struct Adequacy {
  bool holds = true;
  double p_value = 1.0;               ///< p-value of the whole family
  std::vector<std::string> failures;  ///< tests that fail, the worst first, in words
};

/// Base against extended model, both run by the node's filter on data that neither was fitted to.
/// Ratios are extended over base: below 1 is better. A figure without drives or samples is NaN.
struct Gain {
  std::size_t holdout_samples = 0;
  BootstrapFigure rsse_ratio;
  BootstrapFigure ie_ratio;
  BootstrapFigure heading_drift_ratio;
  BootstrapFigure heading_drift_base_deg;  ///< rms over one drive
  BootstrapFigure heading_drift_extended_deg;
  double drive_s = 0.0;             ///< length of the drives that the heading drifts over
  BootstrapFigure coverage95_base;  ///< share of headings inside the node's 95 % interval
  BootstrapFigure coverage95_extended;
  BootstrapFigure log_score_gain_nats_per_sample;

  [[nodiscard]] bool is_measured() const { return holdout_samples > 0; }
  [[nodiscard]] bool has_drives() const { return std::isfinite(heading_drift_ratio.value); }
};

/// Heading error over drives of one length: of the recording, over that of simulations of the
/// extended hypothesis through the same node.
struct HeadingExcess {
  double drive_s = 0.0;
  std::size_t drives = 0;  ///< in the recording
  BootstrapFigure ratio;   ///< 1: what is left does not show in the heading

  /// True where the interval lies above 1 and the ratio is more than kLeastExcess, false where the
  /// interval lies below kMostExcess; nothing where it is too wide for either.
  [[nodiscard]] std::optional<bool> is_material() const {
    if (ratio.lo > 1.0 && ratio.value > kLeastExcess) return true;
    if (ratio.hi < kMostExcess) return false;
    return std::nullopt;
  }

  static constexpr double kLeastExcess = 1.05;  ///< smallest ratio that may matter
  static constexpr double kMostExcess = 1.25;   ///< largest ratio that does not matter
};

/// Whether what is left unexplained matters for the heading.
struct Materiality {
  std::vector<HeadingExcess> by_drive;  ///< at least one

  /// True where it matters over drives of some length, false where it matters over none; nothing
  /// where the recording does not decide.
  [[nodiscard]] std::optional<bool> is_material() const {
    bool is_known = true;
    for (const HeadingExcess& excess : by_drive) {
      const std::optional<bool> one = excess.is_material();
      if (one && *one) return true;
      is_known = is_known && one;
    }
    return is_known ? std::optional{false} : std::nullopt;
  }
};

/// One abscissa of a curve: measured, and the middle and the 95 % band of simulations.
struct CurvePoint {
  double x = 0.0;  ///< tau in s, or frequency in Hz
  double measured = 0.0;
  double base_lo = 0.0;
  double base = 0.0;
  double base_hi = 0.0;
  double extended_lo = 0.0;
  double extended = 0.0;
  double extended_hi = 0.0;
};

/// Gain of each effect of the catalogue when it alone is added to the base.
struct SelectionEvidence {
  std::string effect;
  double gain_nats = 0.0;
  double price_nats = 0.0;  ///< least gain that counts: the price of parameters and search
  bool selected = false;
  std::string not_examined;  ///< why it could not be, e.g. "no temperature"; empty otherwise
};

/// Adds evidence of another scale. An effect of either pace may be on both: the stronger stays.
void add_stronger(std::vector<SelectionEvidence> more, std::vector<SelectionEvidence>& all);

struct Point {
  double time_s = 0.0;
  double rate_rad_s = 0.0;
};

/// Overlay of an effect on the time series: a curve and marked samples.
struct Drawing {
  std::string effect;
  std::vector<Point> curve;  ///< the mean function, the constant bias included; may be empty
  std::vector<Point> marks;  ///< samples that the effect has touched; may be empty
};

/// Result for one axis.
struct Diagnosis {
  /// True where what is left unexplained matters for the heading; nothing where that is not known.
  [[nodiscard]] std::optional<bool> is_material() const {
    if (verdict != Verdict::unexplained) return false;
    if (!materiality) return std::nullopt;
    return materiality->is_material();
  }

  std::string axis;  ///< "x", "y", "z"; "rate" in a recording of one axis
  std::size_t samples = 0;
  double sample_period_s = 0.0;
  Verdict verdict = Verdict::consistent;
  /// Set where something is left unexplained and some drives fit into the recording; nothing is
  /// known of it where they do not.
  std::optional<Materiality> materiality;
  bool is_base_given = false;  ///< the base model is not the best fit of white and 1/f noise
  /// Strongest first; noise that wanders after functions of time or temperature.
  std::vector<Cause> causes;
  std::vector<Misfit> misfit;
  Adequacy base_adequacy;
  Adequacy extended_adequacy;
  Gain gain;                  ///< gain over the base model
  Gain gain_over_data_sheet;  ///< gain over white and 1/f noise, or over the model that was given
  /// White and flicker noise as `zerorate characterize` writes them, or the model that was given.
  model::SensorModel base_model;
  /// The base with the extensions that pay. Where a model was given that describes the recording,
  /// that one.
  model::SensorModel extended_model;
  std::vector<SelectionEvidence> evidence;  ///< strongest first
  std::vector<CurvePoint> allan;            ///< rad/s
  std::vector<CurvePoint> density;          ///< one-sided, (rad/s)^2/Hz
  std::vector<Drawing> drawings;            ///< one a cause that can be drawn
  std::vector<Point> thinned;               ///< the recording, thinned for drawing
  std::vector<std::string> remarks;         ///< limits of these figures, for the user
};

}  // namespace zerorate::diagnose
