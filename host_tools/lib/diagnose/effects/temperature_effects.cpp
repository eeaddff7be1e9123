#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

constexpr double kLeastSpread = 0.02;     // K, rms
constexpr double kWorthAParameter = 5.0;  // nats
constexpr double kLagGrid = 1.6;

std::vector<double> temperature_of(const FitData& data) {
  const auto& all = data.series().temperature_degc;
  return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(data.size())};
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double rms_about_mean(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

std::string_view obstacle_of_temperature(const FitData& data) {
  if (data.series().temperature_degc.empty()) return "no temperature";
  return rms_about_mean(temperature_of(data)) > kLeastSpread ? std::string_view{}
                                                             : "the temperature hardly changes";
}

/// The temperature behind a first-order lag; 0: the temperature itself.
std::vector<double> lagged(std::vector<double> temperature, double period_s, double lag_s) {
  const double follow = lag_s > 0.0 ? -std::expm1(-period_s / lag_s) : 1.0;
  double element = temperature.front();
  for (double& degc : temperature) {
    element += follow * (degc - element);
    degc = element;
  }
  return temperature;
}

/// Longest lag that is searched for. The others are a factor of kLagGrid apart.
double longest_lag_s(const FitData& data) {
  return 0.25 * data.span_s();
}

std::vector<Column> columns_behind(const FitData& data, double lag_s) {
  const std::vector<double> temperature = temperature_of(data);
  const double reference = mean_of(temperature);
  std::vector<double> excess = lagged(temperature, data.period_s(), lag_s);
  for (double& e : excess) e -= reference;
  std::vector<Column> columns{column_of(data, std::span<const double>(excess))};
  for (double& e : excess) e *= e;
  columns.push_back(column_of(data, std::span<const double>(excess)));
  return columns;
}

/// The temperature at once, then behind each lag, the longest first.
const std::vector<LaggedTemperature>& lagged_temperatures(const FitData& data) {
  return data.lagged_temperatures().get([&] {
    std::vector<LaggedTemperature> all{{0.0, columns_behind(data, 0.0)}};
    for (double lag = longest_lag_s(data); lag > 2.0 * data.period_s(); lag /= kLagGrid) {
      all.push_back({lag, columns_behind(data, lag)});
    }
    return all;
  });
}

/// A bias that follows the temperature: linear or with a square, at once or with a lag. The part's
/// shape: the lag in s (0: none) and the temperature that the columns are zero at.
class TemperatureDrift final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "temperature_drift"; }
  [[nodiscard]] Pace pace() const override { return Pace::slow; }
  [[nodiscard]] bool has_measured_cause() const override { return true; }

  [[nodiscard]] std::string_view obstacle(const Hypothesis& without) const override {
    return obstacle_of_temperature(without.data());
  }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const double linear = fitted.amplitude(0) * kDegPerRad;
    Description description{.parameters = {parameter("linear_dps_per_k", linear,
                                                     fitted.amplitude_error(0) * kDegPerRad)}};
    description.sentence =
        fmt::format("The bias follows the temperature by {:.3g} deg/s per K", linear);
    if (fitted.part().columns.size() > 1) {
      const double quadratic = fitted.amplitude(1) * kDegPerRad;
      description.parameters.push_back(
          parameter("quadratic_dps_per_k2", quadratic, fitted.amplitude_error(1) * kDegPerRad));
      description.sentence += fmt::format(", curved by {:.2g} deg/s per K^2", quadratic);
    }
    const double lag = fitted.part().shape[0];
    if (lag > 0.0) {
      description.parameters.push_back({"lag_s", lag, lag / kLagGrid, lag * kLagGrid});
      description.sentence += fmt::format(", {} s behind", units::in_figures(lag));
    }
    const double reference = fitted.part().shape[1];
    description.parameters.push_back({"reference_degc", reference, reference, reference});
    description.sentence += ".";
    description.drawing = drawing_of(fitted);
    return description;
  }

  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    model::TemperatureDrift drift{.reference_degc = fitted.part().shape[1],
                                  .slope_rad_s_per_k = fitted.amplitude(0),
                                  .slope_sigma_rad_s_per_k = fitted.amplitude_error(0),
                                  .lag_s = fitted.part().shape[0]};
    if (fitted.part().columns.size() > 1) {
      drift.curvature_rad_s_per_k2 = fitted.amplitude(1);
      drift.curvature_sigma_rad_s_per_k2 = fitted.amplitude_error(1);
    }
    model.temperature = drift;
  }

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    std::optional<Candidate> candidate =
        mean_candidate(without, [this](const ColumnSearch& scan) { return search(scan); });
    if (!candidate) return std::nullopt;
    const double lags = candidate->part.shape[0] > 0.0 ? 3.0 : 0.0;
    candidate->surprisal_nats = statistics::surprisal_of_search(
        candidate->gain_nats, static_cast<double>(candidate->part.columns.size()), lags);
    return candidate;
  }

  [[nodiscard]] std::optional<Part> search(const ColumnSearch& scan) const {
    struct Best {
      const LaggedTemperature* temperature;
      std::size_t columns;
      double gain;
    };
    const std::vector<LaggedTemperature>& temperatures = lagged_temperatures(scan.data());
    const auto gain_of = [&](const LaggedTemperature& temperature, std::size_t columns) {
      return scan.gain(std::span(temperature.columns).first(columns));
    };
    Best best{temperatures.data(), 1, gain_of(temperatures.front(), 1)};
    for (const LaggedTemperature& temperature : temperatures) {
      for (const std::size_t columns : {1U, 2U}) {
        // More than the best needs; what it has beyond this one is worth as much.
        const auto more = static_cast<double>(columns) - static_cast<double>(best.columns);
        const bool is_first_lag = temperature.lag_s > 0.0 && best.temperature->lag_s == 0.0;
        const double worth = kWorthAParameter * (more + (is_first_lag ? 1.0 : 0.0));
        const double gain = gain_of(temperature, columns);
        if (gain > best.gain + worth) best = {&temperature, columns, gain};
      }
    }
    const auto& columns = best.temperature->columns;
    return Part{
        .effect = name(),
        .columns = {columns.begin(), columns.begin() + static_cast<std::ptrdiff_t>(best.columns)},
        .shape = {best.temperature->lag_s, mean_of(temperature_of(scan.data()))}};
  }
};

