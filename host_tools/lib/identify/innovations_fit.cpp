#include "host_tools/lib/identify/innovations_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "host_tools/lib/identify/minimise.hpp"
#include "host_tools/lib/identify/quasi_likelihood.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/statistics/half_width.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

constexpr std::size_t kFewestTicks = 64;
constexpr double kPriorOrder = 0.5;
constexpr double kLowestOrder = 0.05;
constexpr double kHighestOrder = 0.95;
/// An estimate above it counts as one at the upper end.
constexpr double kOrderLimit = 0.94;
/// How far log N and log flicker may move from their start: a factor of e^7.
constexpr double kRoom = 7.0;
/// Distance from the ends of its range that a search for d keeps, so that the logit stays finite;
/// less than that of kOrderLimit.
constexpr double kEdge = 0.006;
/// Steps of log N and log flicker, where a record has no information.
constexpr double kLongestStep = 0.08;
constexpr double kLongestFlickerStep = 0.8;
/// Largest relative error of N in a fit whose order counts.
constexpr double kKnownWhite = 0.5;
/// 1 % point of chi squared with one degree of freedom, and five standard deviations.
constexpr double kContradiction = 6.634896601021213;
constexpr double kStrongContradiction = 25.0;

double order_of(double logit) {
  return kLowestOrder + (kHighestOrder - kLowestOrder) / (1.0 + std::exp(-logit));
}
double logit_of(double order) {
  return std::log((order - kLowestOrder) / (kHighestOrder - order));
}
/// Change of d with its logit.
double order_slope(double order) {
  return (order - kLowestOrder) * (kHighestOrder - order) / (kHighestOrder - kLowestOrder);
}

/// Between the parameters that are fitted, theta = (log N, log flicker at the pivot, d), and the
/// model. Without a third one the order is as given.
struct Parameters {
  double pivot_rad_per_s;
  double order;
  double shortest_time_constant_s;

  [[nodiscard]] double order_at(const Eigen::VectorXd& theta) const {
    return theta.size() > 2 ? theta(2) : order;
  }
  /// S(omega) = B^2 omega^(-2d), so log B = log sqrt(S(pivot)) + d log(pivot).
  [[nodiscard]] double log_bias_instability(const Eigen::VectorXd& theta) const {
    return theta(1) + order_at(theta) * std::log(pivot_rad_per_s);
  }
  [[nodiscard]] model::SensorModel model(const Eigen::VectorXd& theta) const {
    model::SensorModel model{.name = "fit"};
    model.white.angle_random_walk_rad_per_sqrt_s = std::exp(theta(0));
    model.flicker = model::Flicker{.bias_instability_rad_s = std::exp(log_bias_instability(theta)),
                                   .order = order_at(theta),
                                   .shortest_time_constant_s = shortest_time_constant_s};
    return model;
  }
};

/// Parameters with a function of the order in its place, if it is one of them.
Eigen::VectorXd with_order(Eigen::VectorXd theta, double (*function)(double)) {
  if (theta.size() > 2) theta(2) = function(theta(2));
  return theta;
}

IntervalEstimate known(double value) {
  return {value, 0.0, value, value};
}

IntervalEstimate order_from(double order, double error_of_logit) {
  const double logit = logit_of(order);
  return {order, order_slope(order) * error_of_logit,
          order_of(logit - statistics::kHalfWidth95 * error_of_logit),
          order_of(logit + statistics::kHalfWidth95 * error_of_logit)};
}

/// White noise and flicker noise, as they are fitted.
struct Place {
  Parameters parameters;
  Eigen::VectorXd theta;
};

/// Highest likelihood over white noise and flicker noise.
struct Peak : Place {
  double minus_two_log;
};

/// Peak with the covariance of its parameters, the order by its logit: an interval of the order
/// ends within its range.
struct Maximum : Peak {
  Eigen::MatrixXd covariance;

  [[nodiscard]] double error(Eigen::Index i) const { return std::sqrt(covariance(i, i)); }
  [[nodiscard]] IntervalEstimate bias_instability() const {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(theta.size());
    gradient(1) = 1.0;
    if (theta.size() > 2) {
      gradient(2) = order_slope(theta(2)) * std::log(parameters.pivot_rad_per_s);
    }
    return IntervalEstimate::of_logarithm(parameters.log_bias_instability(theta),
                                          std::sqrt(gradient.dot(covariance * gradient)));
  }
  [[nodiscard]] IntervalEstimate order() const {
    return theta.size() > 2 ? order_from(theta(2), error(2)) : known(parameters.order);
  }
};

