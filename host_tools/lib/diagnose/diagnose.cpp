#include "host_tools/lib/diagnose/diagnose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"
#include "host_tools/lib/diagnose/doubted_causes.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/envelope.hpp"
#include "host_tools/lib/diagnose/extension_choice.hpp"
#include "host_tools/lib/diagnose/forecast_gain/scores.hpp"
#include "host_tools/lib/diagnose/hypothesis/fit_data.hpp"
#include "host_tools/lib/diagnose/inputs/input_effects.hpp"
#include "host_tools/lib/diagnose/materiality.hpp"
#include "host_tools/lib/diagnose/record/even_series.hpp"
#include "host_tools/lib/diagnose/selection/causes.hpp"
#include "host_tools/lib/diagnose/selection/common_order.hpp"
#include "host_tools/lib/diagnose/selection/model_export.hpp"
#include "host_tools/lib/diagnose/selection/node_models.hpp"
#include "host_tools/lib/diagnose/selection/selection.hpp"
#include "host_tools/lib/diagnose/truncation_cause.hpp"
#include "host_tools/lib/parallel/parallel.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

constexpr std::size_t kDrawnPoints = 3000;

void require_usable(const Record& record) {
  if (record.size() < kFewestSamples) {
    throw recording::DataError("a diagnosis needs at least 256 samples at rest");
  }
  const auto [least, most] = std::ranges::minmax(record.rate_rad_s);
  if (!std::ranges::all_of(record.rate_rad_s, [](double rate) { return std::isfinite(rate); }) ||
      !(least < most)) {
    throw recording::DataError("the record is constant or not finite");
  }
}

/// The commonest value may be nearly every value: then the resolution of the sensor hides its
/// noise, and a fit has no density to hold on to.
void require_noise(const EvenSeries& series) {
  constexpr std::size_t kFewestOthers = 20;  // one sample in so many: a step of four sigma
  std::vector<double> values;
  for (std::size_t k = 0; k < series.size(); ++k) {
    if (!series.lost[k]) values.push_back(series.rate_rad_s[k]);
  }
  if (!values.empty()) {
    const double middle = statistics::median_of(values);
    const auto equal = static_cast<std::size_t>(std::ranges::count(values, middle));
    if (kFewestOthers * (values.size() - equal) >= values.size()) return;
  }
  throw recording::DataError(
      "nearly all samples of the standstill are equal: the resolution of the sensor hides its "
      "noise");
}

std::vector<std::unique_ptr<Effect>> make_effects() {
  std::vector<std::unique_ptr<Effect>> effects;
  effects.reserve(kEffects.size());
  for (const auto make : kEffects) effects.push_back(make());
  return effects;
}

/// The extremes of equal stretches, so that no peak is lost.
std::vector<Point> thinned(const EvenSeries& series) {
  const std::size_t step = std::max<std::size_t>(1, 2 * series.size() / kDrawnPoints);
  std::vector<Point> points;
  for (std::size_t first = 0; first < series.size(); first += step) {
    const std::size_t end = std::min(first + step, series.size());
    std::size_t least = first;
    std::size_t most = first;
    for (std::size_t k = first; k < end; ++k) {
      if (series.rate_rad_s[k] < series.rate_rad_s[least]) least = k;
      if (series.rate_rad_s[k] > series.rate_rad_s[most]) most = k;
    }
    points.push_back(
        {series.time_s(std::min(least, most)), series.rate_rad_s[std::min(least, most)]});
    if (least == most) continue;
    points.push_back(
        {series.time_s(std::max(least, most)), series.rate_rad_s[std::max(least, most)]});
  }
  return points;
}

/// Nothing is left, but the model that was given is not what does it: unexplained as well.
Verdict verdict_of(const Diagnosis& diagnosis) {
  if (!diagnosis.extended_adequacy.holds) return Verdict::unexplained;
  if (!diagnosis.causes.empty()) return Verdict::explained;
  return diagnosis.base_adequacy.holds ? Verdict::consistent : Verdict::unexplained;
}

