#include "host_tools/lib/diagnose/inputs/input_effects.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "host_tools/lib/diagnose/inputs/attitudes.hpp"
#include "host_tools/lib/diagnose/inputs/input_words.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kFewestTicks = 64;

double spread_of(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / count);
}

/// An effect that may be in the record, by its columns.
struct Hypothetical {
  std::string_view name;
  std::vector<InputColumn> columns;
  std::string_view obstacle{};  ///< reason why the record cannot show it
  bool is_rival_alone = false;  ///< another room of the diagnosis names it
};

std::string_view obstacle_of_attitudes(const Attitudes& attitudes) {
  if (attitudes.directions.empty()) return "one attitude";
  return attitudes.standstills < attitudes.directions.size() + 3 ? "too few attitudes"
                                                                 : std::string_view{};
}

Hypothetical g_sensitivity(const InputTicks& ticks, const Attitudes& attitudes) {
  Hypothetical effect{.name = kGSensitivity, .obstacle = obstacle_of_attitudes(attitudes)};
  for (const Direction& direction : attitudes.directions) {
    effect.columns.push_back(acceleration_along(ticks, direction));
  }
  return effect;
}

/// A change of the variance within a tick must stand out of its scatter so much.
constexpr double kStandsOut = 3.0;

/// The variance tick by tick, and its mean over each standstill in which it hardly changes. The
/// variance of a tick scatters by itself, as that of noise, and an input with an error of its own
/// has too small a coefficient.
/// @param scatter  standard deviation of the variance of a tick, over the variance
InputColumn steady_vibration(const InputTicks& ticks, double scatter) {
  InputColumn column = ticks.vibration_g2;
  for (std::size_t first = 0; first < column.size();) {
    std::size_t end = first;
    while (end < column.size() && ticks.standstill[end] == ticks.standstill[first]) ++end;
    const auto begin = column.begin() + static_cast<std::ptrdiff_t>(first);
    const std::vector<double> stop(begin, column.begin() + static_cast<std::ptrdiff_t>(end));
    const double mean =
        std::accumulate(stop.begin(), stop.end(), 0.0) / static_cast<double>(stop.size());
    if (spread_of(stop) < kStandsOut * scatter * mean) std::fill_n(begin, stop.size(), mean);
    first = end;
  }
  return column;
}

Hypothetical vibration_rectification(const InputTicks& ticks) {
  Hypothetical effect{.name = kVibrationRectification};
  if (ticks.vibration_g2.empty()) {
    effect.obstacle = "too few samples a tick";
    return effect;
  }
  const double samples =
      static_cast<double>(ticks.tick.ns()) / static_cast<double>(ticks.sample_period.ns());
  const double scatter = std::sqrt(2.0 / (3.0 * samples));
  if (!(spread_of(ticks.vibration_g2) >
        kStandsOut * scatter * statistics::median_of(ticks.vibration_g2))) {
    effect.obstacle = "the vibration hardly changes";
    return effect;
  }
  effect.columns.push_back(steady_vibration(ticks, scatter));
  return effect;
}

/// The temperature as another explanation of biases that differ.
Hypothetical temperature_drift(const InputTicks& ticks) {
  constexpr double kLeastSpread_k = 0.02;
  Hypothetical effect{.name = "temperature_drift", .is_rival_alone = true};
  if (ticks.temperature_degc.empty() || spread_of(ticks.temperature_degc) < kLeastSpread_k) {
    effect.obstacle = "no change of the temperature";
    return effect;
  }
  effect.columns.push_back(ticks.temperature_degc);
  return effect;
}

/// Fits of the effects beside those that were chosen.
class InputSearch {
 public:
  InputSearch(const InputTicks& ticks, std::size_t axis, std::vector<Hypothetical> effects)
      : ticks_(ticks), axis_(axis), effects_(std::move(effects)) {
    base_ = fit_of({});
  }

  using Effects = std::vector<const Hypothetical*>;
  struct Proposal {
    const Hypothetical* effect = nullptr;
    double gain_nats = 0.0;
    double surprisal_nats = 0.0;
  };
  struct Chosen {
    Proposal proposal;
    std::vector<Alternative> rivals;
  };

  void select(double threshold_nats) {
    while (true) {
      std::vector<Proposal> proposals = this->proposals();
      if (chosen_.empty()) first_ = proposals;
      const auto best = std::ranges::find_if(
          proposals, [](const Proposal& one) { return !one.effect->is_rival_alone; });
      if (best == proposals.end() || best->surprisal_nats <= threshold_nats) break;
      chosen_.push_back({*best, rivals_of(*best, proposals)});
    }
    for (Chosen& one : chosen_) weigh_beside_others(one);
    final_ = fit_of(chosen_effects());
  }

  [[nodiscard]] const std::vector<Hypothetical>& effects() const { return effects_; }
  [[nodiscard]] const std::vector<Proposal>& first() const { return first_; }
  [[nodiscard]] const std::vector<Chosen>& chosen() const { return chosen_; }
  [[nodiscard]] const InputFit& fit() const { return final_; }
  [[nodiscard]] Effects chosen_effects(const Hypothetical* but = nullptr) const {
    Effects effects;
    for (const Chosen& one : chosen_) {
      if (one.proposal.effect != but) effects.push_back(one.proposal.effect);
    }
    return effects;
  }

