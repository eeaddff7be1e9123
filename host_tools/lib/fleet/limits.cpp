// End-of-line test: limits of a type, and one recording judged by them.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "firmware/toml/strict_table.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/fleet/population.hpp"
#include "host_tools/lib/identify/rest_check.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::fleet {
namespace {

constexpr double kSigmasOfLimits = 3.29;  // one axis in a thousand lies outside
constexpr toml_file::Rule kFinite{[](double x) { return std::isfinite(x); }, "a finite number"};
constexpr toml_file::Rule kNotNegative{[](double x) { return std::isfinite(x) && x >= 0.0; },
                                       "a number that is not negative"};

/// A figure, its key in the file, and the unit there in SI.
struct FigureEntry {
  const char* key;
  std::optional<Range> Limits::*range;
  double si_per_unit;
};
const std::vector<FigureEntry>& figures() {
  static const std::vector<FigureEntry> all = {
      {"angle_random_walk_dps_per_sqrt_hz", &Limits::angle_random_walk_rad_per_sqrt_s,
       1.0 / units::kDegPerRad},
      {"bias_instability_dph", &Limits::bias_instability_rad_s, 1.0 / units::kDphPerRadS},
      {"order", &Limits::order, 1.0},
      {"mean_rate_dps", &Limits::mean_rate_rad_s, 1.0 / units::kDegPerRad}};
  return all;
}

Range range_of(double mean, double sigma) {
  return {mean - kSigmasOfLimits * sigma, mean + kSigmasOfLimits * sigma};
}

Range exponential(const Range& range) {
  return {std::exp(range.lo), std::exp(range.hi)};
}

/// Distance from the mean of the population to a limit that good sensors keep in a test of this
/// length: where a sensor lies and where the test finds it, and beyond that the half of its
/// interval which nearly all stay below.
/// @param side  half of an interval of a member's profile
template <class Side>
double distance_to_limit(const Population& population, int coordinate, double test_s,
                         const Side& side) {
  constexpr double kNearlyAll = 0.95;
  std::vector<double> halves;
  for (const Member& member : population.members) {
    if (!member.is_in_core) continue;
    const double rest_s = population.recordings[member.recording].result.rest_s;
    halves.push_back(side(member.profiles[static_cast<std::size_t>(coordinate)]) *
                     std::sqrt(rest_s / test_s));
  }
  std::ranges::sort(halves);
  const double error = statistics::quantile_of_sorted(halves, 0.5) / statistics::kHalfWidth95;
  return kSigmasOfLimits * std::hypot(population.spread(coordinate), error) +
         statistics::quantile_of_sorted(halves, kNearlyAll);
}

/// Range of a coordinate for a test of this length; nothing where a limit would be so far away that
/// no sensor fails.
std::optional<Range> range_for_test(const Population& population, int coordinate, double test_s) {
  constexpr double kFarthest = 4.0;  // times the distance without errors
  const double mean = population.distribution.mean[coordinate];
  const double below = distance_to_limit(population, coordinate, test_s,
                                         [](const Profile& one) { return one.best - one.lo; });
  const double above = distance_to_limit(population, coordinate, test_s,
                                         [](const Profile& one) { return one.hi - one.best; });
  Range range{mean - below, mean + above};
  const bool is_beyond_grid =
      coordinate == 2 && range.lo <= Grid::order(0) && range.hi >= Grid::order(Grid::kOrders - 1);
  if (above > kFarthest * kSigmasOfLimits * population.spread(coordinate) || is_beyond_grid) {
    return std::nullopt;
  }
  // A short test cannot exclude that there is no flicker noise, which is no fault.
  if (coordinate == 1) range.lo = -std::numeric_limits<double>::infinity();
  return range;
}

/// Range of the mean rates by median and quartiles; nothing where they are all alike.
std::optional<Range> range_of_mean_rates(const Population& population) {
  std::vector<double> rates;
  for (const StoredRecording& recording : population.recordings) {
    for (const AxisResult& axis : recording.result.axes) rates.push_back(axis.mean_rate_rad_s);
  }
  std::ranges::sort(rates);
  constexpr double kQuartilesOfSigma = 1.349;
  const double sigma =
      (statistics::quantile_of_sorted(rates, 0.75) - statistics::quantile_of_sorted(rates, 0.25)) /
      kQuartilesOfSigma;
  if (!(sigma > 0.0)) return std::nullopt;
  return range_of(statistics::quantile_of_sorted(rates, 0.5), sigma);
}

JudgedFigure judged(const std::string& axis, const char* figure, double value,
                    const Range& interval, const Range& limits) {
  JudgedFigure one{.axis = axis,
                   .figure = figure,
                   .value = value,
                   .lo = interval.lo,
                   .hi = interval.hi,
                   .limits = limits};
  one.judgement = judge(interval, limits);
  return one;
}

void judge_noise(const AxisResult& axis, const Limits& limits, std::vector<JudgedFigure>& out) {
  const AxisLikelihood likelihood = likelihood_of(axis);
  const auto judge = [&](const FigureEntry& entry, int coordinate) {
    const std::optional<Range>& range = limits.*entry.range;
    if (!range) return;
    const Profile profile = profile_of(likelihood, coordinate);
    const bool is_log = coordinate < 2;
    out.push_back(judged(
        axis.axis, entry.key, is_log ? std::exp(profile.best) : profile.best,
        is_log ? Range{std::exp(profile.lo), std::exp(profile.hi)} : Range{profile.lo, profile.hi},
        *range));
  };
  for (int coordinate = 0; coordinate < kCoordinates; ++coordinate) {
    judge(figures()[static_cast<std::size_t>(coordinate)], coordinate);
  }
}

std::string reason_of(const JudgedFigure& one) {
  const auto& entry = *std::ranges::find_if(
      figures(), [&](const FigureEntry& figure) { return figure.key == one.figure; });
  const auto in_unit = [&](double value) { return value / entry.si_per_unit; };
  return fmt::format("axis {}: {} is {:.4g} [{:.4g}, {:.4g}], limits {:.4g} to {:.4g}", one.axis,
                     one.figure, in_unit(one.value), in_unit(one.lo), in_unit(one.hi),
                     in_unit(one.limits.lo), in_unit(one.limits.hi));
}

}  // namespace

