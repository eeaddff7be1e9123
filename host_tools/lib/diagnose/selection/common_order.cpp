#include "host_tools/lib/diagnose/selection/common_order.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::string_view kEffect = "fractional_order";

/// The choices that are kept, with all they are fitted to.
struct KeptParts {
  std::vector<bool> is_kept;
  double prices = 0.0;
  bool has_room = true;
  Hypothesis hypothesis;
};

template <typename IsKept>
KeptParts kept_parts(const FitData& data, const Selection& selection, const IsKept& is_kept) {
  std::vector<bool> kept;
  std::vector<Part> parts;
  std::vector<Choice> choices;
  double prices = 0.0;
  for (std::size_t i = 0; i < selection.choices.size(); ++i) {
    kept.push_back(is_kept(i));
    if (!kept.back()) continue;
    parts.push_back(selection.parts[i]);
    choices.push_back(selection.choices[i]);
    prices += selection.choices[i].price_nats();
  }
  const bool room = has_room(parts, choices);
  const Hypothesis base(data, {});
  return {std::move(kept), prices, room, Hypothesis(data, std::move(parts), &base)};
}

SlowNoise slow_noise_beside(const KeptParts& kept, double selected_nats) {
  const std::optional<Candidate> walk = make_rate_random_walk()->examine(kept.hypothesis);
  return {
      .selected_nats = selected_nats,
      .is_kept = kept.is_kept,
      .prices_of_kept = kept.prices,
      .by_order = OrderProfile(kept.hypothesis),
      .random_walk_nats = kept.hypothesis.log_likelihood() + walk.value().gain_nats - kept.prices};
}

/// True if the axes lose more to orders of their own than the chance of one in twenty.
bool is_refuted(std::span<const SlowNoise> axes, const OrderProfile::Peak& common) {
  constexpr double kChance = 0.05;
  double of_peaks = 0.0;
  for (const SlowNoise& axis : axes) of_peaks += axis.by_order.peak().log_likelihood;
  return statistics::log_chi_squared_tail(2.0 * (of_peaks - common.log_likelihood),
                                          static_cast<double>(axes.size() - 1)) < std::log(kChance);
}

/// Without one of them the axes would rather have the order of the base.
bool rests_on_one(std::span<const SlowNoise> axes, const CommonOrder& common) {
  return std::ranges::any_of(axes, [&](const SlowNoise& axis) {
    OrderProfile others = common.by_order;
    others -= axis.by_order;
    return others.at(common.peak.order) < others.at_base_order();
  });
}

}  // namespace

OrderProfile::OrderProfile(const Hypothesis& without_order) {
  // From the base to both sides, so that each fit starts beside its solution.
  const auto fit = [&](std::size_t i, const Hypothesis& before) {
    std::vector<Part> parts = without_order.parts();
    parts.push_back(part_of_order({.order = kLowest + kStep * static_cast<double>(i)}));
    return Hypothesis(without_order.data(), std::move(parts), &before);
  };
  Hypothesis latest = without_order;
  values_[kBase] = latest.log_likelihood();
  for (std::size_t i = kBase + 1; i < kOrders; ++i) {
    latest = fit(i, latest);
    values_[i] = latest.log_likelihood();
  }
  latest = without_order;
  for (std::size_t i = kBase; i-- > 0;) {
    latest = fit(i, latest);
    values_[i] = latest.log_likelihood();
  }
}

OrderProfile& OrderProfile::operator+=(const OrderProfile& other) {
  for (std::size_t i = 0; i < kOrders; ++i) values_[i] += other.values_[i];
  return *this;
}

OrderProfile& OrderProfile::operator-=(const OrderProfile& other) {
  for (std::size_t i = 0; i < kOrders; ++i) values_[i] -= other.values_[i];
  return *this;
}

double OrderProfile::at(double order) const {
  const double place = std::clamp((order - kLowest) / kStep, 0.0, double{kOrders - 1});
  const auto low = std::min(static_cast<std::size_t>(place), kOrders - 2);
  return std::lerp(values_[low], values_[low + 1], place - static_cast<double>(low));
}

