#include "host_tools/lib/diagnose/drive/bias_process.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "firmware/model/flicker_fit.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

/// Standard deviation of the mean of the bias: so wide that it weighs nothing.
constexpr double kMeanSigma_rad_s = units::kRadPerDeg;

/// Integral over both spans of a function of the distance of two times.
/// @param antiderivative the second one, and even
template <class Function>
double integral_over(const Span& one, const Span& other, const Function& antiderivative) {
  return antiderivative(one.to_s - other.from_s) + antiderivative(one.from_s - other.to_s) -
         antiderivative(one.to_s - other.to_s) - antiderivative(one.from_s - other.from_s);
}

Eigen::MatrixXd covariances(const BiasProcess& process, const std::vector<Span>& rows,
                            const std::vector<Span>& columns) {
  Eigen::MatrixXd all(static_cast<Eigen::Index>(rows.size()),
                      static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      all(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          process.covariance(rows[i], columns[k]);
    }
  }
  return all;
}

}  // namespace

BiasProcess::BiasProcess(const model::SensorModel& model)
    : white_rad2_s_(std::pow(model.white.angle_random_walk_rad_per_sqrt_s, 2)) {
  if (model.flicker) {
    const double tick_s = model.flicker->shortest_time_constant_s;
    const model::FlickerFit fit = model::fit_flicker(*model.flicker, tick_s);
    white_rad2_s_ += fit.white_variance_rad2_s2 * tick_s;
    for (std::size_t i = 0; i < fit.time_constants_s.size(); ++i)
      lags_.push_back({fit.time_constants_s[i], fit.variances_rad2_s2[i]});
  }
  for (const model::GaussMarkov& lag : model.gauss_markov)
    lags_.push_back({lag.time_constant_s, std::pow(lag.sigma_rad_s, 2)});
  if (model.rate_random_walk)
    walk_rad2_s3_ = std::pow(model.rate_random_walk->coefficient_rad_s_per_sqrt_s, 2);
}

double BiasProcess::covariance(const Span& one, const Span& other) const {
  const double area = one.length_s() * other.length_s();
  double sum = kMeanSigma_rad_s * kMeanSigma_rad_s * area;
  if (one.from_s == other.from_s) sum += white_rad2_s_ * one.length_s();
  for (const Lag& lag : lags_) {
    const double tau = lag.time_constant_s;
    sum += lag.variance_rad2_s2 * integral_over(one, other, [tau](double distance_s) {
             const double x = std::abs(distance_s) / tau;
             return tau * tau * (x + std::expm1(-x));
           });
  }
  if (walk_rad2_s3_ > 0.0) {
    // The walk begins at 0, with the recording: its covariance is the earlier time.
    const double middles_s = 0.5 * (one.from_s + one.to_s + other.from_s + other.to_s);
    const double distances = integral_over(
        one, other, [](double distance_s) { return std::pow(std::abs(distance_s), 3) / 6.0; });
    sum += 0.5 * walk_rad2_s3_ * (middles_s * area - distances);
  }
  return sum;
}

BiasForecast forecast_bias(const BiasProcess& process, const std::vector<Span>& rests,
                           const std::vector<Span>& drives) {
  const Eigen::MatrixXd at_rest = covariances(process, rests, rests);
  const Eigen::MatrixXd across = covariances(process, rests, drives);
  BiasForecast forecast;
  forecast.weights = at_rest.ldlt().solve(across).transpose();
  forecast.covariance = covariances(process, drives, drives) - forecast.weights * across;
  forecast.covariance = 0.5 * (forecast.covariance + forecast.covariance.transpose().eval());
  return forecast;
}

}  // namespace zerorate::diagnose