Limits limits_of(const Population& population, double test_s) {
  Limits limits{.shortest_s = test_s};
  const auto set = [&](int coordinate, std::optional<Range>& range) {
    std::optional<Range> all =
        range_of(population.distribution.mean[coordinate], population.spread(coordinate));
    if (test_s > 0.0) all = range_for_test(population, coordinate, test_s);
    if (!all) {
      limits.remarks.push_back(fmt::format("{}: a test of {:g} s is too short to decide it",
                                           figures()[static_cast<std::size_t>(coordinate)].key,
                                           test_s));
      return;
    }
    range = coordinate == 2 ? *all : exponential(*all);
  };
  set(0, limits.angle_random_walk_rad_per_sqrt_s);
  set(1, limits.bias_instability_rad_s);
  set(2, limits.order);
  limits.mean_rate_rad_s = range_of_mean_rates(population);
  if (!limits.mean_rate_rad_s)
    limits.remarks.emplace_back("mean_rate_dps: the rates do not differ");
  return limits;
}

std::string format_limits(const Limits& limits) {
  std::string text =
      fmt::format("schema = \"{}\"\nshortest_s = {}\n", kLimitsSchema, limits.shortest_s);
  if (!limits.fail_on.empty()) {
    text += fmt::format("fail_on = [\"{}\"]\n", fmt::join(limits.fail_on, "\", \""));
  }
  for (const std::string& remark : limits.remarks) text += "# " + remark + "\n";
  for (const FigureEntry& entry : figures()) {
    const std::optional<Range>& range = limits.*entry.range;
    if (!range) continue;
    text += fmt::format("\n[{}]\nlo = {:.6g}\nhi = {:.6g}\n", entry.key,
                        range->lo / entry.si_per_unit, range->hi / entry.si_per_unit);
  }
  return text;
}

namespace {

/// Effects that fail a sensor.
std::vector<std::string> read_fail_on(toml_file::StrictTable& top) {
  constexpr std::string_view kWords = "a list of effects in quotes, such as [\"bias_jump\"]";
  std::vector<std::string> effects;
  const toml::node* const node = top.find("fail_on", kWords, toml_file::Presence::optional);
  if (node == nullptr) return effects;
  std::vector<std::string> known;
  known.reserve(diagnose::kEffects.size());
  for (const auto make : diagnose::kEffects) known.emplace_back(make()->name());
  if (node->as_array() == nullptr) top.fail_at("fail_on", fmt::format("expected {}", kWords));
  for (const toml::node& element : *node->as_array()) {
    const std::string name = element.value_or(std::string{});
    if (std::ranges::find(known, name) == known.end()) {
      top.fail_at("fail_on", fmt::format("found \"{}\", expected effects of the diagnosis: {}",
                                         name, fmt::join(known, ", ")));
    }
    effects.push_back(name);
  }
  return effects;
}

}  // namespace

Limits parse_limits(std::string_view toml, std::string_view origin) {
  using toml_file::Presence;
  const toml_file::Document document{toml, origin};
  const toml::table parsed = document.parse();
  toml_file::StrictTable top{document, parsed, ""};
  if (const auto schema = top.text("schema", Presence::required); schema != kLimitsSchema) {
    top.fail_at("schema", fmt::format("expected \"{}\"", kLimitsSchema));
  }
  Limits limits;
  limits.shortest_s = top.number("shortest_s", kNotNegative, Presence::optional).value_or(0.0);
  limits.fail_on = read_fail_on(top);
  for (const FigureEntry& entry : figures()) {
    auto table = top.table(entry.key, Presence::optional);
    if (!table) continue;
    const Range range{*table->number("lo", kFinite, Presence::required) * entry.si_per_unit,
                      *table->number("hi", kFinite, Presence::required) * entry.si_per_unit};
    if (range.lo >= range.hi) table->fail_at("hi", "expected a number above lo");
    table->reject_unknown();
    limits.*entry.range = range;
  }
  top.reject_unknown();
  return limits;
}

