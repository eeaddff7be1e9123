#include "host_tools/lib/identify/characterize.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "host_tools/lib/identify/density.hpp"
#include "host_tools/lib/identify/near_zero_mean.hpp"
#include "host_tools/lib/identify/repeats.hpp"
#include "host_tools/lib/identify/rounding.hpp"
#include "host_tools/lib/identify/whittle.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

constexpr std::size_t kFewestForWhittle = 64;
constexpr std::size_t kFewestFrequencies = 8;
constexpr double kBinsPerDecade = 12.0;
constexpr double kOrderOfSensors = 0.5;  ///< where the record has no say

double seconds(core::Duration duration) {
  return static_cast<double>(duration.ns()) * 1e-9;
}

double time_at_rest(const RestSamples& samples) {
  const core::Duration hole =
      std::max(core::Duration::nanoseconds(recording::kShortestHole), samples.mean_period * 2);
  core::Duration rest = samples.mean_period;  // the first sample has one, too
  for (std::size_t k = 1; k < samples.time.size(); ++k) {
    const core::Duration interval = samples.time[k] - samples.time[k - 1];
    const bool is_apart = interval > hole || std::ranges::binary_search(samples.after_drives, k);
    rest = rest + (is_apart ? samples.mean_period : interval);
  }
  return seconds(rest);
}

/// White noise from neighbouring ticks; flicker noise as strong as it at the middle of the band.
StartValues rough_start(std::span<const TickMean> ticks, std::size_t axis, double tick_s) {
  double squares = 0.0;
  for (std::size_t k = 1; k < ticks.size(); ++k) {
    const double step = double{ticks[k].rate_rad_s[axis]} - double{ticks[k - 1].rate_rad_s[axis]};
    squares += step * step;
  }
  const double variance = 0.5 * squares / static_cast<double>(ticks.size() - 1);
  const double white = std::sqrt(variance * tick_s);
  const double middle_rad_per_s =
      std::numbers::pi / (tick_s * std::sqrt(static_cast<double>(ticks.size())));
  return {white, white * std::sqrt(middle_rad_per_s)};
}

/// The Whittle fit; where it finds no flicker noise, flicker noise as strong as in the rough start.
StartValues whittle_start(const EvenRecord& even, const StartValues& rough,
                          std::optional<double> order) {
  const WhiteFlickerFit fit = fit_white_flicker(even.rate_rad_s, {.order = order});
  StartValues start = rough;
  start.angle_random_walk_rad_per_sqrt_s =
      spectrum::angle_random_walk(fit.white_variance.value, even.sample_period_s);
  if (fit.flicker) {
    start.order = std::clamp(fit.flicker->order.value, 0.1, 0.9);
    start.bias_instability_rad_s = spectrum::bias_instability(
        fit.flicker->innovation_variance.value, start.order, even.sample_period_s);
  }
  return start;
}

double minus_two_log(const InnovationsLikelihood& likelihood, const StartValues& start,
                     double shortest_s) {
  model::SensorModel model{.name = "start"};
  model.white.angle_random_walk_rad_per_sqrt_s = start.angle_random_walk_rad_per_sqrt_s;
  model.flicker = model::Flicker{.bias_instability_rad_s = start.bias_instability_rad_s,
                                 .order = start.order,
                                 .shortest_time_constant_s = shortest_s};
  return likelihood(model).minus_two_log();
}

/// The first is the likelier one of the Whittle fit, which may be far off where the longest stretch
/// is a short stop, and the rough start.
std::vector<StartValues> start_values(const InnovationsLikelihood& likelihood,
                                      std::span<const TickMean> ticks, const EvenRecord& even,
                                      std::size_t axis, std::optional<double> order,
                                      double shortest_s) {
  const StartValues rough = rough_start(ticks, axis, even.sample_period_s);
  if (even.rate_rad_s.size() < kFewestForWhittle) return {rough};
  const StartValues whittle = whittle_start(even, rough, order.value_or(kOrderOfSensors));
  const bool is_likely = minus_two_log(likelihood, whittle, shortest_s) <=
                         minus_two_log(likelihood, rough, shortest_s);
  std::vector<StartValues> starts{is_likely ? whittle : rough};
  // Many short stretches may have a second maximum, without white noise.
  if (2 * even.rate_rad_s.size() < ticks.size()) starts.push_back(is_likely ? rough : whittle);
  if (!order) starts.push_back(whittle_start(even, rough, std::nullopt));
  return starts;
}

