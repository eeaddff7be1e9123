#include "host_tools/lib/diagnose/inputs/input_regression.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::diagnose {
namespace {

/// Rate that stands for a unit of a column in the filter, which works in single precision [rad/s].
constexpr double kRateOfUnit = 0.01;

/// Ticks of one axis, of rates that are given.
std::vector<identify::TickMean> ticks_with(const InputTicks& ticks,
                                           const std::vector<double>& rate_rad_s) {
  std::vector<identify::TickMean> means = ticks.means;
  for (std::size_t k = 0; k < means.size(); ++k) {
    means[k].rate_rad_s[0] = static_cast<float>(rate_rad_s[k]);
  }
  return means;
}

identify::PreparedFit prepared(const InputTicks& ticks, const std::vector<double>& rate_rad_s) {
  const std::vector<identify::TickMean> means = ticks_with(ticks, rate_rad_s);
  identify::PreparedFit fit =
      identify::prepare_fit({means, ticks.sample_period, ticks.tick, 0}, {});
  // Slow noise that is too weak to be named still moves the biases of standstills.
  fit.options.significance = 1.0;
  return fit;
}

/// Innovations over their standard deviations.
Eigen::VectorXd whitened(const InputTicks& ticks, const std::vector<double>& rate_rad_s,
                         const model::SensorModel& model) {
  const std::vector<identify::TickMean> means = ticks_with(ticks, rate_rad_s);
  const identify::InnovationsLikelihood likelihood{means, 0, ticks.sample_period, ticks.tick};
  const auto innovations = likelihood.innovations(model);
  Eigen::VectorXd white(static_cast<Eigen::Index>(innovations.size()));
  for (std::size_t k = 0; k < innovations.size(); ++k) {
    white[static_cast<Eigen::Index>(k)] =
        innovations[k].residual_rad_s / std::sqrt(innovations[k].variance_rad2_s2);
  }
  return white;
}

/// Values about their mean, as rates.
std::vector<double> scaled(const InputColumn& column) {
  const double mean =
      std::accumulate(column.begin(), column.end(), 0.0) / static_cast<double>(column.size());
  std::vector<double> rate_rad_s = column;
  for (double& value : rate_rad_s) value = kRateOfUnit * (value - mean);
  return rate_rad_s;
}

class Regression {
 public:
  Regression(const InputTicks& ticks, std::size_t axis, std::span<const InputColumn> columns)
      : ticks_(ticks) {
    for (const identify::TickMean& mean : ticks.means) {
      rate_rad_s_.push_back(double{mean.rate_rad_s[axis]});
    }
    for (const InputColumn& column : columns) columns_.push_back(scaled(column));
  }

  /// Innovations that the fit leaves, whitened, and the noise that they are whitened by.
  struct Remainder {
    Eigen::VectorXd white;
    model::SensorModel noise;
  };
  Remainder remainder() {
    const std::vector<double> left = residual(fit());
    const model::SensorModel noise = fit_noise(left);
    return {whitened(ticks_, left, noise), noise};
  }

  InputFit fit() {
    constexpr int kMostTurns = 5;
    constexpr double kNoGrowth_nats = 0.01;
    model::SensorModel noise = fit_noise(rate_rad_s_);
    InputFit best{.log_likelihood = log_likelihood_, .noise = noise};
    for (int turn = 0; turn < kMostTurns && !columns_.empty(); ++turn) {
      InputFit fit = fit_coefficients(noise);
      noise = fit_noise(residual(fit));
      fit.log_likelihood = log_likelihood_;
      fit.noise = noise;
      const double growth = fit.log_likelihood - best.log_likelihood;
      if (turn == 0 || growth > 0.0) best = std::move(fit);
      if (turn > 0 && growth < kNoGrowth_nats) break;
    }
    return best;
  }

 private:
  /// White and flicker noise of a rate; sets the likelihood.
  model::SensorModel fit_noise(const std::vector<double>& rate_rad_s) {
    const identify::PreparedFit fit = prepared(ticks_, rate_rad_s);
    const auto noise = identify::fit_by_innovations(fit.likelihood, fit.options);
    model::SensorModel model = noise.model(fit.options.shortest_time_constant_s);
    model.name = "noise beside inputs";
    log_likelihood_ = -0.5 * fit.likelihood(model).minus_two_log();
    return model;
  }

  [[nodiscard]] InputFit fit_coefficients(const model::SensorModel& noise) const {
    const Eigen::VectorXd rate = whitened(ticks_, rate_rad_s_, noise);
    Eigen::MatrixXd inputs(rate.size(), static_cast<Eigen::Index>(columns_.size()));
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      inputs.col(static_cast<Eigen::Index>(i)) = whitened(ticks_, columns_[i], noise);
    }
    const Eigen::MatrixXd covariance = (inputs.transpose() * inputs).inverse();
    const Eigen::VectorXd amplitudes = covariance * (inputs.transpose() * rate);
    InputFit fit;
    for (Eigen::Index i = 0; i < amplitudes.size(); ++i) {
      fit.coefficients.push_back(kRateOfUnit * amplitudes[i]);
      fit.covariance.emplace_back();
      for (Eigen::Index j = 0; j < amplitudes.size(); ++j) {
        fit.covariance.back().push_back(kRateOfUnit * kRateOfUnit * covariance(i, j));
      }
    }
    return fit;
  }

