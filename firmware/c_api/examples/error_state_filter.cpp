#include "firmware/c_api/examples/error_state_filter.hpp"

namespace zerorate::examples {

ErrorStateFilter::ErrorStateFilter(const Noise& noise, float heading_rad, float sigma_rad)
    : noise_(noise), heading_rad_(heading_rad) {
  covariance_ << sigma_rad * sigma_rad, 0.0F, 0.0F, 0.0F;
}

void ErrorStateFilter::propagate(float measured_rad_s, float dt_s) {
  heading_rad_ += (measured_rad_s - bias_rad_s_) * dt_s;
  Covariance f;  // a bias that is too large makes the heading fall behind
  f << 1.0F, -dt_s, 0.0F, 1.0F;
  covariance_ = f * covariance_ * f.transpose();
  covariance_(0, 0) +=
      noise_.angle_random_walk_rad_sqrt_s * noise_.angle_random_walk_rad_sqrt_s * dt_s;
  covariance_(1, 1) += noise_.bias_walk_rad_s_sqrt_s * noise_.bias_walk_rad_s_sqrt_s * dt_s;
}

void ErrorStateFilter::measure_bias(float bias_rad_s, float sigma_rad_s) {
  if (!has_bias_) {
    has_bias_ = true;
    bias_rad_s_ = bias_rad_s;
    covariance_(1, 1) = sigma_rad_s * sigma_rad_s;
    return;
  }
  measure({0.0F, 1.0F}, bias_rad_s - bias_rad_s_, sigma_rad_s * sigma_rad_s);
}

void ErrorStateFilter::measure_heading(float heading_rad, float sigma_rad) {
  measure({1.0F, 0.0F}, heading_rad - heading_rad_, sigma_rad * sigma_rad);
}

// Joseph's form: it keeps the covariance positive whatever the rounding.
void ErrorStateFilter::measure(const Eigen::RowVector2f& h, float residual, float variance) {
  const Eigen::Vector2f gain =
      covariance_ * h.transpose() / ((h * covariance_ * h.transpose()).value() + variance);
  heading_rad_ += gain(0) * residual;
  bias_rad_s_ += gain(1) * residual;
  const Covariance keep = Covariance::Identity() - gain * h;
  covariance_ = keep * covariance_ * keep.transpose() + gain * variance * gain.transpose();
}

}  // namespace zerorate::examples