std::vector<std::string> remarks_on(const Diagnosis& diagnosis, const Record& record,
                                    const EvenSeries& series) {
  std::vector<std::string> remarks;
  if (diagnosis.is_base_given && diagnosis.causes.empty() && diagnosis.extended_adequacy.holds &&
      !diagnosis.base_adequacy.holds) {
    remarks.push_back(fmt::format(
        "White and 1/f noise of other strengths describe the recording: an angle random walk of "
        "{:.3g} deg/s/sqrt(Hz), where the given model has {:.3g}.",
        diagnosis.extended_model.white.angle_random_walk_rad_per_sqrt_s * kDegPerRad,
        diagnosis.base_model.white.angle_random_walk_rad_per_sqrt_s * kDegPerRad));
  }
  if (record.standstills > 1) {
    remarks.push_back(fmt::format(
        "Of the {} standstills of the recording the longest, of {:.0f} s, was diagnosed.",
        record.standstills, record.time_s.back() - record.time_s.front()));
  }
  if (series.start_off_rad_s != 0.0) {
    remarks.push_back(
        fmt::format("The first sample, {:.3g} deg/s off those that follow, was left out.",
                    series.start_off_rad_s * kDegPerRad));
  }
  if (series.is_ticks) {
    remarks.emplace_back(
        "The samples come too unevenly for tests of single values; means over ticks were tested.");
  }
  return remarks;
}

/// An axis, the selection for it, and the profile of the others.
struct Axis {
  Record record;
  Selection selection{};               ///< slow effects alone, where means show them
  std::optional<OrderProfile> others;  ///< order over the other axes
  InputFindings inputs{};              ///< effects over all standstills
};

/// Extensions that pay, by the data held out. Nothing where the node cannot run the base.
/// @param remarks  is told the reason then
std::optional<ExtensionChoice> extensions_that_pay(const Axis& axis,
                                                   const std::vector<Choice>& choices,
                                                   const DiagnoseOptions& options,
                                                   std::vector<std::string>& remarks) {
  try {
    return choose_extensions(axis.record, choices, axis.others,
                             {.recording = options.recording,
                              .base_model = options.base_model,
                              .share = options.holdout,
                              .seed = options.seed});
  } catch (const ModelCannotRun& reason) {
    remarks.push_back(std::string("No gain is claimed: ") + reason.what() + ".");
    return std::nullopt;
  }
}

/// Says of each choice whether it is an extension of the model, and what all are worth.
void adopt(ExtensionChoice chosen, std::vector<Choice>& choices, Diagnosis& diagnosis) {
  for (std::size_t i = 0; i < choices.size(); ++i) {
    choices[i].in_model = chosen.is_in[i];
    choices[i].left_out_because = std::move(chosen.reasons[i]);
    choices[i].heading_drift_ratio = chosen.drift_ratios[i];
  }
  diagnosis.gain = chosen.gain;
  diagnosis.gain_over_data_sheet = chosen.gain_over_data_sheet;
}

/// Adds what was found over all standstills. It was measured beside the rate and comes first.
void add_inputs(const InputFindings& inputs, std::optional<std::size_t> axis,
                Diagnosis& diagnosis) {
  diagnosis.causes.insert(diagnosis.causes.begin(), inputs.causes.begin(), inputs.causes.end());
  add_inputs_to_model(inputs, axis, diagnosis.extended_model);
  add_stronger(inputs.evidence, diagnosis.evidence);
  diagnosis.remarks.insert(diagnosis.remarks.end(), inputs.remarks.begin(), inputs.remarks.end());
}

/// The effects of one pace, of values that are judged by means of so many.
Scope scope_of(Pace pace, const EvenSeries& series, std::size_t values) {
  constexpr double kMeans = 4.0;  // means that a slow effect lasts for
  return {.pace = pace, .slow_from_s = kMeans * static_cast<double>(values) * series.period_s};
}