OrderProfile::Peak OrderProfile::peak() const {
  const auto best = static_cast<std::size_t>(std::ranges::max_element(values_) - values_.begin());
  const std::size_t middle = std::clamp<std::size_t>(best, 1, kOrders - 2);
  const double slope = 0.5 * (values_[middle + 1] - values_[middle - 1]);
  const double curvature = 2.0 * values_[middle] - values_[middle + 1] - values_[middle - 1];
  const double offset = std::clamp(slope / std::max(curvature, 1e-9), -1.0, 1.0);
  return {.order = kLowest + kStep * (static_cast<double>(middle) + offset),
          .standard_error = kStep / std::sqrt(std::max(curvature, 1e-9)),
          .log_likelihood = values_[middle] + offset * slope - 0.5 * offset * offset * curvature};
}

SlowNoise slow_noise_of(const FitData& data, const Selection& selection) {
  double own = selection.log_likelihood;
  for (const Choice& choice : selection.choices) own -= choice.price_nats();
  const auto is_no_order_or_walk = [&](std::size_t i) {
    const NoiseTerms& terms = selection.parts[i].terms;
    return !terms.has_order() && !terms.random_walk;
  };
  const auto is_not_slow = [&](std::size_t i) {
    return !is_slow(selection.parts[i]) || selection.choices[i].effect->has_measured_cause();
  };
  const KeptParts functions = kept_parts(data, selection, is_no_order_or_walk);
  SlowNoise without = slow_noise_beside(kept_parts(data, selection, is_not_slow), own);
  if (!functions.has_room || functions.is_kept == without.is_kept) return without;
  SlowNoise with = slow_noise_beside(functions, own);
  const auto worth = [](const SlowNoise& noise) {
    return noise.by_order.peak().log_likelihood - noise.prices_of_kept;
  };
  return worth(with) > worth(without) ? with : without;
}

std::optional<CommonOrder> common_order_of(std::span<const SlowNoise> axes) {
  if (axes.size() < 2) return std::nullopt;
  double own = 0.0;
  double prices = 0.0;
  double walking = -kSelectionThreshold_nats;
  CommonOrder common{.by_order = axes.front().by_order};
  for (const SlowNoise& axis : axes) {
    if (&axis != axes.data()) common.by_order += axis.by_order;
    own += axis.selected_nats;
    prices += axis.prices_of_kept;
    walking += axis.random_walk_nats;
  }
  common.peak = common.by_order.peak();
  common.gain_nats = common.peak.log_likelihood - common.by_order.at_base_order();
  common.surprisal_nats = statistics::surprisal_of_free(common.gain_nats, 1.0);
  if (is_refuted(axes, common.peak) || rests_on_one(axes, common)) return std::nullopt;
  const double worth =
      common.by_order.at_base_order() - prices + common.surprisal_nats - kSelectionThreshold_nats;
  if (worth < std::max(own, walking)) return std::nullopt;
  const Alternative walk{"rate_random_walk", worth - walking};
  if (walk.less_likely_by_nats < kAlternativeNats) common.alternatives.push_back(walk);
  common.explanations = weigh(kEffect, common.surprisal_nats, std::span(&walk, 1));
  return common;
}

Part part_of_order(const OrderProfile::Peak& peak) {
  return {.effect = kEffect, .terms = {.given_order = peak.order}, .shape = {peak.standard_error}};
}

void replace_slow_noise(const CommonOrder& common, std::span<const std::unique_ptr<Effect>> effects,
                        std::size_t axes, const SlowNoise& slow_noise, Selection& selection) {
  const auto order =
      std::ranges::find_if(effects, [](const auto& effect) { return effect->name() == kEffect; });
  std::vector<Part> parts;
  std::vector<Choice> choices;
  for (std::size_t i = 0; i < selection.choices.size(); ++i) {
    if (!slow_noise.is_kept[i]) continue;
    parts.push_back(std::move(selection.parts[i]));
    choices.push_back(std::move(selection.choices[i]));
  }
  parts.push_back(part_of_order(common.peak));
  choices.push_back({order->get(), common.gain_nats, common.surprisal_nats, common.alternatives,
                     common.explanations, axes});
  selection.parts = std::move(parts);
  selection.choices = std::move(choices);
  mark_selected(selection);
}

}  // namespace zerorate::diagnose
