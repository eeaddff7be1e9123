#include "host_tools/lib/diagnose/envelope.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/gamma.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numbers>
#include <span>

#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"
#include "host_tools/lib/identify/allan_deviation.hpp"
#include "host_tools/lib/parallel/parallel.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;
constexpr double kTausPerDecade = 6.0;
constexpr double kWorkPerHypothesis = 0.64e6;  // samples
constexpr std::size_t kFewestSimulations = 16;
constexpr std::size_t kMostSimulations = 64;
constexpr std::size_t kNarrowestBand = 6;  // coefficients

struct Band {
  double lo = 0.0;
  double middle = 0.0;
  double hi = 0.0;
};

/// Probability beyond one of two bounds that `rows` of them together keep with 95 %.
double tail_of_family(std::size_t rows) {
  return 0.025 / static_cast<double>(std::max<std::size_t>(1, rows));
}

/// Standard deviations to such a bound.
double quantile_of_family(std::size_t rows) {
  return random::normal_quantile(1.0 - tail_of_family(rows));
}

/// Standard deviations to such a bound for one value more, where so many values told the mean and
/// the standard deviation.
double quantile_of_family(std::size_t rows, double values) {
  const boost::math::students_t_distribution<> student(values - 1.0);
  return std::sqrt(1.0 + 1.0 / values) *
         boost::math::quantile(boost::math::complement(student, tail_of_family(rows)));
}

/// Allan deviations of simulations of a hypothesis, as a log-normal band at each factor.
class SimulatedAllan {
 public:
  SimulatedAllan(const Hypothesis& hypothesis, std::span<const std::size_t> factors,
                 std::size_t runs)
      : data_(&hypothesis.data()),
        mean_(mean_coefficients(hypothesis)),
        sigma_(hypothesis.density()),
        factors_(factors),
        log_deviations_(runs) {
    for (double& sigma : sigma_) sigma = std::sqrt(sigma);
  }

  /// One simulation, by independent normal numbers. Runs may be made at the same time.
  void make(std::size_t run, const std::vector<double>& normal) {
    std::vector<double> coefficients(normal.size());
    for (std::size_t k = 1; k < normal.size(); ++k) {
      coefficients[k] = mean_[k] + normal[k] * sigma_[k];
    }
    const std::vector<double> rate = data_->transform().inverse(coefficients);
    for (const double variance : identify::allan_variances(rate, factors_)) {
      log_deviations_[run].push_back(0.5 * std::log(std::max(variance, 1e-300)));
    }
  }

  [[nodiscard]] std::vector<Band> bands() const {
    const auto count = static_cast<double>(log_deviations_.size());
    const double z = quantile_of_family(factors_.size(), count);
    std::vector<Band> bands;
    bands.reserve(factors_.size());
    for (std::size_t i = 0; i < factors_.size(); ++i) {
      double sum = 0.0;
      double squares = 0.0;
      for (const std::vector<double>& run : log_deviations_) {
        sum += run[i];
        squares += run[i] * run[i];
      }
      const double middle = sum / count;
      const double spread =
          std::sqrt(std::max(0.0, (squares - count * middle * middle) / (count - 1.0)));
      bands.push_back(
          {std::exp(middle - z * spread), std::exp(middle), std::exp(middle + z * spread)});
    }
    return bands;
  }

 private:
  const FitData* data_;
  std::vector<double> mean_;
  std::vector<double> sigma_;
  std::span<const std::size_t> factors_;
  std::vector<std::vector<double>> log_deviations_;  ///< at each factor, of each run
};

/// Both hypotheses, which may be one, are simulated with the same random numbers.
std::vector<CurvePoint> allan_curve(const Hypothesis& base, const Hypothesis& extended) {
  const FitData& data = base.data();
  const auto factors = identify::averaging_factors(data.size(), kTausPerDecade);
  const std::vector<double> measured = identify::allan_variances(data.rate_rad_s(), factors);
  const std::size_t n = data.size();
  const auto runs =
      std::clamp(static_cast<std::size_t>(kWorkPerHypothesis / static_cast<double>(n)),
                 kFewestSimulations, kMostSimulations);
  const bool is_same = &base == &extended;
  SimulatedAllan simulated_base(base, factors, runs);
  SimulatedAllan simulated_extended(extended, factors, runs);
  const random::RandomStream stream = random::RandomStream(data.seed()).substream("envelope");
  const auto simulate = [&](std::size_t run) {
    std::vector<double> normal(n);
    stream.substream(run).fill_normal(0, normal);
    simulated_base.make(run, normal);
    if (!is_same) simulated_extended.make(run, normal);
  };
  parallel::for_each(runs, parallel::kAllThreads, simulate, {});
  const std::vector<Band> before = simulated_base.bands();
  const std::vector<Band> after = is_same ? before : simulated_extended.bands();
  std::vector<CurvePoint> curve;
  curve.reserve(factors.size());
  for (std::size_t i = 0; i < factors.size(); ++i) {
    curve.push_back({static_cast<double>(factors[i]) * data.period_s(), std::sqrt(measured[i]),
                     before[i].lo, before[i].middle, before[i].hi, after[i].lo, after[i].middle,
                     after[i].hi});
  }
  return curve;
}

