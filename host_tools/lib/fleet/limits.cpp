// End-of-line test: limits of a type, and one recording judged by them.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "firmware/toml/strict_table.hpp"
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

/// Standard error that the axes have of a coordinate in the middle, at a length of the test, or
/// nothing where most of them have little information on it.
std::optional<double> error_at(const Population& population, int coordinate, double test_s) {
  std::vector<double> errors;
  const double variance = population.distribution.covariance(coordinate, coordinate);
  for (const Member& member : population.members) {
    if (!member.is_in_core) continue;
    const double left = member.evidence.posterior.covariance(coordinate, coordinate);
    if (left >= 0.95 * variance) return std::nullopt;
    const double rest_s = population.recordings[member.recording].result.rest_s;
    errors.push_back(std::sqrt(rest_s / test_s / (1.0 / left - 1.0 / variance)));
  }
  return statistics::median_of(std::move(errors));
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
  if (one.hi < limits.lo || one.lo > limits.hi) {
    one.judgement = Judgement::fail;
  } else if (one.lo < limits.lo || one.hi > limits.hi) {
    one.judgement = Judgement::too_short;
  }
  return one;
}

/// Likeliest value of a coordinate, and the 95 % interval of its profile likelihood.
struct Profile {
  double best = 0.0;
  Range interval;
};
Profile profile_of(const AxisLikelihood& axis, int coordinate) {
  Profile profile{.interval = {std::numeric_limits<double>::infinity(),
                               -std::numeric_limits<double>::infinity()}};
  float best = -std::numeric_limits<float>::infinity();
  for (const GridPoint& point : axis.points) {
    const double x = double{point.position[coordinate]};
    if (point.log_likelihood > best) {
      best = point.log_likelihood;
      profile.best = x;
    }
    const double left_nats = double{point.log_likelihood} + statistics::kHalfChiSquared95;
    if (left_nats < 0.0) continue;
    // The error of ln N takes the nats that the point leaves of the interval's.
    const double error =
        coordinate < 2 ? std::sqrt(2.0 * left_nats * axis.log_white_variance) : 0.0;
    profile.interval.lo = std::min(profile.interval.lo, x - error);
    profile.interval.hi = std::max(profile.interval.hi, x + error);
  }
  return profile;
}

void judge_noise(const AxisResult& axis, const Limits& limits, std::vector<JudgedFigure>& out) {
  const AxisLikelihood likelihood = likelihood_of(axis);
  const auto judge = [&](const FigureEntry& entry, int coordinate) {
    const std::optional<Range>& range = limits.*entry.range;
    if (!range) return;
    const Profile profile = profile_of(likelihood, coordinate);
    const bool is_log = coordinate < 2;
    out.push_back(judged(axis.axis, entry.key, is_log ? std::exp(profile.best) : profile.best,
                         is_log ? exponential(profile.interval) : profile.interval, *range));
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
    const double spread = population.spread(coordinate);
    const char* const figure = figures()[static_cast<std::size_t>(coordinate)].key;
    if (test_s > 0.0) {
      // An interval of a quarter of the limits' width decides nearly every sensor.
      const auto error = error_at(population, coordinate, test_s);
      if (!error || statistics::kHalfWidth95 * *error > 0.5 * kSigmasOfLimits * spread) {
        limits.remarks.push_back(
            fmt::format("{}: a test of {:g} s is too short to decide it", figure, test_s));
        return;
      }
    }
    const Range all = range_of(population.distribution.mean[coordinate], spread);
    range = coordinate == 2 ? all : exponential(all);
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
  for (const std::string& remark : limits.remarks) text += "# " + remark + "\n";
  for (const FigureEntry& entry : figures()) {
    const std::optional<Range>& range = limits.*entry.range;
    if (!range) continue;
    text += fmt::format("\n[{}]\nlo = {:.6g}\nhi = {:.6g}\n", entry.key,
                        range->lo / entry.si_per_unit, range->hi / entry.si_per_unit);
  }
  return text;
}

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

Acceptance accept(const recording::Input& recording, const Limits& limits, std::string_view which) {
  recording::Reader reader{recording};
  const identify::RestSamples samples = read_population_samples(reader);
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
  for (const AxisResult& axis : noise_of(samples, which)) {
    judge_noise(axis, limits, acceptance.figures);
    if (!limits.mean_rate_rad_s) continue;
    // It is the mean of the recording, not a forecast of the next hour's.
    acceptance.figures.push_back(judged(axis.axis, figures()[3].key, axis.mean_rate_rad_s,
                                        {axis.mean_rate_rad_s, axis.mean_rate_rad_s},
                                        *limits.mean_rate_rad_s));
  }
  for (const Judgement judgement : {Judgement::too_short, Judgement::fail}) {
    if (std::ranges::find(acceptance.figures, judgement, &JudgedFigure::judgement) !=
        acceptance.figures.end()) {
      acceptance.judgement = judgement;
    }
  }
  for (const JudgedFigure& one : acceptance.figures) {
    if (one.judgement == acceptance.judgement && one.judgement != Judgement::pass) {
      acceptance.reasons.push_back(reason_of(one));
    }
  }
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