Diagnosis diagnosis_of(const Axis& axis, const PreparedAxis& prepared, const Selection& selection,
                       const DiagnoseOptions& options) {
  const Record& record = axis.record;
  const EvenSeries& series = prepared.series();
  const FitData& data = prepared.data();
  const Hypothesis fitted_base(data, {});
  Hypothesis hypothesis =
      selection.parts.empty() ? fitted_base : Hypothesis(data, selection.parts, &fitted_base);
  const Hypothesis base = options.base_model ? hypothesis_of(data, *options.base_model)
                                             : base_beside_fast_effects(fitted_base, hypothesis);
  std::vector<Choice> choices = selection.choices;
  Diagnosis diagnosis{.axis = record.axis,
                      .samples = record.size(),
                      .sample_period_s = record.sample_period_s,
                      .is_base_given = options.base_model.has_value(),
                      .evidence = selection.evidence,
                      .thinned = thinned(series)};
  bool is_given_enough = false;
  if (options.base_model) {
    diagnosis.base_adequacy = examine_adequacy(base);
    is_given_enough =
        diagnosis.base_adequacy.holds && is_enough(base, *options.base_model, hypothesis);
  }
  if (is_given_enough) {
    hypothesis = base;
    choices.clear();
    diagnosis.evidence.clear();
  }
  const bool is_base_alone = is_given_enough || (selection.parts.empty() && !options.base_model);
  std::optional<NodeModels> models;
  std::optional<ExtensionChoice> chosen;
  Envelopes envelopes;
  parallel::together(
      {[&] {
         if (is_given_enough) return;
         chosen = extensions_that_pay(axis, choices, options, diagnosis.remarks);
       },
       [&] {
         if (is_given_enough) return;
         models.emplace(record, hypothesis, choices, options.recording);
       },
       [&] {
         if (!options.base_model) diagnosis.base_adequacy = examine_adequacy(fitted_base);
       },
       [&] {
         if (!is_base_alone) diagnosis.extended_adequacy = examine_adequacy(hypothesis);
       },
       [&] { envelopes = simulate_envelopes(base, is_base_alone ? base : hypothesis); }});
  if (is_base_alone) diagnosis.extended_adequacy = diagnosis.base_adequacy;
  diagnosis.base_model = options.base_model ? *options.base_model : models->base();
  diagnosis.extended_model = diagnosis.base_model;
  if (models) {
    diagnosis.extended_model = chosen ? models->with(chosen->is_in) : models->base();
  }
  if (chosen) adopt(std::move(*chosen), choices, diagnosis);
  if (record.is_bias_taken_out) {
    doubt_causes_after_correction(choices, hypothesis, diagnosis.extended_adequacy);
  }
  DescribedCauses described = describe_causes(choices, hypothesis);
  diagnosis.causes = std::move(described.causes);
  diagnosis.drawings = std::move(described.drawings);
  const bool is_single = record.axis == "rate";
  add_inputs(axis.inputs, is_single ? std::nullopt : std::optional{record.index}, diagnosis);
  add_truncation(record.truncation, diagnosis);
  if (!is_given_enough) {
    doubt_many_slow_causes(choices, hypothesis, diagnosis.extended_adequacy);
  }
  diagnosis.verdict = verdict_of(diagnosis);
  if (diagnosis.verdict == Verdict::unexplained) {
    diagnosis.materiality = weigh_remainder(hypothesis, diagnosis.extended_model);
  }
  diagnosis.allan = std::move(envelopes.allan);
  diagnosis.density = std::move(envelopes.density);
  diagnosis.misfit = std::move(envelopes.misfit);
  for (std::string& remark : remarks_on(diagnosis, record, series)) {
    diagnosis.remarks.push_back(std::move(remark));
  }
  return diagnosis;
}

/// The chain for all axes; what is as long as the record is in memory for one of them at a time.
class DiagnosisRun {
 public:
  DiagnosisRun(std::vector<Record> records, const DiagnoseOptions& options) : options_(options) {
    std::optional<recording::DataError> first_obstacle;
    for (Record& record : records) {
      try {
        require_usable(record);
        require_noise(even_series_of(record));
        axes_.push_back({.record = std::move(record)});
      } catch (const recording::DataError& obstacle) {
        if (!options.on_left_out) throw;
        if (!first_obstacle) first_obstacle = obstacle;
        options.on_left_out(record.axis, obstacle.what());
      }
    }
    if (axes_.empty() && first_obstacle) throw recording::DataError(*first_obstacle);
  }