Limits read_limits(const std::filesystem::path& file) {
  return parse_limits(toml_file::read_text(file), file.string());
}

std::string_view name(Judgement judgement) {
  switch (judgement) {
    case Judgement::pass:
      return "pass";
    case Judgement::fail:
      return "fail";
    case Judgement::too_short:
      return "too_short";
  }
  return "";
}

Judgement judge(const Range& interval, const Range& limits) {
  if (interval.hi < limits.lo || interval.lo > limits.hi) return Judgement::fail;
  if (interval.lo < limits.lo || interval.hi > limits.hi) return Judgement::too_short;
  return Judgement::pass;
}

bool fails_by(const Cause& cause, const Limits& limits) {
  return !cause.may_be_order && std::ranges::count(limits.fail_on, cause.effect) > 0;
}

namespace {

/// Noise of the axes, with causes where the limits name some.
std::vector<AxisResult> axes_for(const PopulationSamples& recording, const Limits& limits) {
  return limits.fail_on.empty() ? noise_of(recording) : analyse(recording).axes;
}

/// Fails a sensor for causes that the limits name.
void judge_causes(const AxisResult& axis, const Limits& limits, Acceptance& acceptance) {
  for (const Cause& cause : axis.causes) {
    if (!fails_by(cause, limits)) continue;
    acceptance.judgement = Judgement::fail;
    acceptance.reasons.push_back(fmt::format("axis {}: {}, with a probability of {:.3g}", axis.axis,
                                             cause.effect, cause.probability));
  }
}

/// Judges the figures together: one that fails outweighs all.
void judge_figures(Acceptance& acceptance) {
  Judgement judgement = Judgement::pass;
  for (const Judgement one : {Judgement::too_short, Judgement::fail}) {
    if (std::ranges::find(acceptance.figures, one, &JudgedFigure::judgement) !=
        acceptance.figures.end()) {
      judgement = one;
    }
  }
  if (acceptance.judgement != Judgement::fail) acceptance.judgement = judgement;
  for (const JudgedFigure& one : acceptance.figures) {
    if (one.judgement == judgement && judgement != Judgement::pass) {
      acceptance.reasons.push_back(reason_of(one));
    }
  }
  if (acceptance.judgement == Judgement::pass) {
    acceptance.reasons.push_back(
        fmt::format("{} figures lie inside of their limits", acceptance.figures.size()));
  }
}

}  // namespace

Acceptance accept(const recording::Input& input, const Limits& limits, std::string_view which) {
  const PopulationSamples recording = read_population_samples(input, which);
  const identify::RestSamples& samples = recording.samples;
  // Periods of the samples together. Stamps at the ends may hide one more.
  const double period_s = units::seconds(samples.mean_period.ns());
  Acceptance acceptance{.rest_s = period_s * static_cast<double>(samples.time.size())};
  if (acceptance.rest_s + period_s < limits.shortest_s) {
    acceptance.judgement = Judgement::too_short;
    acceptance.reasons.push_back(fmt::format("{} s at rest; the limits want {} s",
                                             units::in_figures(acceptance.rest_s, 4),
                                             units::in_figures(limits.shortest_s, 4)));
    return acceptance;
  }
  if (!recording.axes_left_out.empty()) {
    acceptance.judgement = Judgement::fail;
    acceptance.reasons.push_back(recording.axes_left_out);
  }
  if (!recording.rows_doubt.empty()) acceptance.reasons.push_back(recording.rows_doubt);
  for (const AxisResult& axis : axes_for(recording, limits)) {
    judge_causes(axis, limits, acceptance);
    judge_noise(axis, limits, acceptance.figures);
    if (!limits.mean_rate_rad_s) continue;
    // It is the mean of the recording, not a forecast of the next hour's.
    acceptance.figures.push_back(judged(axis.axis, figures()[3].key, axis.mean_rate_rad_s,
                                        {axis.mean_rate_rad_s, axis.mean_rate_rad_s},
                                        *limits.mean_rate_rad_s));
  }
  judge_figures(acceptance);
  return acceptance;
}

std::string to_json(const Acceptance& acceptance, const std::string& recording) {
  nlohmann::ordered_json json = {
      {"schema", "zerorate.acceptance/1"},       {"recording", recording},
      {"judgement", name(acceptance.judgement)}, {"rest_s", acceptance.rest_s},
      {"reasons", acceptance.reasons},           {"figures", nlohmann::ordered_json::array()}};
  for (const JudgedFigure& one : acceptance.figures) {
    const auto& entry = *std::ranges::find_if(
        figures(), [&](const FigureEntry& figure) { return figure.key == one.figure; });
    json["figures"].push_back(
        {{"axis", one.axis},
         {"figure", one.figure},
         {"value", one.value / entry.si_per_unit},
         {"interval95", {one.lo / entry.si_per_unit, one.hi / entry.si_per_unit}},
         {"limits", {one.limits.lo / entry.si_per_unit, one.limits.hi / entry.si_per_unit}},
         {"judgement", name(one.judgement)}});
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace zerorate::fleet
