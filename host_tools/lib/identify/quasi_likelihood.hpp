/// @file
/// From the model that a filter likes best to the noise that made the record.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/identify/innovations_likelihood.hpp"

namespace zerorate::identify {

/// Density per tick of a model as the node's filter holds it, (rad/s)^2 per (cycle/tick): lags, a
/// random walk and white noise, sampled once a tick.
/// @param cycles_per_tick frequency in (0, 1/2]
[[nodiscard]] double filter_density(const model::SensorModel& model, double tick_s,
                                    double cycles_per_tick);

/// Density per tick of the mean over a tick of the noise itself, sampled `samples` times: white
/// noise, 1/f^(2d) noise and a random walk.
[[nodiscard]] double noise_density(const model::SensorModel& model, double tick_s, int samples,
                                   double cycles_per_tick);

/// Ticks of a record.
struct TickSampling {
  double tick_s;
  int samples;   ///< in a tick
  double ticks;  ///< their number

  /// @param ticks of all records together, where there are several
  [[nodiscard]] static TickSampling of(const InnovationsLikelihood& likelihood, double ticks);
};

/// Parameters with their covariance.
struct FittedParameters {
  Eigen::VectorXd at;
  Eigen::MatrixXd covariance;
};

/// The parameters of the noise under which a filter's likelihood is expected to be greatest where
/// it is, and their covariance.
///
/// A filter with a lag a decade, which takes a tick for an instant, only comes near the noise. The
/// parameters of greatest likelihood are then biased, by more than their standard error where 1/f
/// noise is as strong as white noise at the tick (quasi-likelihood). With S the density of the
/// filter at its greatest likelihood and S0(p) that of the noise, the expected derivative of
/// Whittle's likelihood is zero at
///
///     sum over f of  d log S / d p  (S0(p) / S - 1) = 0
///
/// (White 1982; Whittle 1953). The sum goes over the Fourier frequencies of the record.
/// Cost: some hundred thousand powers.
/// @param model_at model of the parameters
/// @param longest steps of the parameters where the record has no information
[[nodiscard]] FittedParameters noise_of_filter_fit(
    const std::function<model::SensorModel(const Eigen::VectorXd&)>& model_at,
    const FittedParameters& of_filter, const TickSampling& sampling,
    const Eigen::VectorXd& longest);

}  // namespace zerorate::identify