/// The mean of `count` squares of normal numbers of a mean square: gamma distributed, so that
/// simulations of it are known without making them.
Band band_of_squares(double mean_square, double count, double z) {
  const boost::math::gamma_distribution<> gamma(0.5 * count, 2.0 / count);
  const double tail = 0.5 * std::erfc(z / std::numbers::sqrt2);
  return {mean_square * boost::math::quantile(gamma, tail), mean_square,
          mean_square * boost::math::quantile(boost::math::complement(gamma, tail))};
}

/// Mean expected square of the coefficients [first, end).
double expected_square(const Hypothesis& hypothesis, const std::vector<double>& mean,
                       std::size_t first, std::size_t end) {
  double sum = 0.0;
  for (std::size_t k = first; k < end; ++k) sum += hypothesis.density()[k] + mean[k] * mean[k];
  return sum / static_cast<double>(end - first);
}

/// Bands of a seventh of a decade and no fewer than six coefficients.
std::vector<Run> frequency_bands(std::size_t size) {
  constexpr double kRatio = 1.39;
  std::vector<Run> bands;
  for (std::size_t first = 1; first < size;) {
    const auto grown = static_cast<std::size_t>(static_cast<double>(first) * kRatio);
    const std::size_t end = std::min(size, std::max(grown, first + kNarrowestBand));
    bands.push_back({first, end});
    first = end;
  }
  return bands;
}

std::vector<CurvePoint> density_curve(const Hypothesis& base, const Hypothesis& extended) {
  const FitData& data = base.data();
  std::vector<double> measured = data.transform().forward(data.rate_rad_s());
  const std::vector<double> no_mean = mean_coefficients(base);
  const std::vector<double> mean = mean_coefficients(extended);
  const std::vector<Run> runs = frequency_bands(data.size());
  const double z = quantile_of_family(runs.size());
  // From two-sided density per sample to one-sided density per hertz.
  const double unit = 2.0 * data.period_s();
  std::vector<CurvePoint> curve;
  curve.reserve(runs.size());
  for (const Run& run : runs) {
    const auto count = static_cast<double>(run.end - run.first);
    double squares = 0.0;
    for (std::size_t k = run.first; k < run.end; ++k) squares += measured[k] * measured[k] / count;
    const Band before =
        band_of_squares(expected_square(base, no_mean, run.first, run.end), count, z);
    const Band after =
        band_of_squares(expected_square(extended, mean, run.first, run.end), count, z);
    const double frequency_hz = 0.5 * static_cast<double>(run.first + run.end - 1) /
                                (2.0 * static_cast<double>(data.size()) * data.period_s());
    curve.push_back({frequency_hz, unit * squares, unit * before.lo, unit * before.middle,
                     unit * before.hi, unit * after.lo, unit * after.middle, unit * after.hi});
  }
  return curve;
}

/// Moments of what the base model leaves, which are known for normal noise.
std::vector<Misfit> whitened_rows(const Hypothesis& base) {
  const std::vector<double>& u = base.whitened();
  const auto n = static_cast<double>(u.size());
  double neighbours = 0.0;
  double squares = 0.0;
  double third = 0.0;
  double fourth = 0.0;
  for (std::size_t k = 0; k < u.size(); ++k) {
    const double square = u[k] * u[k];
    squares += square / n;
    third += square * u[k] / n;
    fourth += square * square / n;
    if (k > 0) neighbours += u[k] * u[k - 1] / n;
  }
  const double z = quantile_of_family(4);
  const auto row = [&](const char* statistic, double measured, double expected, double deviation) {
    return Misfit{statistic, "", measured, expected - z * deviation, expected + z * deviation};
  };
  return {row("innovation_autocorrelation", neighbours / squares, 0.0, 1.0 / std::sqrt(n)),
          row("normalised_innovation_squared", squares, 1.0, std::sqrt(2.0 / n)),
          row("skewness", third / std::pow(squares, 1.5), 0.0, std::sqrt(6.0 / n)),
          row("excess_kurtosis", fourth / (squares * squares) - 3.0, 0.0, std::sqrt(24.0 / n))};
}

std::vector<Misfit> misfit_rows(const Envelopes& envelopes, const Hypothesis& base) {
  std::vector<Misfit> rows;
  rows.reserve(envelopes.allan.size() + envelopes.density.size());
  for (const CurvePoint& point : envelopes.allan) {
    rows.push_back({"allan_deviation_dps", fmt::format("tau {} s", units::in_figures(point.x)),
                    point.measured * kDegPerRad, point.base_lo * kDegPerRad,
                    point.base_hi * kDegPerRad});
  }
  const auto root = [](double density) { return std::sqrt(density) * kDegPerRad; };
  for (const CurvePoint& point : envelopes.density) {
    rows.push_back({"density_dps_per_sqrt_hz", fmt::format("{} Hz", units::in_figures(point.x)),
                    root(point.measured), root(point.base_lo), root(point.base_hi)});
  }
  const std::vector<Misfit> moments = whitened_rows(base);
  rows.insert(rows.end(), moments.begin(), moments.end());
  return rows;
}

}  // namespace

Envelopes simulate_envelopes(const Hypothesis& base, const Hypothesis& extended) {
  Envelopes envelopes{.allan = allan_curve(base, extended),
                      .density = density_curve(base, extended)};
  envelopes.misfit = misfit_rows(envelopes, base);
  return envelopes;
}

}  // namespace zerorate::diagnose
