/// @file
/// White and flicker noise of a recording at their greatest likelihood through the node's filter.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/identify/innovations_likelihood.hpp"

namespace zerorate::identify {

/// A number, its standard error and its 95 % interval; the interval lies inside the range of what
/// is possible and is therefore not symmetric.
struct IntervalEstimate {
  double value = 0.0;
  double standard_error = 0.0;
  double lo = 0.0;
  double hi = 0.0;

  /// exp(x) for an x of this standard error.
  [[nodiscard]] static IntervalEstimate of_logarithm(double x, double standard_error);
};

/// Where the order of a fit comes from.
enum class OrderSource {
  given,      ///< given by the caller
  estimated,  ///< from the record
  prior,      ///< d = 1/2, because the record cannot tell it
  limit,      ///< the record asks for more than 0.95: it drifts like a random walk, or faster
};

struct FittedFlicker {
  IntervalEstimate bias_instability_rad_s;  ///< B
  IntervalEstimate order;                   ///< standard error 0 unless estimated
  OrderSource order_source = OrderSource::given;
  /// Estimate of d from the record itself, where it was too uncertain to be used.
  std::optional<IntervalEstimate> rejected_order;
};

struct InnovationsFit {
  IntervalEstimate angle_random_walk_rad_per_sqrt_s;  ///< N
  /// Nothing where the record does not show flicker noise at the 1 % level.
  std::optional<FittedFlicker> flicker;
  double likelihood_ratio = 0.0;  ///< 2 log of likelihood with flicker noise over without
  double p_value = 1.0;           ///< probability of a ratio this large under white noise alone
  double minus_two_log_likelihood = 0.0;
  /// N and B with d = 1/2; nothing without flicker noise, or where the order was given.
  struct OfPrior {
    double angle_random_walk_rad_per_sqrt_s;
    double bias_instability_rad_s;
  };
  std::optional<OfPrior> of_prior;

  /// White and 1/f noise (d = 1/2), which N and B of a data sheet stand for, without errors; this
  /// fit where there is no other of that order.
  [[nodiscard]] InnovationsFit data_sheet() const;
  /// Model that the node runs; its name and sources are left to the caller.
  [[nodiscard]] model::SensorModel model(double shortest_time_constant_s) const;
};

/// A rough idea of the noise to begin with.
struct StartValues {
  double angle_random_walk_rad_per_sqrt_s = 0.0;
  double bias_instability_rad_s = 0.0;  ///< B at this order
  double order = 0.5;
};

/// Subject of the parameters of a fit.
enum class FitOf {
  filter,  ///< the node's filter, which is likeliest with them
  noise    ///< the noise that the filter comes near, see noise_of_filter_fit()
};

struct InnovationsFitOptions {
  /// At least one. A fit of a given order begins with the first, that of a free order with the
  /// likeliest.
  std::vector<StartValues> starts;
  /// d in [0.05, 0.95] where it is known; estimated otherwise.
  std::optional<double> order{};
  double shortest_time_constant_s = 0.5;  ///< shortest of the decades, see model::Flicker
  double significance = 0.01;             ///< level of the test for flicker noise
  FitOf of = FitOf::filter;
};

/// Maximises the likelihood over log N, the log of the flicker noise at a pivot frequency and, if
/// the order is not given, d, by BOBYQA (Powell 2009) along steps in which they are expected to be
/// independent (Whittle 1953). The pivot is the corner of white and flicker noise, where the record
/// says most of the flicker noise. Standard errors are those of the observed information: central
/// second differences over about half a standard error, which is far above the roughness of single
/// precision. The order's are those of its logit, so that its interval keeps to the range; B's
/// follows by the delta method.
///
/// Flicker noise counts as present if it raises the likelihood significantly at the given order, or
/// at d = 1/2. The strength 0 lies at the edge of its range, so the p-value is half that of chi
/// squared with one degree of freedom (Self and Liang 1987).
///
/// A free order is kept if its interval is no wider than kWidestOrderInterval, or if the likelihood
/// ratio contradicts the prior d = 1/2 at the 1 % level; else the fit is that of the prior. Where
/// the free fit does not know N within a half, the ratio must be 25.
///
/// Cost: some 60 passes of the filter. Throws recording::DataError for fewer than 64 ticks and a
/// constant record, std::invalid_argument for an order outside [0.05, 0.95] and start values that
/// are missing or out of range.
[[nodiscard]] InnovationsFit fit_by_innovations(const InnovationsLikelihood& likelihood,
                                                const InnovationsFitOptions& options);

/// One parameter set for several recordings of a sensor: their likelihoods multiply.
/// @param likelihoods  at least one
[[nodiscard]] InnovationsFit fit_by_innovations(std::span<const InnovationsLikelihood> likelihoods,
                                                const InnovationsFitOptions& options);

/// N, B and K as the field writes them (IEEE Std 952): white noise, 1/f noise and a random walk of
/// the rate, fitted together.
struct NoiseCoefficients {
  IntervalEstimate angle_random_walk_rad_per_sqrt_s;  ///< N
  /// B and K; nothing where the record does not show that noise beside the others at the 1 % level.
  std::optional<IntervalEstimate> bias_instability_rad_s;
  std::optional<IntervalEstimate> rate_random_walk_rad_s_per_sqrt_s;
  /// N and K of white noise and a random walk alone, for a filter that knows nothing else; nothing
  /// where the record shows white noise only.
  struct WithoutFlicker {
    IntervalEstimate angle_random_walk_rad_per_sqrt_s;
    IntervalEstimate rate_random_walk_rad_s_per_sqrt_s;
  };
  std::optional<WithoutFlicker> without_flicker;
};

/// Maximises the likelihood over the logs of N, B and K, with both slow noises and with each of
/// them alone; keeps both where each raises the likelihood significantly, else the likelier one.
/// They describe the noise, FitOf::noise, but for those without flicker noise: these are a
/// filter's. Cost: some 110 passes of the filter; none where `base` has no flicker noise.
/// @param base fit of the same record, with which the search begins
[[nodiscard]] NoiseCoefficients fit_coefficients(const InnovationsLikelihood& likelihood,
                                                 const InnovationsFit& base,
                                                 double shortest_time_constant_s);

/// p-value of a likelihood ratio of a strength that may be 0, the edge of its range: half of chi
/// squared with one degree of freedom (Self and Liang 1987).
[[nodiscard]] double p_value_at_edge(double likelihood_ratio);

/// Width of the 95 % interval of d up to which an estimate is used: sensors differ in d by about
/// this much, so that a less certain one is worth no more than the prior.
inline constexpr double kWidestOrderInterval = 0.3;

}  // namespace zerorate::identify