/// Fits of one record, or of several together.
class Fitter {
 public:
  Fitter(std::span<const InnovationsLikelihood> likelihoods, const InnovationsFitOptions& options)
      : likelihoods_(likelihoods), options_(options) {}

  /// White noise alone: its strength scales every variance, so one pass gives the maximum.
  [[nodiscard]] InnovationsFit white_alone() const {
    model::SensorModel model{.name = "white"};
    model.white.angle_random_walk_rad_per_sqrt_s =
        options_.starts.front().angle_random_walk_rad_per_sqrt_s;
    const Likelihood at_start = likelihood(model);
    const auto count = static_cast<double>(at_start.innovations);
    const double excess = at_start.squared_innovations / count;
    if (!(excess > 0.0) || !std::isfinite(excess)) {
      throw recording::DataError("the record is constant: there is no noise to identify");
    }
    InnovationsFit fit;
    fit.angle_random_walk_rad_per_sqrt_s = IntervalEstimate::of_logarithm(
        std::log(model.white.angle_random_walk_rad_per_sqrt_s) + 0.5 * std::log(excess),
        std::sqrt(0.5 / count));
    fit.minus_two_log_likelihood = at_start.log_variances + count * (std::log(excess) + 1.0);
    return fit;
  }

  /// White and flicker noise of this order.
  [[nodiscard]] Peak peak(double order) const {
    return climb(at(options_.starts.front(), order, false));
  }

  /// White and flicker noise of this order, from a place of another.
  [[nodiscard]] Peak peak_from(const Place& place, double order) const {
    Place start{place.parameters, place.theta.head(2)};
    start.parameters.order = order;
    return climb(start);
  }

  /// White and flicker noise of any order, from the likeliest start.
  [[nodiscard]] Peak peak_of_free_order() const {
    std::vector<Place> starts;
    for (const StartValues& start : options_.starts) starts.push_back(at(start, start.order, true));
    const auto minus_two_log = [&](const Place& place) {
      return objective(place.parameters)(place.theta);
    };
    return climb(*std::ranges::min_element(starts, {}, minus_two_log));
  }

  /// Some dozen passes: for the peak that is wanted alone.
  [[nodiscard]] Maximum with_errors(const Peak& peak) const {
    const Objective function = objective(peak.parameters);
    Eigen::MatrixXd steps = steps_at(peak);
    if (peak.theta.size() > 2) steps.row(2) /= order_slope(peak.theta(2));
    return {peak,
            covariance([&](const auto& theta) { return function(with_order(theta, order_of)); },
                       {with_order(peak.theta, logit_of), peak.minus_two_log}, std::move(steps))};
  }

  /// The maximum for the filter or the noise, by the options.
  [[nodiscard]] Maximum as_asked(Maximum maximum) const {
    if (options_.of == FitOf::filter) return maximum;
    const auto model_at = [&](const Eigen::VectorXd& theta) {
      return maximum.parameters.model(with_order(theta, order_of));
    };
    const Eigen::Vector3d steps{kLongestStep, kLongestFlickerStep, 1.8};
    const FittedParameters noise =
        noise_of_filter_fit(model_at, {with_order(maximum.theta, logit_of), maximum.covariance},
                            TickSampling::of(longest(), ticks()), steps.head(maximum.theta.size()));
    maximum.theta = with_order(noise.at, order_of);
    maximum.covariance = noise.covariance;
    return maximum;
  }

