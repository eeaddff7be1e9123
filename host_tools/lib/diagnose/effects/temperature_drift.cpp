#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

constexpr double kLeastSpread = 0.02;     // K, rms
constexpr double kWorthAParameter = 5.0;  // nats

/// A bias that follows the temperature: linear or with a square, at once or with a lag. The part's
/// shape: the lag in s (0: none) and the temperature that the columns are zero at.
class TemperatureDrift final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "temperature_drift"; }
  [[nodiscard]] bool has_measured_cause() const override { return true; }

  [[nodiscard]] std::string_view obstacle(const Hypothesis& without) const override {
    if (without.data().series().temperature_degc.empty()) return "no temperature";
    return has_spread(without.data()) ? std::string_view{} : "the temperature hardly changes";
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
      description.sentence += fmt::format(", {:.3g} s behind", lag);
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

  static constexpr double kLagGrid = 1.6;

  static std::vector<double> temperature_of(const FitData& data) {
    const auto& all = data.series().temperature_degc;
    return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(data.size())};
  }
  static double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  }
  static bool has_spread(const FitData& data) {
    const std::vector<double> temperature = temperature_of(data);
    const double mean = mean_of(temperature);
    double squares = 0.0;
    for (const double t : temperature) squares += (t - mean) * (t - mean);
    return squares > kLeastSpread * kLeastSpread * static_cast<double>(temperature.size());
  }

  Part part_of(const FitData& data, double lag_s, bool quadratic) const {
    const std::vector<double> temperature = temperature_of(data);
    const double reference = mean_of(temperature);
    const double follow = lag_s > 0.0 ? -std::expm1(-data.period_s() / lag_s) : 1.0;
    std::vector<double> excess(temperature.size());
    double element = temperature.front();
    for (std::size_t k = 0; k < excess.size(); ++k) {
      element += follow * (temperature[k] - element);
      excess[k] = element - reference;
    }
    Part part{.effect = name(),
              .columns = {column_of(data, std::span<const double>(excess))},
              .shape = {lag_s, reference}};
    if (quadratic) {
      for (double& e : excess) e *= e;
      part.columns.push_back(column_of(data, std::span<const double>(excess)));
    }
    return part;
  }

  [[nodiscard]] std::optional<Part> search(const ColumnSearch& scan) const {
    const FitData& data = scan.data();
    Part best = part_of(data, 0.0, false);
    double best_gain = scan.gain(best.columns);
    const auto take_if_worth = [&](Part part, double worth) {
      const double gain = scan.gain(part.columns);
      if (gain <= best_gain + worth) return;
      best = std::move(part);
      best_gain = gain;
    };
    take_if_worth(part_of(data, 0.0, true), kWorthAParameter);
    double worth = kWorthAParameter;
    for (double lag = 0.25 * data.span_s(); lag > 2.0 * data.period_s(); lag /= kLagGrid) {
      for (const bool quadratic : {false, true}) {
        const bool more = quadratic && best.columns.size() == 1;
        const bool less = !quadratic && best.columns.size() == 2;
        const double change = more ? kWorthAParameter : less ? -kWorthAParameter : 0.0;
        take_if_worth(part_of(data, lag, quadratic), worth + change);
      }
      if (best.shape[0] > 0.0) worth = 0.0;
    }
    return best;
  }
};

}  // namespace

std::unique_ptr<Effect> make_temperature_drift() {
  return std::make_unique<TemperatureDrift>();
}

}  // namespace zerorate::diagnose
