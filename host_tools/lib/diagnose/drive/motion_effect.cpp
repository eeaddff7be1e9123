#include "host_tools/lib/diagnose/drive/motion_effect.hpp"

#include <cmath>
#include <utility>

namespace zerorate::diagnose {

double student_half_width95(double freedom) {
  // Expansion in powers of 1 / freedom, right to 1 % from 4 degrees of freedom on.
  constexpr double z = statistics::kHalfWidth95;
  constexpr double z3 = z * z * z;
  constexpr double z5 = z3 * z * z;
  return z + (z3 + z) / (4.0 * freedom) +
         (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * freedom * freedom) +
         (3.0 * z5 * z * z + 19.0 * z5 + 17.0 * z3 - 15.0 * z) /
             (384.0 * freedom * freedom * freedom);
}

Estimate with_slopes(const Estimate& share, double freedom) {
  constexpr double kBySlopes = 2e-4;
  const double sigma = std::hypot(share.sigma, kBySlopes);
  return {share.value, student_half_width95(freedom) * sigma, sigma};
}

Variant free_column(const Eigen::VectorXd& column, double prior_sigma, std::string by) {
  return {.by = std::move(by),
          .share = {.columns = column, .known = Eigen::VectorXd::Zero(column.size())},
          .prior_sigma = Eigen::VectorXd::Constant(1, prior_sigma)};
}

std::vector<std::unique_ptr<MotionEffect>> make_motion_effects() {
  std::vector<std::unique_ptr<MotionEffect>> effects;
  effects.push_back(make_scale_factor());
  effects.push_back(make_misalignment());
  effects.push_back(make_scale_asymmetry());
  effects.push_back(make_bias_in_motion());
  effects.push_back(make_g_sensitivity_in_motion());
  return effects;
}

}  // namespace zerorate::diagnose