  std::vector<Diagnosis> run() {
    for (Axis& axis : axes_) find_inputs(axis);
    for (Axis& axis : axes_) select(axis);
    agree_on_order();
    std::vector<Diagnosis> diagnoses;
    for (const Axis& axis : axes_) {
      const PreparedAxis prepared(axis.record, options_.seed);
      diagnoses.push_back(diagnosis_of(axis, prepared, selection_of(axis, prepared), options_));
      report_progress();
    }
    return diagnoses;
  }

 private:
  void find_inputs(Axis& axis) const {
    axis.inputs = find_input_effects(
        axis.record.inputs, axis.record.index,
        {.threshold_nats = kSelectionThreshold_nats, .holdout = options_.holdout});
    take_off_vibration(axis.inputs, axis.record);
  }

  void select(Axis& axis) {
    EvenSeries series = even_series_of(axis.record);
    const std::size_t values = values_a_slow_mean(series);
    Scope scope;
    if (values > 1) {
      scope = scope_of(Pace::slow, series, values);
      series = means_of(series, values);
    }
    const FitData data(series, options_.seed);
    axis.selection = select_effects(data, effects_, scope);
    if (axes_.size() > 1) slow_noises_.push_back(slow_noise_of(data, axis.selection));
    report_progress();
  }

  /// The selection for the axis, and beside it the fast effects where means have shown the slow.
  [[nodiscard]] Selection selection_of(const Axis& axis, const PreparedAxis& prepared) const {
    const std::size_t values = values_a_slow_mean(prepared.series());
    if (values == 1) return axis.selection;
    const PreparedAxis means(means_of(prepared.series(), values), options_.seed);
    return select_beside(prepared.data(), effects_, scope_of(Pace::fast, prepared.series(), values),
                         means.data(), axis.selection);
  }

  void agree_on_order() {
    const std::optional<CommonOrder> common = common_order_of(slow_noises_);
    if (!common) return;
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      replace_slow_noise(*common, effects_, axes_.size(), slow_noises_[i], axes_[i].selection);
      axes_[i].others = common->by_order;
      *axes_[i].others -= slow_noises_[i].by_order;
    }
  }

  void report_progress() {
    ++steps_done_;
    const auto steps = static_cast<double>(2 * axes_.size());
    if (options_.on_progress) options_.on_progress(static_cast<double>(steps_done_) / steps);
  }

  const DiagnoseOptions& options_;
  std::vector<std::unique_ptr<Effect>> effects_ = make_effects();
  std::vector<Axis> axes_;
  std::vector<SlowNoise> slow_noises_;
  std::size_t steps_done_ = 0;
};

}  // namespace

std::vector<Diagnosis> diagnose(std::vector<Record> axes, const DiagnoseOptions& options) {
  std::map<std::string, std::string> remarks;  // key: axis
  for (Record& record : axes) {
    const std::size_t size = record.size();
    if (size <= options.most_samples) continue;
    record = beginning_of(record, options.most_samples);
    remarks[record.axis] = fmt::format(
        "Of the {} samples the first {}, {:.0f} s, were diagnosed, so that memory stays "
        "bounded.",
        size, record.size(), record.time_s.back() - record.time_s.front());
  }
  std::vector<Diagnosis> diagnoses = DiagnosisRun(std::move(axes), options).run();
  for (Diagnosis& diagnosis : diagnoses) {
    const auto remark = remarks.find(diagnosis.axis);
    if (remark == remarks.end()) continue;
    diagnosis.remarks.insert(diagnosis.remarks.begin(), remark->second);
  }
  return diagnoses;
}

Diagnosis diagnose(Record record, const DiagnoseOptions& options) {
  std::vector<Record> axes;
  axes.push_back(std::move(record));
  return std::move(diagnose(std::move(axes), options).front());
}

}  // namespace zerorate::diagnose
