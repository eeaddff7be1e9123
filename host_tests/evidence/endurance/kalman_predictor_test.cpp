// The single-precision filter and a double-precision one side by side over very many ticks.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <random>

#include "core/estimator/kalman_predictor.hpp"
#include "core/noise/terms.hpp"
#include "firmware/model/flicker_fit.hpp"

namespace zerorate::testing {
namespace {

constexpr std::size_t kDecades = 6;
using Decades = core::Modes<kDecades, 0>;

/// 1/f^(2d) noise at 100 Hz from one tick to 10^5 ticks, with the weights of the project's own fit,
/// scaled to unit variance of the fastest decade.
Decades fitted_decades(double order) {
  constexpr core::Duration kTick = core::Duration::milliseconds(10);
  constexpr double kTickS = 0.01;
  const model::FlickerFit fit = model::fit_flicker({.bias_instability_rad_s = 1.0,
                                                    .order = order,
                                                    .decades = static_cast<int>(kDecades),
                                                    .shortest_time_constant_s = kTickS},
                                                   kTickS);
  core::FlickerDecades<kDecades> flicker;
  for (std::size_t i = 0; i < kDecades; ++i) {
    flicker.time_constant_s[i] = static_cast<float>(fit.time_constants_s[i]);
    flicker.variance_rad2_s2[i] =
        static_cast<float>(fit.variances_rad2_s2[i] / fit.variances_rad2_s2[0]);
  }
  return core::compose(kTick, core::Start::stationary, flicker);
}

/// The oracle, written differently: double precision, states (level, z), h = ones, the whole
/// matrix. The diffuse level is conditioned on the first measurement by hand.
class DoubleFilter {
 public:
  DoubleFilter(const Decades& modes, double first_variance) {
    for (std::size_t i = 0; i < kDecades; ++i) {
      const auto row = static_cast<Eigen::Index>(i) + 1;
      phi_(row) = 1.0 - double{modes.decaying[i].one_minus_phi};
      q_(row) = double{modes.decaying[i].noise_variance};
      const double variance = double{modes.decaying[i].initial_variance};
      p_(row, row) = variance;
      p_(0, row) = p_(row, 0) = -variance;
      p_(0, 0) += variance;
    }
    p_(0, 0) += first_variance;
    phi_outer_ = phi_ * phi_.transpose();
  }

  void predict() {
    x_ = x_.cwiseProduct(phi_);
    p_ = p_.cwiseProduct(phi_outer_);
    p_.diagonal() += q_;
  }
  [[nodiscard]] double bias() const { return x_.sum(); }
  [[nodiscard]] double bias_variance() const { return p_.sum(); }

  /// @param residual measured minus bias(); the measurement has the variance r
  void update(double residual, double r) {
    const Vector ph = p_.rowwise().sum();
    const Vector gain = ph / (ph.sum() + r);
    x_ += gain * residual;
    p_.noalias() -= gain * ph.transpose();
  }

  /// Covariance of (bias, z), the coordinates of the filter under test.
  [[nodiscard]] Eigen::Matrix<double, 7, 7> bias_first_covariance() const {
    Matrix t = Matrix::Identity();
    t.row(0).setOnes();
    return t * p_ * t.transpose();
  }