  [[nodiscard]] std::vector<double> residual(const InputFit& fit) const {
    std::vector<double> left = rate_rad_s_;
    for (std::size_t i = 0; i < fit.coefficients.size(); ++i) {
      for (std::size_t k = 0; k < left.size(); ++k) {
        left[k] -= fit.coefficients[i] / kRateOfUnit * columns_[i][k];
      }
    }
    return left;
  }

  const InputTicks& ticks_;
  std::vector<double> rate_rad_s_;
  std::vector<std::vector<double>> columns_;
  double log_likelihood_ = 0.0;  ///< likelihood of the noise that was fitted last
};

}  // namespace

namespace {

/// First ticks of the standstills, and the end.
std::vector<std::size_t> ends_of_standstills(const InputTicks& ticks) {
  std::vector<std::size_t> ends{0};
  for (std::size_t k = 1; k < ticks.size(); ++k) {
    if (ticks.standstill[k] != ticks.standstill[k - 1]) ends.push_back(k);
  }
  ends.push_back(ticks.size());
  return ends;
}

/// The column with the means of its standstills exchanged at random; of few standstills, turned
/// about by a random number of ticks.
InputColumn exchanged(const InputTicks& ticks, const InputColumn& column,
                      const random::RandomStream& draws) {
  constexpr std::size_t kFewestStandstills = 4;
  const std::vector<std::size_t> ends = ends_of_standstills(ticks);
  std::vector<double> means = means_by_standstill(ticks, column);
  const auto below = [&](std::size_t count, std::size_t draw) {
    return static_cast<std::size_t>(draws.uniform(static_cast<std::int64_t>(draw)) *
                                    static_cast<double>(count));
  };
  InputColumn drawn = column;
  if (means.size() < kFewestStandstills) {
    std::rotate(drawn.begin(), drawn.begin() + static_cast<std::ptrdiff_t>(below(drawn.size(), 0)),
                drawn.end());
    return drawn;
  }
  for (std::size_t i = means.size(); i-- > 1;) std::swap(means[i], means[below(i + 1, i)]);
  for (std::size_t i = 0; i < means.size(); ++i) {
    for (std::size_t k = ends[i]; k < ends[i + 1]; ++k) drawn[k] = means[i];
  }
  return drawn;
}

}  // namespace

double inflation_of_gains(const InputTicks& ticks, std::size_t axis,
                          std::span<const InputColumn> all, std::span<const InputColumn> columns) {
  constexpr std::uint64_t kDraws = 20;
  const Regression::Remainder rest = Regression(ticks, axis, all).remainder();
  double gains = 0.0;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    Eigen::MatrixXd inputs(rest.white.size(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i) {
      // All columns are exchanged alike.
      const InputColumn column = exchanged(ticks, columns[i], random::RandomStream{1, draw});
      inputs.col(static_cast<Eigen::Index>(i)) = whitened(ticks, scaled(column), rest.noise);
    }
    const Eigen::VectorXd products = inputs.transpose() * rest.white;
    gains += 0.5 * products.dot((inputs.transpose() * inputs).ldlt().solve(products));
  }
  const auto expected = 0.5 * static_cast<double>(columns.size());
  const double inflation = std::max(1.0, gains / static_cast<double>(kDraws) / expected);
  // The share of the scatter of so few standstills that the fit of the columns leaves.
  const auto free = static_cast<double>(ends_of_standstills(ticks).size()) - 2.0;
  const double left = free - static_cast<double>(all.size());
  return left > 0.0 ? inflation * free / left : inflation;
}

InputFit fit_inputs(const InputTicks& ticks, std::size_t axis,
                    std::span<const InputColumn> columns) {
  return Regression(ticks, axis, columns).fit();
}

double score_of_rest(const InputTicks& ticks, std::size_t axis,
                     std::span<const InputColumn> columns, std::size_t first) {
  std::vector<InputColumn> seen;
  for (const InputColumn& column : columns) {
    seen.emplace_back(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(first));
  }
  const InputFit fit = fit_inputs(beginning_of(ticks, first), axis, seen);
  std::vector<identify::TickMean> left = ticks.means;
  for (std::size_t k = 0; k < left.size(); ++k) {
    double rate_rad_s = double{left[k].rate_rad_s[axis]};
    for (std::size_t i = 0; i < columns.size(); ++i) {
      rate_rad_s -= fit.coefficients[i] * (columns[i][k] - columns[i][0]);
    }
    left[k].rate_rad_s[0] = static_cast<float>(rate_rad_s);
  }
  const identify::InnovationsLikelihood likelihood{left, 0, ticks.sample_period, ticks.tick};
  const auto innovations = likelihood.innovations(fit.noise);  // none of the first tick
  double score = 0.0;
  for (std::size_t k = first - 1; k < innovations.size(); ++k) {
    const auto& [residual, variance] = innovations[k];
    score -= 0.5 * (std::log(variance) + residual * residual / variance);
  }
  return score;
}

}  // namespace zerorate::diagnose