 private:
  [[nodiscard]] Place at(const StartValues& start, double order, bool order_is_free) const {
    const double white = start.angle_random_walk_rad_per_sqrt_s;
    const double slowest =
        2.0 * std::numbers::pi / (tick_s() * static_cast<double>(longest().ticks()));
    // N^2 = B^2 omega^(-2d).
    const double corner = std::pow(start.bias_instability_rad_s / white, 1.0 / start.order);
    const Parameters parameters{
        .pivot_rad_per_s = std::clamp(corner, 2.0 * slowest, std::numbers::pi / tick_s()),
        .order = order,
        .shortest_time_constant_s = options_.shortest_time_constant_s};

    Eigen::VectorXd theta(order_is_free ? 3 : 2);
    theta(0) = std::log(white);
    theta(1) =
        std::log(start.bias_instability_rad_s) - start.order * std::log(parameters.pivot_rad_per_s);
    if (order_is_free) theta(2) = std::clamp(order, kLowestOrder + kEdge, kHighestOrder - kEdge);
    return {parameters, theta};
  }
  /// From far off the climb begins anew where it came to: its steps were not those of the summit.
  [[nodiscard]] Peak climb(const Place& start) const {
    constexpr double kFar = 10.0;  // steps
    constexpr int kMostClimbs = 4;
    Eigen::VectorXd lowest = start.theta.array() - kRoom;
    Eigen::VectorXd highest = start.theta.array() + kRoom;
    if (start.theta.size() > 2) {
      lowest(2) = kLowestOrder + kEdge;
      highest(2) = kHighestOrder - kEdge;
    }
    Peak peak{start, 0.0};
    for (int i = 0; i < kMostClimbs; ++i) {
      const Eigen::MatrixXd steps = steps_at(peak);
      const Minimum minimum =
          minimise(objective(peak.parameters), peak.theta, steps, lowest, highest);
      const Eigen::VectorXd walked =
          steps.triangularView<Eigen::Upper>().solve(minimum.at - peak.theta);
      peak.theta = minimum.at;
      peak.minus_two_log = minimum.value;
      if (walked.norm() < kFar) break;
    }
    return peak;
  }

  /// Independent steps of white noise, flicker noise and order.
  [[nodiscard]] Eigen::MatrixXd steps_at(const Place& at) const {
    const double white = std::exp(2.0 * at.theta(0));
    const Eigen::Index size = at.theta.size();
    const auto slopes = [&](double angular_frequency) -> Eigen::VectorXd {
      const double log_ratio = std::log(angular_frequency / at.parameters.pivot_rad_per_s);
      const double flicker =
          std::exp(2.0 * (at.theta(1) - at.parameters.order_at(at.theta) * log_ratio));
      return 2.0 / (white + flicker) *
             Eigen::Vector3d(white, flicker, -flicker * log_ratio).head(size);
    };
    return independent_steps(slopes, {tick_s(), ticks()},
                             Eigen::Vector3d(kLongestStep, kLongestFlickerStep, 0.4).head(size));
  }
  [[nodiscard]] Objective objective(const Parameters& parameters) const {
    return [this, parameters](const Eigen::VectorXd& theta) {
      return likelihood(parameters.model(theta)).minus_two_log();
    };
  }
  [[nodiscard]] double tick_s() const { return units::seconds(longest().tick().ns()); }
  [[nodiscard]] double ticks() const {
    double ticks = 0.0;
    for (const InnovationsLikelihood& one : likelihoods_) ticks += static_cast<double>(one.ticks());
    return ticks;
  }
  [[nodiscard]] const InnovationsLikelihood& longest() const {
    return *std::ranges::max_element(likelihoods_, {}, &InnovationsLikelihood::ticks);
  }
  /// Likelihood of all records.
  [[nodiscard]] Likelihood likelihood(const model::SensorModel& model) const {
    Likelihood sum;
    for (const InnovationsLikelihood& one : likelihoods_) {
      const Likelihood more = one(model);
      sum.log_variances += more.log_variances;
      sum.squared_innovations += more.squared_innovations;
      sum.innovations += more.innovations;
    }
    return sum;
  }

  std::span<const InnovationsLikelihood> likelihoods_;
  const InnovationsFitOptions& options_;
};

void require_usable(std::span<const InnovationsLikelihood> likelihoods,
                    const InnovationsFitOptions& options) {
  if (likelihoods.empty() || std::ranges::any_of(likelihoods, [](const auto& likelihood) {
        return likelihood.ticks() < kFewestTicks;
      })) {
    throw recording::DataError("too short to identify noise: fewer than 64 filter ticks at rest");
  }
  if (options.order && !(*options.order >= kLowestOrder && *options.order <= kHighestOrder)) {
    throw std::invalid_argument("the order of the flicker noise must lie between .05 and .95");
  }
  const bool usable = std::ranges::all_of(options.starts, [](const StartValues& start) {
    return start.angle_random_walk_rad_per_sqrt_s > 0.0 && start.bias_instability_rad_s > 0.0 &&
           start.order > kLowestOrder && start.order < kHighestOrder;
  });
  if (options.starts.empty() || !usable) {
    throw std::invalid_argument(
        "a fit needs start values: positive, and an order between .05 and .95");
  }
}

FittedFlicker flicker_of(const Maximum& maximum, OrderSource source) {
  return {maximum.bias_instability(), maximum.order(), source, std::nullopt};
}