 private:
  using Matrix = Eigen::Matrix<double, 7, 7>;
  using Vector = Eigen::Matrix<double, 7, 1>;
  Vector x_ = Vector::Zero(), phi_ = Vector::Ones(), q_ = Vector::Zero();
  Matrix p_ = Matrix::Zero(), phi_outer_;
};

/// The covariance of (bias, drifts) that the filter under test holds: (bias, z), scaled.
Eigen::Matrix<double, 7, 7> covariance_of(
    const core::KalmanPredictor<core::ModelShape{.decaying = kDecades}>::State& state) {
  const auto& filter = state.filters[0];
  Eigen::Matrix<double, 7, 7> p;
  p(0, 0) = double{filter.bias_variance};
  for (std::size_t i = 0; i < kDecades; ++i) {
    const auto row = static_cast<Eigen::Index>(i) + 1;
    p(0, row) = p(row, 0) = double{filter.bias_covariance[i]};
    for (std::size_t j = 0; j < kDecades; ++j) {
      p(row, static_cast<Eigen::Index>(j) + 1) = double{filter.covariance(i, j)};
    }
  }
  return p;
}

/// Whether Cholesky's factorisation in double goes through.
bool is_positive_definite(const Eigen::Matrix<double, 7, 7>& p) {
  return p.allFinite() && Eigen::LLT<Eigen::Matrix<double, 7, 7>>(p).info() == Eigen::Success;
}

/// Smallest eigenvalue of the correlation matrix, at most 1; 0 is singular.
double smallest_correlation_eigenvalue(const Eigen::Matrix<double, 7, 7>& p) {
  const Eigen::Matrix<double, 7, 1> scale = p.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix<double, 7, 7> correlation = scale.asDiagonal() * p * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 7, 7>>(correlation,
                                                                    Eigen::EigenvaluesOnly)
      .eigenvalues()(0);
}

/// Result of a run: deviations of single from double precision.
struct Lockstep {
  std::uint64_t checks = 0;
  std::uint64_t not_positive_definite = 0;
  double least_eigenvalue = 1.0;         ///< least one of a correlation matrix
  double least_eigenvalue_double = 1.0;  ///< and of the oracle
  double worst_sigma = 0.0;              ///< largest |sigma / oracle's sigma - 1| at a check
  double worst_bias = 0.0;               ///< largest |bias - oracle's bias| in the oracle's sigmas
  double rms_bias = 0.0;                 ///< root mean square of that error over all steps
  double last_sigma_deviation = 0.0;     ///< at the end, signed
};

/// Ticks without pause on measurements that the model itself makes, the level being zero: the
/// oracle's prediction plus a normal innovation of the oracle's variance has exactly the model's
/// distribution, at the price of one random number.
/// @param r white variance of a measurement; the fastest decade has the variance 1
Lockstep run_in_lockstep(const Decades& modes, double r, std::uint64_t steps,
                         std::uint64_t check_every) {
  const core::KalmanCoefficients coefficients{modes};
  core::KalmanPredictor filter{coefficients};
  DoubleFilter oracle{modes, r};
  const auto tick = modes.one_tick();
  const auto single_r = static_cast<float>(r);
  std::mt19937_64 random{2012};
  std::normal_distribution<double> normal;
  Lockstep result;
  double squares = 0.0;
  (void)filter.observe(0.0F, single_r);
  for (std::uint64_t k = 1; k <= steps; ++k) {
    oracle.predict();
    const double predicted = oracle.bias();
    const auto y = static_cast<float>(
        predicted + std::sqrt(oracle.bias_variance() + double{single_r}) * normal(random));
    oracle.update(double{y} - predicted, double{single_r});
    (void)filter.step(tick, y, single_r);
    const double error = (double{filter.state().filters[0].axes[0].bias_rad_s} - oracle.bias()) /
                         std::sqrt(oracle.bias_variance());
    squares += error * error;
    result.worst_bias = std::max(result.worst_bias, std::abs(error));
    if (k % check_every != 0) continue;
    ++result.checks;
    const auto p = covariance_of(filter.state());
    const auto p_oracle = oracle.bias_first_covariance();
    if (!is_positive_definite(p)) ++result.not_positive_definite;
    result.least_eigenvalue = std::min(result.least_eigenvalue, smallest_correlation_eigenvalue(p));
    result.least_eigenvalue_double =
        std::min(result.least_eigenvalue_double, smallest_correlation_eigenvalue(p_oracle));
    result.last_sigma_deviation = std::sqrt(p(0, 0) / p_oracle(0, 0)) - 1.0;
    result.worst_sigma = std::max(result.worst_sigma, std::abs(result.last_sigma_deviation));
  }
  result.rms_bias = std::sqrt(squares / static_cast<double>(steps));
  return result;
}

/// Prints the figures, for docs/adr/0006, and checks what users rely on.
void expect_sound(const Lockstep& run, double order, double r) {
  std::printf(
      "d = %.1f, r = %g: least eigenvalue %.2g (double %.2g); sigma off by %.1e at most, %.1e at "
      "the end; bias off by %.1e sigma at most, %.1e rms\n",
      order, r, run.least_eigenvalue, run.least_eigenvalue_double, run.worst_sigma,
      run.last_sigma_deviation, run.worst_bias, run.rms_bias);
  SCOPED_TRACE(::testing::Message() << "d = " << order << ", r = " << r);
  EXPECT_EQ(run.not_positive_definite, 0U);
  EXPECT_GT(run.least_eigenvalue, 0.5 * run.least_eigenvalue_double);
  EXPECT_LT(run.worst_sigma, 1e-4);
  EXPECT_LT(run.worst_bias, 0.02);
}

/// Flicker of two orders, and next to no or mostly white noise; checked a hundred times on the way.
void expect_sound_over(std::uint64_t steps) {
  for (const double order : {0.5, 0.8}) {
    for (const double r : {1e-6, 10.0}) {
      const Lockstep run = run_in_lockstep(fitted_decades(order), r, steps, steps / 100);
      EXPECT_EQ(run.checks, 100U);
      expect_sound(run, order, r);
    }
  }
}

TEST(KalmanPredictorOverAMillionSteps, StaysDefiniteAndCalibrated) {
  expect_sound_over(1'000'000);
}

TEST(KalmanPredictorOverAHundredMillionSteps, StaysCalibrated) {
  expect_sound_over(100'000'000);
}

}  // namespace
}  // namespace zerorate::testing
