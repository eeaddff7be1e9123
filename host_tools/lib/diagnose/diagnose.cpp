#include "host_tools/lib/diagnose/diagnose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"
#include "host_tools/lib/diagnose/envelope.hpp"
#include "host_tools/lib/diagnose/forecast_gain/gain.hpp"
#include "host_tools/lib/diagnose/record/even_series.hpp"
#include "host_tools/lib/diagnose/selection/common_order.hpp"
#include "host_tools/lib/diagnose/selection/given_model.hpp"
#include "host_tools/lib/diagnose/selection/model_export.hpp"
#include "host_tools/lib/diagnose/selection/selection.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kFewestSamples = 256;
constexpr std::size_t kDrawnPoints = 3000;

void require_usable(const Record& record) {
  if (record.size() < kFewestSamples) {
    throw std::invalid_argument("a diagnosis needs at least 256 samples at rest");
  }
  const auto [least, most] = std::ranges::minmax(record.rate_rad_s);
  if (!std::ranges::all_of(record.rate_rad_s, [](double rate) { return std::isfinite(rate); }) ||
      !(least < most)) {
    throw std::invalid_argument("the record is constant or not finite");
  }
}

std::vector<std::unique_ptr<Effect>> make_effects() {
  std::vector<std::unique_ptr<Effect>> effects;
  effects.reserve(kEffects.size());
  for (const auto make : kEffects) effects.push_back(make());
  return effects;
}

/// The parts by their gain. Noise that wanders takes in whatever functions of time and temperature
/// leave, so that beside one of them its gain is no rank: it comes after them. What was measured
/// beside the rate and is beyond doubt comes first.
std::vector<std::size_t> by_rank(const std::vector<Choice>& choices,
                                 const Explanation& explanation) {
  const std::vector<Part>& parts = explanation.parts();
  const auto wanders = [&](std::size_t i) { return parts[i].terms.wanders(); };
  double least_function = std::numeric_limits<double>::infinity();
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    order.push_back(i);
    if (!parts[i].columns.empty()) {
      least_function = std::min(least_function, choices[i].gain_nats);
    }
  }
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) {
    const double gain = choices[i].gain_nats;
    return std::tuple{is_beyond_doubt(*choices[i].effect, choices[i].surprise_nats),
                      wanders(i) ? std::min(gain, least_function) : gain, !wanders(i)};
  });
  return order;
}

std::vector<Cause> causes_of(const std::vector<Choice>& choices, const Explanation& explanation) {
  std::vector<Cause> causes;
  causes.reserve(choices.size());
  for (const std::size_t i : by_rank(choices, explanation)) {
    const Choice& choice = choices[i];
    Account account = choice.effect->tell({explanation, i});
    causes.push_back({.effect = std::string(choice.effect->name()),
                      .gain_nats = choice.gain_nats,
                      .p_value = std::exp(-choice.surprise_nats),
                      .axes = choice.axes,
                      .parameters = std::move(account.parameters),
                      .alternatives = choice.alternatives,
                      .sentence = std::move(account.sentence)});
  }
  return causes;
}

std::vector<Drawing> drawings_of(const std::vector<Choice>& choices,
                                 const Explanation& explanation) {
  std::vector<Drawing> drawings;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    Drawing drawing = choices[i].effect->tell({explanation, i}).drawing;
    if (!drawing.curve.empty() || !drawing.marks.empty()) drawings.push_back(std::move(drawing));
  }
  return drawings;
}

/// The first samples of the record.
Record beginning_of(const Record& record, std::size_t size) {
  const auto first = [&](const std::vector<double>& values) {
    const auto count = static_cast<std::ptrdiff_t>(std::min(size, values.size()));
    return std::vector<double>(values.begin(), values.begin() + count);
  };
  return {.axis = record.axis,
          .sample_period_s = record.sample_period_s,
          .mean_period_s = record.mean_period_s,
          .time_s = first(record.time_s),
          .rate_rad_s = first(record.rate_rad_s),
          .temperature_degc = first(record.temperature_degc),
          .standstills = record.standstills};
}

/// What a choice becomes beside others, fitted anew.
std::optional<Part> part_of(const Choice& choice, const std::optional<OrderProfile>& others,
                            const Explanation& without) {
  if (choice.axes > 1) {
    OrderProfile all = OrderProfile(without);
    return part_of_order((all += *others).peak());
  }
  std::optional<Offer> offer = choice.effect->examine(without);
  if (!offer) return std::nullopt;
  return std::move(offer->part);
}

