#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_tools/lib/identify/innovations_fit.hpp"
#include "host_tools/lib/identify/minimise.hpp"
#include "host_tools/lib/identify/quasi_likelihood.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

constexpr double kSignificance = 0.01;  ///< significance of a slow noise beside the other
constexpr double kOneOverF = 0.5;       ///< order of the noise that B is the strength of

/// Steps of log N, log B and log K, where a record has no information.
const Eigen::Vector3d kLongestSteps{0.08, 0.8, 0.8};

/// Slow noises that stand beside the white noise.
enum class SlowNoise { flicker, walk, both };

/// The maximum over theta = (log N, log B, log K), of which one of the slow noises may be missing.
struct CoefficientMaximum {
  SlowNoise slow;
  Eigen::VectorXd theta;
  Eigen::MatrixXd covariance;
  double minus_two_log;

  [[nodiscard]] IntervalEstimate at(Eigen::Index i) const {
    return IntervalEstimate::of_logarithm(theta(i), std::sqrt(covariance(i, i)));
  }
  [[nodiscard]] IntervalEstimate white() const { return at(0); }
  [[nodiscard]] std::optional<IntervalEstimate> flicker() const {
    return slow == SlowNoise::walk ? std::nullopt : std::optional{at(1)};
  }
  [[nodiscard]] std::optional<IntervalEstimate> walk() const {
    return slow == SlowNoise::flicker ? std::nullopt : std::optional{at(theta.size() - 1)};
  }
};

/// Logarithms of N, B and K that make noise as strong as a fit's where the recording determines it
/// best: B at the corner of white and flicker noise, K a decade below it.
struct StartLogarithms {
  double white;
  double flicker;
  double walk;

  StartLogarithms(const InnovationsFit& base, const InnovationsLikelihood& likelihood) {
    const double tick_s = units::seconds(likelihood.tick().ns());
    const double slowest =
        2.0 * std::numbers::pi / (tick_s * static_cast<double>(likelihood.ticks()));
    const double order = base.flicker->order.value;
    white = std::log(base.angle_random_walk_rad_per_sqrt_s.value);
    const double strength = std::log(base.flicker->bias_instability_rad_s.value);
    const double corner =
        std::clamp(std::exp((strength - white) / order), 2.0 * slowest, std::numbers::pi / tick_s);
    const double below = std::max(0.1 * corner, slowest);
    flicker = strength + (kOneOverF - order) * std::log(corner);
    walk = strength + (1.0 - order) * std::log(below);
  }
};

CoefficientMaximum fit_slow_noise(const InnovationsLikelihood& likelihood,
                                  const StartLogarithms& start, SlowNoise slow,
                                  double shortest_time_constant_s) {
  const bool has_flicker = slow != SlowNoise::walk;
  const bool has_walk = slow != SlowNoise::flicker;
  const auto model_at = [&](const Eigen::VectorXd& theta) {
    model::SensorModel model{.name = "fit"};
    model.white.angle_random_walk_rad_per_sqrt_s = std::exp(theta(0));
    if (has_flicker) {
      model.flicker = model::Flicker{.bias_instability_rad_s = std::exp(theta(1)),
                                     .order = kOneOverF,
                                     .shortest_time_constant_s = shortest_time_constant_s};
    }
    if (has_walk) {
      model.rate_random_walk =
          model::RateRandomWalk{.coefficient_rad_s_per_sqrt_s = std::exp(theta(theta.size() - 1))};
    }
    return model;
  };
  Eigen::VectorXd theta(has_flicker && has_walk ? 3 : 2);
  theta(0) = start.white;
  if (has_flicker) theta(1) = start.flicker;
  if (has_walk) theta(theta.size() - 1) = start.walk;
  const auto steps_at = [&](const Eigen::VectorXd& at) {
    const auto slopes = [&](double angular_frequency) {
      Eigen::VectorXd slope = (2.0 * at).array().exp();
      if (has_flicker) slope(1) /= angular_frequency;
      if (has_walk) slope(at.size() - 1) /= angular_frequency * angular_frequency;
      return Eigen::VectorXd(2.0 * slope / slope.sum());
    };
    const Sampling ticks{units::seconds(likelihood.tick().ns()),
                         static_cast<double>(likelihood.ticks())};
    return independent_steps(slopes, ticks, kLongestSteps.head(at.size()));
  };
  constexpr double kFarthest = 7.0;  // a factor of e^7
  const Objective objective = [&](const Eigen::VectorXd& x) {
    return likelihood(model_at(x)).minus_two_log();
  };
  const Minimum minimum = minimise(objective, theta, steps_at(theta), theta.array() - kFarthest,
                                   theta.array() + kFarthest);
  const FittedParameters of_filter{minimum.at,
                                   covariance(objective, minimum, steps_at(minimum.at))};
  const FittedParameters of_noise = noise_of_filter_fit(
      model_at, of_filter, TickSampling::of(likelihood, static_cast<double>(likelihood.ticks())),
      kLongestSteps.head(theta.size()));
  return {slow, of_noise.at, of_noise.covariance, minimum.value};
}

}  // namespace

NoiseCoefficients fit_coefficients(const InnovationsLikelihood& likelihood,
                                   const InnovationsFit& base, double shortest_time_constant_s) {
  NoiseCoefficients result{.angle_random_walk_rad_per_sqrt_s =
                               base.angle_random_walk_rad_per_sqrt_s};
  if (!base.flicker) return result;
  const StartLogarithms start(base, likelihood);
  const auto fit = [&](SlowNoise slow) {
    return fit_slow_noise(likelihood, start, slow, shortest_time_constant_s);
  };
  const CoefficientMaximum flicker = fit(SlowNoise::flicker);
  const CoefficientMaximum walk = fit(SlowNoise::walk);
  const CoefficientMaximum both = fit(SlowNoise::both);
  const CoefficientMaximum& alone = flicker.minus_two_log <= walk.minus_two_log ? flicker : walk;
  const double ratio = alone.minus_two_log - both.minus_two_log;
  const CoefficientMaximum& chosen = p_value_at_edge(ratio) <= kSignificance ? both : alone;
  result.angle_random_walk_rad_per_sqrt_s = chosen.white();
  result.bias_instability_rad_s = chosen.flicker();
  result.rate_random_walk_rad_s_per_sqrt_s = chosen.walk();
  result.without_flicker = {walk.white(), *walk.walk()};
  return result;
}

}  // namespace zerorate::identify
