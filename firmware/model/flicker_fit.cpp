#include "firmware/model/flicker_fit.hpp"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "firmware/model/sensor_model.hpp"

namespace zerorate::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPi = std::numbers::pi;

/// Frequencies in cycles per tick, evenly spaced on a logarithmic scale, both ends included.
VectorXd frequency_grid(double lowest, double highest) {
  constexpr double kPointsPerDecade = 24.0;
  const double decades = std::log10(highest / lowest);
  const auto points = static_cast<Index>(std::ceil(kPointsPerDecade * decades)) + 1;
  const VectorXd exponents = VectorXd::LinSpaced(points, std::log10(lowest), std::log10(highest));
  return exponents.unaryExpr([](double e) { return std::pow(10.0, e); });
}

/// The spectrum per sample of a lag of unit stationary variance:
/// (1 - phi^2) / |1 - phi e^(-j 2 pi f)|^2 with phi = exp(-1/tau). The differences from one are
/// computed as such, because phi of a slow lag is one to many digits.
class LagSpectrum {
 public:
  explicit LagSpectrum(double tau_ticks)
      : one_minus_phi_(-std::expm1(-1.0 / tau_ticks)),
        one_minus_phi2_(-std::expm1(-2.0 / tau_ticks)),
        phi_(std::exp(-1.0 / tau_ticks)) {}

  /// @param sine  sin(pi f)
  [[nodiscard]] double at(double sine) const {
    return one_minus_phi2_ / (one_minus_phi_ * one_minus_phi_ + 4.0 * phi_ * sine * sine);
  }

 private:
  double one_minus_phi_;
  double one_minus_phi2_;
  double phi_;
};

/// Column i: lag i over the wanted spectrum; last column: white noise over it.
MatrixXd relative_spectra(const VectorXd& f, const VectorXd& tau_ticks, double order) {
  MatrixXd spectra(f.size(), tau_ticks.size() + 1);
  const std::vector<LagSpectrum> lags(tau_ticks.begin(), tau_ticks.end());
  for (Index k = 0; k < f.size(); ++k) {
    const double sine = std::sin(kPi * f(k));
    const double weight = std::pow(2.0 * sine, 2.0 * order);  // one over flicker with s_f = 1
    for (Index i = 0; i < tau_ticks.size(); ++i) {
      spectra(k, i) = weight * lags[static_cast<std::size_t>(i)].at(sine);
    }
    spectra(k, tau_ticks.size()) = weight;
  }
  return spectra;
}

/// Fit for s_f = 1.
FlickerFit fit_unit_flicker(const Flicker& flicker, double tick_s) {
  FlickerFit fit;
  for (int i = 0; i < flicker.decades; ++i) {
    fit.time_constants_s.push_back(flicker.shortest_time_constant_s * std::pow(10.0, i));
  }
  if (!(tick_s > 0.0 && tick_s < fit.time_constants_s.back())) {
    throw std::invalid_argument(
        "the filter's tick must be positive and shorter than the flicker's slowest lag");
  }
  const VectorXd tau_ticks =
      Eigen::Map<const VectorXd>(fit.time_constants_s.data(), flicker.decades) / tick_s;
  const VectorXd f = frequency_grid(1.0 / (2.0 * kPi * tau_ticks.maxCoeff()), 0.5);
  const MatrixXd spectra = relative_spectra(f, tau_ticks, flicker.order);

  // Slow lags of unit variance have a far higher spectrum than quick ones: level the columns.
  const VectorXd scale = spectra.colwise().norm().cwiseInverse();
  const VectorXd weights = scale.cwiseProduct(
      nonnegative_least_squares(spectra * scale.asDiagonal(), VectorXd::Ones(f.size())));
  const VectorXd ratio = spectra * weights;
  fit.least_ratio = ratio.minCoeff();
  fit.greatest_ratio = ratio.maxCoeff();

  fit.variances_rad2_s2.assign(weights.begin(), weights.end() - 1);
  fit.white_variance_rad2_s2 = weights(flicker.decades);
  return fit;
}

