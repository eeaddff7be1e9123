#include "host_tools/lab/reference/full_state_filter.hpp"

#include <stdexcept>

namespace zerorate::reference {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

FullStateFilter::FullStateFilter(const FractionalNoise& noise, const Mean& mean,
                                 std::size_t capacity)
    : driving_variance_(noise.innovation_variance),
      white_variance_(noise.white_variance),
      // Eq. 6 is minus the impulse response of (1 - L)^d from lag 1 on.
      lagged_(-impulse_response(-noise.order, capacity + 1).tail(static_cast<Index>(capacity))),
      state_(VectorXd::Zero(static_cast<Index>(capacity) + 1)),
      covariance_(MatrixXd::Zero(state_.size(), state_.size())) {
  lagged_.reverseInPlace();
  state_(0) = mean.value;
  covariance_(0, 0) = mean.variance;
}

FullStateFilter FullStateFilter::after_waiting(const FractionalNoise& noise, std::size_t samples,
                                               std::size_t capacity) {
  FullStateFilter filter{noise, {}, capacity};
  const auto n = static_cast<Index>(samples);
  filter.covariance_.block(1, 1, n, n) = reference::covariance(noise, samples);
  filter.size_ = n + 1;
  return filter;
}

void FullStateFilter::advance() {
  if (size_ == state_.size()) throw std::length_error("FullStateFilter: beyond its capacity");
  const Index past = size_ - 1;
  const auto f = lagged_.tail(past);
  state_(size_) = f.dot(state_.segment(1, past));
  covariance_.col(size_).head(size_).noalias() = covariance_.block(0, 1, size_, past) * f;
  covariance_.row(size_).head(size_) = covariance_.col(size_).head(size_);
  covariance_(size_, size_) = f.dot(covariance_.col(size_).segment(1, past)) + driving_variance_;
  ++size_;
}

void FullStateFilter::observe(double value) {
  const VectorXd cross =
      covariance_.col(0).head(size_) + covariance_.col(size_ - 1).head(size_);  // P h
  const VectorXd gain = cross / innovation_variance();
  state_.head(size_) += gain * (value - bias());
  covariance_.topLeftCorner(size_, size_).noalias() -= gain * cross.transpose();
}

double FullStateFilter::bias_variance() const {
  const Index last = size_ - 1;
  return covariance_(0, 0) + 2.0 * covariance_(0, last) + covariance_(last, last);
}

}  // namespace zerorate::reference
