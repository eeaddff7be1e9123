#include "host_tools/lib/identify/innovations_likelihood.hpp"

#include "core/estimator/kalman_predictor.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::identify {
namespace {

constexpr core::ModelShape kLargestWithoutTemperature{.decaying = model::kLargestShape.decaying,
                                                      .rotating = model::kLargestShape.rotating};

}  // namespace

InnovationsLikelihood::InnovationsLikelihood(std::span<const TickMean> ticks, std::size_t axis,
                                             core::Duration sample_period, core::Duration tick)
    : sample_period_(sample_period), tick_(tick) {
  if (ticks.size() < 2) throw recording::DataError("a likelihood needs at least two ticks");
  measurements_.reserve(ticks.size());
  std::uint32_t measured_ticks = 0;
  for (const TickMean& mean : ticks) {
    measurements_.push_back(
        {mean.tick + 1 - measured_ticks, static_cast<float>(mean.samples), mean.rate_rad_s[axis]});
    measured_ticks = mean.tick + 1;
  }
}

template <core::ModelShape Shape>
Likelihood InnovationsLikelihood::run(const model::SensorModel& model) const {
  const auto node = model::make_node_model<Shape>(model, sample_period_, tick_);
  const auto one_tick = node.modes.one_tick();
  const core::KalmanCoefficients<Shape> coefficients{node.modes, node.gate};
  core::KalmanPredictor<Shape> filter{coefficients};
  Likelihood likelihood;
  statistics::SumOfLogs log_variances;
  for (const Measurement& measurement : measurements_) {
    const core::Innovation innovation =
        filter.step(measurement.ticks == 1 ? one_tick : node.modes.over(measurement.ticks),
                    measurement.rate_rad_s, node.measurement_variance(measurement.samples));
    if (innovation.first) continue;
    const double variance = double{innovation.variance_rad2_s2};
    const double residual = double{innovation.residual_rad_s};
    log_variances.add(variance);
    likelihood.squared_innovations += residual * residual / variance;
    ++likelihood.innovations;
  }
  likelihood.log_variances = log_variances.value();
  return likelihood;
}

Likelihood InnovationsLikelihood::operator()(const model::SensorModel& model) const {
  return model::with_shape_of<kLargestWithoutTemperature>(
      model, [&]<core::ModelShape Shape>() { return run<Shape>(model); });
}

}  // namespace zerorate::identify
