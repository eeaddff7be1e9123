#include "host_tools/lib/diagnose/selection/causes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

namespace zerorate::diagnose {
namespace {

/// The parts by their gain. Noise that wanders takes in whatever functions of time and temperature
/// leave, so that beside one of them its gain is no rank: it comes after them. What was measured
/// beside the rate and is beyond doubt comes first.
std::vector<std::size_t> by_rank(const std::vector<Choice>& choices, const Hypothesis& hypothesis) {
  const std::vector<Part>& parts = hypothesis.parts();
  const auto is_slow_noise = [&](std::size_t i) { return parts[i].terms.has_slow_noise(); };
  double least_function = std::numeric_limits<double>::infinity();
  std::vector<std::size_t> ranking;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    ranking.push_back(i);
    if (!parts[i].columns.empty()) {
      least_function = std::min(least_function, choices[i].gain_nats);
    }
  }
  std::ranges::stable_sort(ranking, std::greater{}, [&](std::size_t i) {
    const double gain = choices[i].gain_nats;
    return std::tuple{is_beyond_doubt(*choices[i].effect, choices[i].surprisal_nats),
                      is_slow_noise(i) ? std::min(gain, least_function) : gain, !is_slow_noise(i)};
  });
  return ranking;
}

double probability_of(const Choice& choice) {
  const auto own =
      std::ranges::find(choice.explanations, choice.effect->name(), &Explanation::effect);
  return own == choice.explanations.end() ? 1.0 : own->probability;
}

Cause cause_of(const Choice& choice, Description description) {
  return {.effect = std::string(choice.effect->name()),
          .gain_nats = choice.gain_nats,
          .p_value = std::exp(-choice.surprisal_nats),
          .axes = choice.axes,
          .parameters = std::move(description.parameters),
          .alternatives = choice.alternatives,
          .probability = probability_of(choice),
          .set95 = set95_of(choice.explanations),
          .sentence = std::move(description.sentence),
          .in_model = choice.in_model,
          .left_out_because = choice.left_out_because,
          .heading_drift_ratio = choice.heading_drift_ratio};
}

}  // namespace

DescribedCauses describe_causes(const std::vector<Choice>& choices, const Hypothesis& hypothesis) {
  DescribedCauses described;
  std::vector<Cause> causes;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    Description description = choices[i].effect->describe({hypothesis, i});
    Drawing& drawing = description.drawing;
    if (!drawing.curve.empty() || !drawing.marks.empty()) {
      described.drawings.push_back(std::move(drawing));
    }
    causes.push_back(cause_of(choices[i], std::move(description)));
  }
  for (const std::size_t i : by_rank(choices, hypothesis)) {
    described.causes.push_back(std::move(causes[i]));
  }
  return described;
}

}  // namespace zerorate::diagnose