 private:
  static std::vector<InputColumn> columns_of(const Effects& effects) {
    std::vector<InputColumn> columns;
    for (const Hypothetical* effect : effects) {
      columns.insert(columns.end(), effect->columns.begin(), effect->columns.end());
    }
    return columns;
  }

  [[nodiscard]] InputFit fit_of(const Effects& effects) const {
    return fit_inputs(ticks_, axis_, columns_of(effects));
  }

  [[nodiscard]] Proposal proposal_of(const Hypothetical& effect, Effects beside,
                                     double log_likelihood) const {
    beside.push_back(&effect);
    const double inflation = inflation_of_gains(ticks_, axis_, columns_of(beside), effect.columns);
    const double gain = std::max(0.0, fit_of(beside).log_likelihood - log_likelihood);
    return {&effect, gain,
            statistics::surprisal_of_free(gain / inflation,
                                          static_cast<double>(effect.columns.size()))};
  }

  /// Effects that are not chosen yet, beside those that are; the most surprising first.
  [[nodiscard]] std::vector<Proposal> proposals() const {
    const Effects beside = chosen_effects();
    const double log_likelihood =
        beside.empty() ? base_.log_likelihood : fit_of(beside).log_likelihood;
    std::vector<Proposal> all;
    for (const Hypothetical& effect : effects_) {
      if (!effect.obstacle.empty() || std::ranges::find(beside, &effect) != beside.end()) continue;
      all.push_back(proposal_of(effect, beside, log_likelihood));
    }
    std::ranges::stable_sort(all, std::greater{}, &Proposal::surprisal_nats);
    return all;
  }

  static std::vector<Alternative> rivals_of(const Proposal& best,
                                            const std::vector<Proposal>& proposals) {
    std::vector<Alternative> rivals;
    for (const Proposal& rival : proposals) {
      if (rival.effect == best.effect) continue;
      rivals.push_back(
          {std::string(rival.effect->name), best.surprisal_nats - rival.surprisal_nats});
    }
    return rivals;
  }

  void weigh_beside_others(Chosen& one) {
    if (chosen_.size() < 2) return;
    const Effects others = chosen_effects(one.proposal.effect);
    one.proposal = proposal_of(*one.proposal.effect, others, fit_of(others).log_likelihood);
  }

  const InputTicks& ticks_;
  std::size_t axis_;
  std::vector<Hypothetical> effects_;
  InputFit base_;
  std::vector<Proposal> first_;
  std::vector<Chosen> chosen_;
  InputFit final_;
};

/// Coefficients along x, y and z of those along directions; the error is infinite on an axis that
/// the directions do not span.
InputEffect along_axes(const InputFit& fit, std::size_t first, const Attitudes& attitudes) {
  constexpr double kSpanned = 0.99;
  InputEffect effect{.name = std::string(kGSensitivity)};
  const std::vector<Direction>& directions = attitudes.directions;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double value = 0.0;
    double variance = 0.0;
    double spanned = 0.0;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      value += directions[i][axis] * fit.coefficients[first + i];
      spanned += directions[i][axis] * directions[i][axis];
      for (std::size_t j = 0; j < directions.size(); ++j) {
        variance +=
            directions[i][axis] * directions[j][axis] * fit.covariance[first + i][first + j];
      }
    }
    effect.value_rad_s.push_back(value);
    effect.standard_error_rad_s.push_back(
        spanned > kSpanned ? std::sqrt(variance) : std::numeric_limits<double>::infinity());
  }
  return effect;
}

InputEffect effect_of(const Hypothetical& found, const InputFit& fit, std::size_t first,
                      const Attitudes& attitudes) {
  if (found.name == kGSensitivity) return along_axes(fit, first, attitudes);
  return {.name = std::string(found.name),
          .value_rad_s = {fit.coefficients[first]},
          .standard_error_rad_s = {std::sqrt(fit.covariance[first][first])}};
}

/// Number of the tick from which on a share of the standstills, or of a few the ticks, is held out.
std::size_t first_held_out(const InputTicks& ticks, double share) {
  constexpr std::size_t kFewestStandstills = 8;
  const auto part = [&](std::size_t count) {
    return static_cast<std::size_t>((1.0 - share) * static_cast<double>(count));
  };
  if (ticks.standstills() < kFewestStandstills) return part(ticks.size());
  const auto first = std::ranges::lower_bound(ticks.standstill, part(ticks.standstills()));
  return static_cast<std::size_t>(first - ticks.standstill.begin());
}

