#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/effects/mean_effect.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"
#include "host_tools/lib/statistics/search_significance.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kLeastSpread = 0.02;     // K, rms
constexpr double kWorthAParameter = 5.0;  // nats

/// A bias that follows the temperature: linear or with a square, at once or with a lag. The part's
/// shape: the lag in s (0: none) and the temperature that the columns are zero at.
class TemperatureDrift final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "temperature_drift"; }
  [[nodiscard]] bool is_measured() const override { return true; }

  [[nodiscard]] std::optional<Offer> examine(const Explanation& without) const override {
    if (!has_spread(without.problem())) return std::nullopt;
    std::optional<Offer> offer =
        offer_of_mean(without, [this](const MeanScan& scan) { return search(scan); });
    const double lags = offer->part.shape[0] > 0.0 ? 3.0 : 0.0;
    offer->surprise_nats = statistics::surprise_of_search(
        offer->gain_nats, static_cast<double>(offer->part.columns.size()), lags);
    return offer;
  }

  [[nodiscard]] Account tell(const Found& found) const override {
    const double linear = found.amplitude(0) * kDegPerRad;
    Account account{.parameters = {parameter("linear_dps_per_k", linear,
                                             found.amplitude_error(0) * kDegPerRad)}};
    account.sentence =
        fmt::format("The bias follows the temperature by {:.3g} deg/s per K", linear);
    if (found.part().columns.size() > 1) {
      const double quadratic = found.amplitude(1) * kDegPerRad;
      account.parameters.push_back(
          parameter("quadratic_dps_per_k2", quadratic, found.amplitude_error(1) * kDegPerRad));
      account.sentence += fmt::format(", curved by {:.2g} deg/s per K^2", quadratic);
    }
    const double lag = found.part().shape[0];
    if (lag > 0.0) {
      account.parameters.push_back({"lag_s", lag, lag / kLagGrid, lag * kLagGrid});
      account.sentence += fmt::format(", {:.3g} s behind", lag);
    }
    const double reference = found.part().shape[1];
    account.parameters.push_back({"reference_degc", reference, reference, reference});
    account.sentence += ".";
    account.drawing = drawing_of(found);
    return account;
  }

  void extend(const Found& found, model::SensorModel& model) const override {
    model::TemperatureDrift drift{.reference_degc = found.part().shape[1],
                                  .slope_rad_s_per_k = found.amplitude(0),
                                  .slope_sigma_rad_s_per_k = found.amplitude_error(0),
                                  .lag_s = found.part().shape[0]};
    if (found.part().columns.size() > 1) {
      drift.curvature_rad_s_per_k2 = found.amplitude(1);
      drift.curvature_sigma_rad_s_per_k2 = found.amplitude_error(1);
    }
    model.temperature = drift;
  }

 private:
  static constexpr double kLagGrid = 1.6;

  static std::vector<double> temperature_of(const Problem& problem) {
    const auto& all = problem.series().temperature_degc;
    return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(problem.size())};
  }
  static double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  }
  static bool has_spread(const Problem& problem) {
    if (problem.series().temperature_degc.empty()) return false;
    const std::vector<double> temperature = temperature_of(problem);
    const double mean = mean_of(temperature);
    double squares = 0.0;
    for (const double t : temperature) squares += (t - mean) * (t - mean);
    return squares > kLeastSpread * kLeastSpread * static_cast<double>(temperature.size());
  }

  Part part_of(const Problem& problem, double lag_s, bool quadratic) const {
    const std::vector<double> temperature = temperature_of(problem);
    const double reference = mean_of(temperature);
    const double follow = lag_s > 0.0 ? -std::expm1(-problem.period_s() / lag_s) : 1.0;
    std::vector<double> excess(temperature.size());
    double element = temperature.front();
    for (std::size_t k = 0; k < excess.size(); ++k) {
      element += follow * (temperature[k] - element);
      excess[k] = element - reference;
    }
    Part part{.effect = name(),
              .columns = {column_of(problem, std::span<const double>(excess))},
              .shape = {lag_s, reference}};
    if (quadratic) {
      for (double& e : excess) e *= e;
      part.columns.push_back(column_of(problem, std::span<const double>(excess)));
    }
    return part;
  }

  [[nodiscard]] std::optional<Part> search(const MeanScan& scan) const {
    const Problem& problem = scan.problem();
    Part best = part_of(problem, 0.0, false);
    double best_gain = scan.gain(best.columns);
    const auto take_if_worth = [&](Part part, double worth) {
      const double gain = scan.gain(part.columns);
      if (gain <= best_gain + worth) return;
      best = std::move(part);
      best_gain = gain;
    };
    take_if_worth(part_of(problem, 0.0, true), kWorthAParameter);
    double worth = kWorthAParameter;
    for (double lag = 0.25 * problem.span_s(); lag > 2.0 * problem.period_s(); lag /= kLagGrid) {
      for (const bool quadratic : {false, true}) {
        const bool more = quadratic && best.columns.size() == 1;
        const bool less = !quadratic && best.columns.size() == 2;
        const double change = more ? kWorthAParameter : less ? -kWorthAParameter : 0.0;
        take_if_worth(part_of(problem, lag, quadratic), worth + change);
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