std::optional<Estimate> local_whittle_order(const EvenRecord& even,
                                            const model::SensorModel& model) {
  const std::size_t size = even.rate_rad_s.size();
  if (!model.flicker || size < kFewestForWhittle) return std::nullopt;
  const double below_corner =
      0.5 * corner_frequency_hz(model) * even.sample_period_s * static_cast<double>(size);
  const double bandwidth =
      std::min({below_corner, static_cast<double>(local_whittle_bandwidth(size)),
                0.4 * static_cast<double>(size)});
  const auto frequencies = static_cast<std::size_t>(bandwidth);
  if (frequencies < kFewestFrequencies) return std::nullopt;
  return exact_local_whittle(even.rate_rad_s, frequencies);
}

/// Samples if most of the record is one even stretch of them, else ticks.
EvenRecord record_for_curves(const RestSamples& samples, const EvenRecord& even_ticks,
                             std::size_t axis) {
  EvenRecord even = longest_even_samples(samples, axis);
  const double length = static_cast<double>(even.rate_rad_s.size()) * even.sample_period_s;
  const double length_of_ticks =
      static_cast<double>(even_ticks.rate_rad_s.size()) * even_ticks.sample_period_s;
  return 2.0 * length >= length_of_ticks ? even : even_ticks;
}

model::SensorModel named_model(const InnovationsFit& fit, double shortest_time_constant_s,
                               const std::string& recording, const std::string& axis) {
  model::SensorModel model = fit.model(shortest_time_constant_s);
  model.name = fmt::format("{}, axis {}", recording, axis);
  const std::string source =
      fmt::format("identified from {}, axis {}, by zerorate characterize", recording, axis);
  const auto& white = fit.angle_random_walk_rad_per_sqrt_s;
  model.white.source = fmt::format("{}; relative standard error {:.1f} %", source,
                                   100.0 * white.standard_error / white.value);
  if (!fit.flicker) {
    model.white.source += "; no flicker noise detectable";
    return model;
  }
  const auto& b = fit.flicker->bias_instability_rad_s;
  model.flicker->source = fmt::format("{}; relative standard error {:.1f} %", source,
                                      100.0 * b.standard_error / b.value);
  if (fit.flicker->order_source == OrderSource::estimated) {
    model.flicker->source +=
        fmt::format("; standard error of the order {:.3f}", fit.flicker->order.standard_error);
  }
  return model;
}

std::vector<std::string> remarks_on(const InnovationsFit& fit) {
  std::vector<std::string> remarks;
  if (fit.angle_random_walk_rad_per_sqrt_s.standard_error >
      0.5 * fit.angle_random_walk_rad_per_sqrt_s.value) {
    remarks.emplace_back(
        "Slow noise hides the white noise at every tick: the angle random walk is hardly known, "
        "and "
        "the intervals of the slow noise are too narrow. More samples a second may show it.");
  }
  if (!fit.flicker) {
    remarks.emplace_back(
        "No flicker noise is detectable in this recording, so the model has none. A longer "
        "recording may show it.");
  } else if (fit.flicker->order_source == OrderSource::limit) {
    remarks.emplace_back(
        "The bias drifts at least like a random walk (order .95, the highest allowed): look for "
        "temperature, warm-up or motion before trusting this model.");
  } else if (fit.flicker->rejected_order) {
    remarks.push_back(fmt::format(
        "The recording is too short to determine the order ({:.2f}, 95 % interval {:.2f} to "
        "{:.2f}{}); 1/2 is kept.",
        fit.flicker->rejected_order->value, fit.flicker->rejected_order->lo,
        fit.flicker->rejected_order->hi,
        fit.flicker->rejected_order->hi < 0.5 ? " if there were no white noise" : ""));
  }
  return remarks;
}

/// Quicker decades than half the sample period would be white noise to the filter.
double shortest_time_constant_s(core::Duration sample_period) {
  return std::max(0.5, 0.5 * seconds(sample_period));
}