/// Worth of an effect beside the others.
std::optional<InputWorth> worth_of(const InputTicks& ticks, std::size_t axis,
                                   const std::vector<const Hypothetical*>& all,
                                   const Hypothetical& effect, double share) {
  const std::size_t first = first_held_out(ticks, share);
  if (first < kFewestTicks || first >= ticks.size()) return std::nullopt;
  const bool has_attitudes = attitudes_of(beginning_of(ticks, first)).directions.size() ==
                             attitudes_of(ticks).directions.size();
  if (effect.name == kGSensitivity && !has_attitudes) return std::nullopt;
  std::vector<InputColumn> with;
  std::vector<InputColumn> without;
  for (const Hypothetical* one : all) {
    with.insert(with.end(), one->columns.begin(), one->columns.end());
    if (one != &effect) without.insert(without.end(), one->columns.begin(), one->columns.end());
  }
  const double gain =
      score_of_rest(ticks, axis, with, first) - score_of_rest(ticks, axis, without, first);
  const std::size_t standstills = ticks.standstills() - ticks.standstill[first];
  return InputWorth{standstills, gain / static_cast<double>(standstills)};
}

Cause cause_of(const InputSearch::Chosen& chosen, const InputEffect& effect, const Spread& spread) {
  const auto& [proposal, rivals] = chosen;
  Cause cause{.effect = effect.name,
              .gain_nats = proposal.gain_nats,
              .p_value = std::exp(-proposal.surprisal_nats),
              .parameters = parameters_of(effect),
              .sentence = sentence_of(effect, spread),
              .in_model = effect.pays(),
              .left_out_because = reason_to_leave_out(effect)};
  std::vector<Alternative> behind;
  for (const Alternative& rival : rivals) {
    if (std::abs(rival.less_likely_by_nats) <= kAlternativeNats)
      cause.alternatives.push_back(rival);
    behind.push_back(rival);
  }
  double sum = 0.0;
  for (const Explanation& one : weigh(effect.name, proposal.surprisal_nats, behind)) {
    if (one.effect == effect.name) cause.probability = one.probability;
    if (sum < 0.95) cause.set95.push_back(one);
    sum += one.probability;
  }
  return cause;
}

std::vector<SelectionEvidence> evidence_of(const InputSearch& search, double threshold_nats) {
  std::vector<SelectionEvidence> evidence;
  for (const InputSearch::Proposal& proposal : search.first()) {
    if (proposal.effect->is_rival_alone) continue;
    const bool is_chosen = std::ranges::any_of(
        search.chosen(), [&](const auto& one) { return one.proposal.effect == proposal.effect; });
    evidence.push_back({.effect = std::string(proposal.effect->name),
                        .gain_nats = proposal.gain_nats,
                        .price_nats = threshold_nats + proposal.gain_nats - proposal.surprisal_nats,
                        .selected = is_chosen});
  }
  for (const Hypothetical& effect : search.effects()) {
    if (effect.obstacle.empty() || effect.is_rival_alone) continue;
    evidence.push_back(
        {.effect = std::string(effect.name), .not_examined = std::string(effect.obstacle)});
  }
  return evidence;
}

/// Scatter of the biases of the standstills, with and without the share of the inputs.
Spread spread_with(const InputTicks& ticks, std::size_t axis, const std::vector<double>& share) {
  std::vector<double> rate;
  std::vector<double> left;
  for (std::size_t k = 0; k < ticks.size(); ++k) {
    rate.push_back(double{ticks.means[k].rate_rad_s[axis]});
    left.push_back(rate.back() - share[k]);
  }
  return {.before_rad_s = spread_of(means_by_standstill(ticks, rate)),
          .after_rad_s = spread_of(means_by_standstill(ticks, left)),
          .standstills = ticks.standstills()};
}

}  // namespace

InputFindings find_input_effects(const InputTicks& ticks, std::size_t axis,
                                 const InputSearchOptions& options) {
  InputFindings findings;
  if (ticks.size() < kFewestTicks) return findings;
  const Attitudes attitudes = attitudes_of(ticks);
  InputSearch search(
      ticks, axis,
      {g_sensitivity(ticks, attitudes), vibration_rectification(ticks), temperature_drift(ticks)});
  search.select(options.threshold_nats);
  findings.evidence = evidence_of(search, options.threshold_nats);
  if (!obstacle_of_attitudes(attitudes).empty()) {
    findings.remarks.push_back(remark_on(attitudes.standstills));
  }
  if (search.chosen().empty()) return findings;
  std::size_t first = 0;
  for (const InputSearch::Chosen& chosen : search.chosen()) {
    const Hypothetical& effect = *chosen.proposal.effect;
    std::vector<double> share(ticks.size(), 0.0);
    for (std::size_t i = 0; i < effect.columns.size(); ++i) {
      for (std::size_t k = 0; k < share.size(); ++k) {
        share[k] += search.fit().coefficients[first + i] * effect.columns[i][k];
      }
    }
    findings.effects.push_back(effect_of(effect, search.fit(), first, attitudes));
    findings.effects.back().worth =
        worth_of(ticks, axis, search.chosen_effects(), effect, options.holdout);
    findings.causes.push_back(
        cause_of(chosen, findings.effects.back(), spread_with(ticks, axis, share)));
    if (effect.name == kVibrationRectification) findings.vibration_share_rad_s = share;
    first += effect.columns.size();
  }
  return findings;
}

}  // namespace zerorate::diagnose