/// The latest fits of this thread: a likelihood asks for one shape at many strengths, a bank of
/// hypotheses for few orders again and again.
const FlickerFit& unit_flicker(const Flicker& flicker, double tick_s) {
  struct Known {
    Flicker flicker;
    double tick_s;
    FlickerFit fit;
  };
  constexpr std::size_t kMost = 8;
  thread_local std::deque<Known> latest;
  Flicker shape = flicker;
  shape.bias_instability_rad_s = 1.0;
  shape.source.clear();
  const auto known = std::ranges::find_if(
      latest, [&](const Known& one) { return one.tick_s == tick_s && one.flicker == shape; });
  if (known != latest.end()) return known->fit;
  if (latest.size() == kMost) latest.pop_back();
  return latest.emplace_front(Known{shape, tick_s, fit_unit_flicker(shape, tick_s)}).fit;
}

}  // namespace

double FlickerFit::density(double tick_s, double cycles_per_tick) const {
  const double sine = std::sin(kPi * cycles_per_tick);
  double sum = white_variance_rad2_s2;
  for (std::size_t i = 0; i < time_constants_s.size(); ++i) {
    sum += variances_rad2_s2[i] * LagSpectrum(time_constants_s[i] / tick_s).at(sine);
  }
  return sum;
}

FlickerFit fit_flicker(const Flicker& flicker, double tick_s) {
  validate(flicker);
  FlickerFit fit = unit_flicker(flicker, tick_s);
  const double s_f = flicker.bias_instability_rad_s * std::pow(tick_s, flicker.order - 0.5);
  for (double& variance : fit.variances_rad2_s2) variance *= s_f * s_f;
  fit.white_variance_rad2_s2 *= s_f * s_f;
  return fit;
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// The unconstrained solution in the free variables; zero in the others.
/// `free` holds 1 for a free variable and 0 for one that is held at zero.
VectorXd solve_free(const MatrixXd& A, const VectorXd& b, const VectorXd& free) {
  const MatrixXd free_columns = A * free.asDiagonal();
  return free.cwiseProduct(free_columns.completeOrthogonalDecomposition().solve(b));
}

bool is_feasible(const VectorXd& z, const VectorXd& free) {
  return (free.array() == 0.0 || z.array() > 0.0).all();
}

/// Goes from x towards z until a free variable becomes zero, and holds that one from then on.
void step_to_boundary(VectorXd& x, const VectorXd& z, VectorXd& free) {
  double share = 1.0;
  Index blocking = 0;
  for (Index i = 0; i < x.size(); ++i) {
    if (free(i) != 0.0 && z(i) <= 0.0 && x(i) / (x(i) - z(i)) <= share) {
      share = x(i) / (x(i) - z(i));
      blocking = i;
    }
  }
  x += share * (z - x);
  free(blocking) = 0.0;
  x = x.cwiseProduct(free);
}

}  // namespace

VectorXd nonnegative_least_squares(const MatrixXd& rows, const VectorXd& wanted) {
  const double tolerance = 100.0 * kEpsilon * rows.norm() * wanted.norm();
  // |rows x - wanted| is that of the triangle, but for a constant: many rows are worked on once.
  const Index height = std::min(rows.rows(), rows.cols());
  const Eigen::HouseholderQR<MatrixXd> triangle(rows);
  const MatrixXd A = triangle.matrixQR().topRows(height).triangularView<Eigen::Upper>();
  const VectorXd b = (triangle.householderQ().transpose() * wanted).head(height);
  VectorXd x = VectorXd::Zero(A.cols());
  VectorXd free = VectorXd::Zero(A.cols());
  // Each round frees the variable that helps most. In exact arithmetic the sum of squares falls in
  // every round and no set of free variables comes back; the bound is for rounding errors.
  for (Index round = 0; round < 3 * A.cols(); ++round) {
    const VectorXd descent =
        (A.transpose() * (b - A * x)).cwiseProduct(VectorXd::Ones(free.size()) - free);
    Index entering = 0;
    if (descent.maxCoeff(&entering) <= tolerance) {
      break;
    }
    free(entering) = 1.0;
    VectorXd z = solve_free(A, b, free);
    while (!is_feasible(z, free)) {
      step_to_boundary(x, z, free);
      z = solve_free(A, b, free);
    }
    x = z;
  }
  return x;
}

}  // namespace zerorate::model