/// Fit of the given order.
Maximum keep_order(const Fitter& fitter, const Peak& given, std::optional<FittedFlicker>& flicker) {
  Maximum maximum = fitter.as_asked(fitter.with_errors(given));
  flicker = flicker_of(maximum, OrderSource::given);
  return maximum;
}

/// Fit with the record's own order, if the record determines it; else the fit of the prior.
Maximum choose_order(const Fitter& fitter, const Peak& prior,
                     std::optional<FittedFlicker>& flicker) {
  const Peak free = fitter.peak_of_free_order();
  const double ratio = prior.minus_two_log - free.minus_two_log;
  const bool contradicts = ratio > kContradiction;
  if (contradicts && free.parameters.order_at(free.theta) > kOrderLimit) {
    Maximum at_limit = fitter.as_asked(fitter.with_errors(fitter.peak_from(free, kHighestOrder)));
    flicker = flicker_of(at_limit, OrderSource::limit);
    return at_limit;
  }
  Maximum with_order = fitter.as_asked(fitter.with_errors(free));
  const IntervalEstimate order = with_order.order();
  // Flicker noise of low order takes the place of white noise: then N is not known, and d seems so.
  const bool is_known = with_order.error(0) <= kKnownWhite;
  const bool is_kept = contradicts || order.hi - order.lo <= kWidestOrderInterval;
  if (is_known ? is_kept : ratio > kStrongContradiction) {
    flicker = flicker_of(with_order, OrderSource::estimated);
    return with_order;
  }
  Maximum of_prior = fitter.as_asked(fitter.with_errors(prior));
  flicker = flicker_of(of_prior, OrderSource::prior);
  flicker->rejected_order = order;
  return of_prior;
}

}  // namespace

IntervalEstimate IntervalEstimate::of_logarithm(double x, double standard_error) {
  const double value = std::exp(x);
  return {value, value * standard_error, std::exp(x - statistics::kHalfWidth95 * standard_error),
          std::exp(x + statistics::kHalfWidth95 * standard_error)};
}

double p_value_at_edge(double likelihood_ratio) {
  if (!(likelihood_ratio > 0.0)) return 1.0;
  return 0.5 * statistics::chi_squared_tail(likelihood_ratio, 1.0);
}

InnovationsFit InnovationsFit::data_sheet() const {
  if (!of_prior) return *this;
  InnovationsFit sheet;
  sheet.angle_random_walk_rad_per_sqrt_s = known(of_prior->angle_random_walk_rad_per_sqrt_s);
  sheet.flicker = FittedFlicker{known(of_prior->bias_instability_rad_s), known(kPriorOrder),
                                OrderSource::prior, std::nullopt};
  return sheet;
}

model::SensorModel InnovationsFit::model(double shortest_time_constant_s) const {
  model::SensorModel model;
  model.white.angle_random_walk_rad_per_sqrt_s = angle_random_walk_rad_per_sqrt_s.value;
  if (flicker) {
    model.flicker = model::Flicker{.bias_instability_rad_s = flicker->bias_instability_rad_s.value,
                                   .order = flicker->order.value,
                                   .shortest_time_constant_s = shortest_time_constant_s};
  }
  return model;
}

InnovationsFit fit_by_innovations(const InnovationsLikelihood& likelihood,
                                  const InnovationsFitOptions& options) {
  return fit_by_innovations(std::span(&likelihood, 1), options);
}

InnovationsFit fit_by_innovations(std::span<const InnovationsLikelihood> likelihoods,
                                  const InnovationsFitOptions& options) {
  require_usable(likelihoods, options);
  const Fitter fitter{likelihoods, options};
  InnovationsFit fit = fitter.white_alone();
  const Peak peak = fitter.peak(options.order.value_or(kPriorOrder));
  fit.likelihood_ratio = std::max(0.0, fit.minus_two_log_likelihood - peak.minus_two_log);
  fit.p_value = p_value_at_edge(fit.likelihood_ratio);
  if (fit.p_value > options.significance) return fit;
  if (!options.order) {
    const Maximum prior = fitter.as_asked({peak, Eigen::Matrix2d::Zero()});
    fit.of_prior = {std::exp(prior.theta(0)),
                    std::exp(prior.parameters.log_bias_instability(prior.theta))};
  }

  const Maximum best = (options.order ? keep_order : choose_order)(fitter, peak, fit.flicker);
  fit.angle_random_walk_rad_per_sqrt_s =
      IntervalEstimate::of_logarithm(best.theta(0), best.error(0));
  fit.minus_two_log_likelihood = best.minus_two_log;
  return fit;
}

}  // namespace zerorate::identify
