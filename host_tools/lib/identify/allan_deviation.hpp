/// @file
/// The overlapping Allan deviation of a rate, with intervals.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace zerorate::identify {

/// The power law of a rate's density, S(nu) ~ nu^alpha, that an Allan deviation is read with.
enum class PowerLaw {
  angle_white,       ///< alpha = 2: quantization of the angle (white PM)
  angle_flicker,     ///< alpha = 1 (flicker PM)
  rate_white,        ///< alpha = 0: angle random walk (white FM)
  rate_flicker,      ///< alpha = -1: bias instability (flicker FM)
  rate_random_walk,  ///< alpha = -2 (random walk FM)
};

struct AllanPoint {
  double tau_s;
  double adev;  ///< unit of the rate
  double lo;    ///< two-sided interval of the asked coverage
  double hi;
  double edf;      ///< equivalent degrees of freedom
  PowerLaw noise;  ///< the law that edf was computed for
};

struct AllanOptions {
  double points_per_decade = 16.0;
  double coverage = 0.95;
};

/// Averaging factors m on a logarithmic grid from 1 to a third of the record, without repetition.
[[nodiscard]] std::vector<std::size_t> averaging_factors(std::size_t samples,
                                                         double points_per_decade);

/// sigma^2(m T) = sum_{k=0}^{N-2m} (a_{k+2m} - 2 a_{k+m} + a_k)^2 / (2 m^2 (N - 2m + 1)) for each
/// m, a the running sum of the N rates (NIST SP 1065, eq. 11; IEEE Std 952, annex C). The sums are
/// compensated and taken about the mean rate: relative error below 1e-12 at 10^7 samples.
/// Time O(N) a factor, in tiles that stay in the cache; memory N doubles.
/// @param rate any unit, evenly spaced, complete: fill or cut gaps first
/// @param factors each in [1, N/2]; throws std::invalid_argument otherwise
[[nodiscard]] std::vector<double> allan_variances(std::span<const double> rate,
                                                  std::span<const std::size_t> factors);

/// Equivalent degrees of freedom of the overlapping Allan variance (NIST SP 1065, table 5; Howe,
/// Allan and Barnes 1981).
/// @param phases number of angles, one more than rates  @param factor averaging factor m
[[nodiscard]] double equivalent_degrees_of_freedom(PowerLaw noise, std::size_t phases,
                                                   std::size_t factor);

/// The power law of evenly spaced averages by their lag-1 autocorrelation (Riley and Greenhall
/// 2004; NIST SP 1065, section 5.5.6). The error of alpha, before it is rounded, is about 2 /
/// sqrt(averages).
[[nodiscard]] PowerLaw identify_power_law(std::span<const double> averages);

/// The whole curve. At each tau the power law is identified from the averages; where fewer than 100
/// are left, the law of the next shorter tau holds on.
/// @param rate as in allan_variances, at least 8 samples; throws recording::DataError otherwise
[[nodiscard]] std::vector<AllanPoint> allan_deviation(std::span<const double> rate,
                                                      double sample_period_s,
                                                      const AllanOptions& options = {});

/// A number with its standard error.
struct Estimate {
  double value;
  double standard_error;
};

}  // namespace zerorate::identify
