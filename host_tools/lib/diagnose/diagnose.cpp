#include "host_tools/lib/diagnose/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"
#include "host_tools/lib/diagnose/effects/effects.hpp"
#include "host_tools/lib/diagnose/even_series.hpp"
#include "host_tools/lib/diagnose/models.hpp"
#include "host_tools/lib/diagnose/selection.hpp"

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
  for (const auto make : kEffects) effects.push_back(make());
  return effects;
}

std::vector<Cause> causes_of(const Selection& selection) {
  std::vector<Cause> causes;
  for (std::size_t i = 0; i < selection.choices.size(); ++i) {
    const Choice& choice = selection.choices[i];
    Account account = choice.effect->tell({selection.explanation, i});
    causes.push_back({.effect = std::string(choice.effect->name()),
                      .gain_nats = choice.gain_nats,
                      .p_value = std::exp(-choice.surprise_nats),
                      .parameters = std::move(account.parameters),
                      .alternatives = choice.alternatives,
                      .sentence = std::move(account.sentence)});
  }
  std::ranges::stable_sort(causes, std::greater{}, &Cause::gain_nats);
  return causes;
}

std::vector<Drawing> drawings_of(const Selection& selection) {
  std::vector<Drawing> drawings;
  for (std::size_t i = 0; i < selection.choices.size(); ++i) {
    Drawing drawing = selection.choices[i].effect->tell({selection.explanation, i}).drawing;
    if (!drawing.curve.empty() || !drawing.marks.empty()) drawings.push_back(std::move(drawing));
  }
  return drawings;
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

}  // namespace

Diagnosis diagnose(const Record& record, const DiagnoseOptions& options) {
  require_usable(record);
  const EvenSeries series = even_series_of(record);
  const Problem problem(series, options.seed);
  const std::vector<std::unique_ptr<Effect>> effects = make_effects();
  const Selection selection = select_effects(problem, effects);

  const std::string source = options.recording + ", axis " + record.axis;
  Diagnosis diagnosis{.axis = record.axis,
                      .samples = record.size(),
                      .sample_period_s = record.sample_period_s,
                      .causes = causes_of(selection),
                      .base_model = model_of(selection.base, {}, source),
                      .extended_model = model_of(selection.explanation, selection.choices, source),
                      .evidence = selection.evidence,
                      .drawings = drawings_of(selection),
                      .thinned = thinned(series)};
  diagnosis.base_adequacy = examine_adequacy(selection.base);
  diagnosis.extended_adequacy = examine_adequacy(selection.explanation);
  diagnosis.verdict = !diagnosis.extended_adequacy.holds ? Verdict::unexplained
                      : diagnosis.causes.empty()         ? Verdict::consistent
                                                         : Verdict::explained;
  return diagnosis;
}

}  // namespace zerorate::diagnose