/// The same effects as the whole record needed, fitted to its first part and judged on the rest.
/// @param others  what the other axes say of an order that is in common
Gain gain_of(const Record& record, const std::vector<Choice>& wanted,
             const std::optional<OrderProfile>& others, const DiagnoseOptions& options) {
  const double share = 1.0 - options.holdout;
  const Record first =
      beginning_of(record, static_cast<std::size_t>(share * static_cast<double>(record.size())));
  if (options.holdout <= 0.0 || first.size() < kFewestSamples) return {};
  const EvenSeries series = even_series_of(first);
  const Problem problem(series, options.seed);
  const Explanation base(problem, {});
  Explanation extended = base;
  std::vector<Choice> choices;
  for (const Choice& choice : wanted) {
    std::optional<Part> part = part_of(choice, others, extended);
    if (!part) continue;
    std::vector<Part> parts = extended.parts();
    parts.push_back(std::move(*part));
    choices.push_back(choice);
    extended = Explanation(problem, std::move(parts), &extended);
  }
  const model::SensorModel base_model =
      options.base_model.value_or(model_of(base, {}, options.recording));
  return measure_gain(record, base_model, model_of(extended, choices, options.recording),
                      options.holdout, options.seed);
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

/// An axis, what was selected for it, and what the others say.
struct Axis {
  Record record;
  Selection selection;
  std::optional<OrderProfile> others;  ///< of the order, if it is in common
};

Diagnosis diagnosis_of(const Axis& axis, const DiagnoseOptions& options) {
  const Record& record = axis.record;
  const EvenSeries series = even_series_of(record);
  const Problem problem(series, options.seed);
  const Explanation fitted_base(problem, {});
  const Explanation base =
      options.base_model ? hypothesis_of(problem, *options.base_model) : fitted_base;
  Explanation explanation(problem, axis.selection.parts, &fitted_base);
  std::vector<Choice> choices = axis.selection.choices;
  const std::string source = options.recording + ", axis " + record.axis;
  Diagnosis diagnosis{.axis = record.axis,
                      .samples = record.size(),
                      .sample_period_s = record.sample_period_s,
                      .is_base_given = options.base_model.has_value(),
                      .base_adequacy = examine_adequacy(base),
                      .base_model = options.base_model.value_or(model_of(fitted_base, {}, source)),
                      .evidence = axis.selection.evidence,
                      .thinned = thinned(series)};

  if (options.base_model && diagnosis.base_adequacy.holds &&
      is_enough(base, *options.base_model, explanation)) {
    explanation = base;
    choices.clear();
    diagnosis.evidence.clear();
    diagnosis.extended_model = diagnosis.base_model;
  } else {
    diagnosis.extended_model = model_of(explanation, choices, source);
  }
  diagnosis.causes = causes_of(choices, explanation);
  diagnosis.extended_adequacy = examine_adequacy(explanation);
  diagnosis.drawings = drawings_of(choices, explanation);
  diagnosis.verdict = verdict_of(diagnosis);
  Envelopes envelopes = simulate_envelopes(base, explanation);
  diagnosis.allan = std::move(envelopes.allan);
  diagnosis.density = std::move(envelopes.density);
  diagnosis.misfit = std::move(envelopes.misfit);
  diagnosis.remarks = remarks_on(diagnosis, record, series);
  try {
    if (!choices.empty() || !options.base_model) {
      diagnosis.gain = gain_of(record, choices, axis.others, options);
    }
  } catch (const std::invalid_argument& reason) {
    diagnosis.remarks.push_back(std::string("No gain is claimed: ") + reason.what() + ".");
  }
  return diagnosis;
}

/// The chain for all axes; what is as long as the record is in memory for one of them at a time.
class Chain {
 public:
  Chain(std::vector<Record> records, const DiagnoseOptions& options) : options_(options) {
    for (Record& record : records) {
      require_usable(record);
      axes_.push_back({.record = std::move(record)});
    }
  }

  std::vector<Diagnosis> run() {
    for (Axis& axis : axes_) select(axis);
    agree_on_order();
    std::vector<Diagnosis> diagnoses;
    for (const Axis& axis : axes_) {
      diagnoses.push_back(diagnosis_of(axis, options_));
      report_progress();
    }
    return diagnoses;
  }

 private:
  void select(Axis& axis) {
    const EvenSeries series = even_series_of(axis.record);
    const Problem problem(series, options_.seed);
    axis.selection = select_effects(problem, effects_);
    if (axes_.size() > 1) slow_noises_.push_back(slow_noise_of(problem, axis.selection));
    report_progress();
  }

  void agree_on_order() {
    const std::optional<CommonOrder> common = common_order_of(slow_noises_);
    if (!common) return;
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      place(*common, effects_, axes_.size(), slow_noises_[i], axes_[i].selection);
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
  std::vector<std::string> remarks;
  for (Record& record : axes) {
    const std::size_t size = record.size();
    remarks.emplace_back();
    if (size <= options.most_samples) continue;
    record = beginning_of(record, options.most_samples);
    remarks.back() = fmt::format(
        "Of the {} samples the first {}, {:.0f} s, were diagnosed, so that memory stays "
        "bounded.",
        size, record.size(), record.time_s.back() - record.time_s.front());
  }
  std::vector<Diagnosis> diagnoses = Chain(std::move(axes), options).run();
  for (std::size_t i = 0; i < diagnoses.size(); ++i) {
    if (remarks[i].empty()) continue;
    diagnoses[i].remarks.insert(diagnoses[i].remarks.begin(), remarks[i]);
  }
  return diagnoses;
}

Diagnosis diagnose(Record record, const DiagnoseOptions& options) {
  std::vector<Record> axes;
  axes.push_back(std::move(record));
  return std::move(diagnose(std::move(axes), options).front());
}

}  // namespace zerorate::diagnose
