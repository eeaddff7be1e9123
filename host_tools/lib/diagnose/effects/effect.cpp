#include "host_tools/lib/diagnose/effects/effect.hpp"

#include <cmath>

namespace zerorate::diagnose {

double Found::amplitude(std::size_t i) const {
  return all.amplitudes()(static_cast<Eigen::Index>(all.first_amplitude(index) + i));
}

double Found::amplitude_error(std::size_t i) const {
  const auto at = static_cast<Eigen::Index>(all.first_amplitude(index) + i);
  return std::sqrt(std::max(0.0, all.amplitude_covariance()(at, at)));
}

}  // namespace zerorate::diagnose