AxisCharacterization characterize_axis(const RestSamples& samples,
                                       const std::vector<TickMean>& ticks, core::Duration tick,
                                       std::size_t axis, const CharacterizeOptions& options) {
  const EvenRecord even_ticks = longest_even_ticks(ticks, tick, axis);
  AxisCharacterization result{.axis = samples.axis_name(axis)};
  PreparedFit prepared = prepare_fit({ticks, samples.mean_period, tick, axis}, options.order);
  prepared.options.of = FitOf::noise;
  const double shortest_s = prepared.options.shortest_time_constant_s;
  result.fit = fit_by_innovations(prepared.likelihood, prepared.options);
  result.coefficients = fit_coefficients(prepared.likelihood, result.fit, shortest_s);
  result.model = named_model(result.fit, shortest_s, options.recording, result.axis);
  result.local_whittle_order = local_whittle_order(even_ticks, result.model);
  result.remarks = remarks_on(result.fit);
  for (auto remark :
       {remark_on_mean(samples, axis),
        remark_on_rounding(samples, axis, result.fit.angle_random_walk_rad_per_sqrt_s)}) {
    if (remark) result.remarks.push_back(std::move(*remark));
  }

  const EvenRecord record = record_for_curves(samples, even_ticks, axis);
  if (record.rate_rad_s.size() >= kFewestFrequencies) {
    result.allan = allan_deviation(record.rate_rad_s, record.sample_period_s);
    result.density =
        bin_logarithmically(periodogram(record.rate_rad_s, record.sample_period_s), kBinsPerDecade);
  } else {
    result.remarks.emplace_back(
        "The recording has no stretch without holes that is long enough for an Allan deviation.");
  }
  return result;
}

double slow_noise(const AxisCharacterization& axis) {
  constexpr double kSlowHz = 0.01;
  const double white = axis.model.white.angle_random_walk_rad_per_sqrt_s;
  return model_density(axis.model, kSlowHz) - white * white;
}

/// Whether the flicker noise of an axis is stronger than its white noise at the tick, by Whittle's
/// fit.
bool hides_white_noise(const std::vector<TickMean>& ticks, core::Duration tick, std::size_t axis,
                       std::optional<double> order) {
  const EvenRecord even = longest_even_ticks(ticks, tick, axis);
  if (even.rate_rad_s.size() < kFewestForWhittle) return false;
  const WhiteFlickerFit fit =
      fit_white_flicker(even.rate_rad_s, {.order = order.value_or(kOrderOfSensors)});
  return fit.flicker && fit.flicker->innovation_variance.value > fit.white_variance.value;
}

/// Tick means from which white noise and flicker noise can be separated: where flicker noise is the
/// stronger one, the tick is halved, down to the sample period.
struct Ticks {
  core::Duration tick;
  std::vector<TickMean> means;

  Ticks(const RestSamples& samples, const CharacterizeOptions& options)
      : tick(identification_tick(samples)), means(average_ticks(samples, tick)) {
    constexpr std::size_t kMostTicks = 131'072;
    const auto hides = [&](std::size_t axis) {
      return hides_white_noise(means, tick, axis, options.order);
    };
    while (tick / 2 >= samples.mean_period && 2 * means.size() <= kMostTicks &&
           std::ranges::any_of(options.axes, hides)) {
      tick = tick / 2;
      means = average_ticks(samples, tick);
    }
  }
};

}  // namespace

const AllanPoint& AxisCharacterization::allan_floor() const {
  return *std::ranges::min_element(allan, {}, &AllanPoint::hi);
}

PreparedFit prepare_fit(const AxisTicks& ticks, std::optional<double> order) {
  const EvenRecord even = longest_even_ticks(ticks.means, ticks.tick, ticks.axis);
  InnovationsLikelihood likelihood{ticks.means, ticks.axis, ticks.sample_period, ticks.tick};
  const double shortest_s = shortest_time_constant_s(ticks.sample_period);
  InnovationsFitOptions options{
      .starts = start_values(likelihood, ticks.means, even, ticks.axis, order, shortest_s),
      .order = order,
      .shortest_time_constant_s = shortest_s};
  return {std::move(likelihood), std::move(options)};
}