/// A bias that follows the rate of change of the temperature, as stress in the package does. Its
/// column is the rate of the temperature behind a first-order lag, in K/s; the part's shape: that
/// lag in s.
class TemperatureRate final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "temperature_rate"; }
  [[nodiscard]] Pace pace() const override { return Pace::slow; }
  [[nodiscard]] bool has_measured_cause() const override { return true; }

  [[nodiscard]] std::string_view obstacle(const Hypothesis& without) const override {
    return obstacle_of_temperature(without.data());
  }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const double coefficient = fitted.amplitude(0) * kDegPerRad;
    const double lag = fitted.part().shape[0];
    return {
        .parameters = {parameter("coefficient_deg_per_k", coefficient,
                                 fitted.amplitude_error(0) * kDegPerRad),
                       {"lag_s", lag, lag / kLagGrid, lag * kLagGrid}},
        .sentence = fmt::format("The bias follows the change of the temperature, by {:.3g} deg/s "
                                "for each K/min, {} s behind.",
                                coefficient / 60.0, units::in_figures(lag)),
        .drawing = drawing_of(fitted)};
  }

  /// The node has no state for it. A filter that is to follow takes it for Gauss-Markov noise with
  /// its standard deviation and correlation time.
  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    const FitData& data = fitted.hypothesis.data();
    const std::vector<double> rate = rates(data, fitted.part().shape[0]);
    const double rms = rms_about_mean(rate);
    const double amplitude = std::hypot(fitted.amplitude(0), fitted.amplitude_error(0));
    model.gauss_markov.push_back(
        {.sigma_rad_s = amplitude * rms,
         .time_constant_s = data.period_s() * static_cast<double>(correlation(rate, rms))});
  }

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    return timed_mean_candidate(
        without, [this](const ColumnSearch& scan) { return search(scan); },
        shortest_lag_s(without.data()), longest_lag_s(without.data()));
  }

  /// A thermometer's own noise would make the rate of shorter lags.
  static double shortest_lag_s(const FitData& data) {
    return std::max(2.0 * data.period_s(), 1e-3 * data.span_s());
  }

  static std::vector<double> rates(const FitData& data, double lag_s) {
    const std::vector<double> temperature = temperature_of(data);
    std::vector<double> rate = lagged(temperature, data.period_s(), lag_s);
    for (std::size_t k = 0; k < rate.size(); ++k) rate[k] = (temperature[k] - rate[k]) / lag_s;
    return rate;
  }
  /// Number of values after which the autocorrelation has fallen below 1/e.
  static std::size_t correlation(const std::vector<double>& values, double rms) {
    const double mean = mean_of(values);
    const double limit = rms * rms * std::exp(-1.0);
    std::size_t step = 1;
    for (; step < values.size() / 2; step += 1 + step / 8) {
      double products = 0.0;
      for (std::size_t k = step; k < values.size(); ++k) {
        products += (values[k] - mean) * (values[k - step] - mean);
      }
      if (products < limit * static_cast<double>(values.size() - step)) break;
    }
    return step;
  }

  /// The rate behind a lag is what the temperature has gone ahead of the one behind it, over the
  /// lag.
  [[nodiscard]] Part part_of(const LaggedTemperature& behind, const Column& temperature) const {
    Column rate = temperature;
    for (std::size_t k = 0; k < rate.coefficients.size(); ++k) {
      rate.coefficients[k] -= behind.columns.front().coefficients[k];
      rate.coefficients[k] /= behind.lag_s;
    }
    return {.effect = name(), .columns = {std::move(rate)}, .shape = {behind.lag_s}};
  }

  [[nodiscard]] std::optional<Part> search(const ColumnSearch& scan) const {
    const std::vector<LaggedTemperature>& temperatures = lagged_temperatures(scan.data());
    const Column& temperature = temperatures.front().columns.front();
    std::optional<Part> best;
    double best_gain = 0.0;
    for (const LaggedTemperature& behind : temperatures) {
      if (behind.lag_s < shortest_lag_s(scan.data())) continue;
      Part part = part_of(behind, temperature);
      const double gain = scan.gain(part.columns);
      if (gain <= best_gain) continue;
      best = std::move(part);
      best_gain = gain;
    }
    return best;
  }
};

}  // namespace

std::unique_ptr<Effect> make_temperature_drift() {
  return std::make_unique<TemperatureDrift>();
}

std::unique_ptr<Effect> make_temperature_rate() {
  return std::make_unique<TemperatureRate>();
}

}  // namespace zerorate::diagnose