InnovationsFit fit_noise(const AxisTicks& ticks, std::optional<double> order) {
  const PreparedFit prepared = prepare_fit(ticks, order);
  return fit_by_innovations(prepared.likelihood, prepared.options);
}

model::SensorModel model_of(const InnovationsFit& fit, core::Duration sample_period,
                            const std::string& recording, const std::string& axis) {
  return named_model(fit, shortest_time_constant_s(sample_period), recording, axis);
}

core::Duration identification_tick(core::Duration span, core::Duration sample_period) {
  constexpr std::int64_t kFewTicks = 1024;
  constexpr std::int64_t kManyTicks = 65'536;
  core::Duration tick = std::max(core::Duration::milliseconds(500), sample_period);
  while (span / tick < kFewTicks && tick / 2 >= sample_period) tick = tick / 2;
  while (span / tick > kManyTicks) tick = tick * 2;
  return tick;
}

core::Duration identification_tick(const RestSamples& samples) {
  return identification_tick(samples.span(), std::max(samples.sample_period, samples.mean_period));
}

RestSamples measurements_of(const RestSamples& all) {
  constexpr double kMostOutliers = 0.05;  // more are the noise of this sensor, or none of a gyro
  RestSamples samples = without_repeats(all);
  const std::vector<std::size_t> outliers = find_outliers(samples);
  const auto most = kMostOutliers * static_cast<double>(samples.time.size());
  if (static_cast<double>(outliers.size()) > most) {
    throw recording::DataError(fmt::format(
        "{} of {} samples at rest lie 20 standard deviations from those around them: they are no "
        "noise of a gyro. 'zerorate diagnose' shows where",
        outliers.size(), samples.time.size()));
  }
  RestSamples rest = without(std::move(samples), outliers);
  rest.outliers += outliers.size();
  if (rest.moving > 0) return rest;
  const std::vector<std::size_t> wild = find_wild_stretches(rest);
  rest.outliers += wild.size();
  return without(std::move(rest), wild);
}

Characterization characterize(const RestSamples& all, const CharacterizeOptions& options) {
  const RestSamples samples = measurements_of(all);
  const auto [tick, ticks] = Ticks(samples, options);
  require_besides_motion(samples, ticks.size(), kFewestForWhittle, "filter ticks at rest");
  Characterization result{.recording = options.recording,
                          .rows = samples.rows,
                          .rows_moving = samples.moving,
                          .rows_lost = samples.lost,
                          .rows_wild = samples.wild,
                          .rows_repeated = samples.repeated,
                          .rows_outlying = samples.outliers,
                          .findings = samples.findings,
                          .sample_period = samples.mean_period,
                          .tick = tick};
  result.ticks = ticks.size();
  result.rest_s = time_at_rest(samples);
  for (const std::size_t axis : options.axes) {
    result.axes.push_back(characterize_axis(samples, ticks, result.tick, axis, options));
    if (options.on_progress) {
      options.on_progress(static_cast<double>(result.axes.size()) /
                          static_cast<double>(options.axes.size()));
    }
  }
  return result;
}

void require_noise_of_rest(const Characterization& result) {
  constexpr double kWidest = 100.0;
  for (const AxisCharacterization& axis : result.axes) {
    const IntervalEstimate& white = axis.fit.angle_random_walk_rad_per_sqrt_s;
    if (white.hi <= kWidest * white.lo) continue;
    throw recording::DataError(fmt::format(
        "axis {}: the {:.0f} s that the gyro itself shows as rest do not determine the white "
        "noise, "
        "which may be {:.2g} to {:.2g} deg/s/sqrt(Hz): the sensor moved in them. Name its rest by "
        "a "
        "still, odometer_pulses or speed column, or cut the recording to its rest",
        axis.axis, result.rest_s, white.lo * units::kDegPerRad, white.hi * units::kDegPerRad));
  }
}

const AxisCharacterization& middle_axis(const Characterization& result) {
  std::vector<const AxisCharacterization*> by_noise;
  for (const auto& axis : result.axes) by_noise.push_back(&axis);
  std::ranges::sort(by_noise, {}, [](const auto* axis) { return slow_noise(*axis); });
  return *by_noise[by_noise.size() / 2];
}

}  // namespace zerorate::identify
