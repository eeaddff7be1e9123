#include "host_tools/lib/identify/local_whittle.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "host_tools/lib/identify/minimise.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/spectrum/fractional_filter.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::identify {
namespace {

/// The objective R(d) of one record, and what does not depend on d.
class LocalWhittle {
 public:
  LocalWhittle(std::span<const double> values, std::size_t frequencies)
      : centred_(values.begin(), values.end()), log_gains_(frequencies), fft_(values.size()) {
    const double mean = mean_of(values);
    for (double& value : centred_) value -= mean;
    const double step = std::numbers::pi / static_cast<double>(values.size());
    for (std::size_t j = 0; j < frequencies; ++j) {
      log_gains_[j] = std::log(2.0 * std::sin(step * static_cast<double>(j + 1)));
    }
  }

  double objective(double order) const {
    const std::vector<double> whitened = spectrum::difference_fractionally(order, centred_);
    std::vector<std::complex<double>> bins(fft_.bins());
    fft_.forward(whitened, bins);
    double power = 0.0;
    for (std::size_t j = 1; j <= log_gains_.size(); ++j) power += std::norm(bins[j]);
    return std::log(power) - 2.0 * order * mean_of(log_gains_);
  }

  double standard_error() const {
    const double mean = mean_of(log_gains_);
    double squares = 0.0;
    for (const double gain : log_gains_) squares += (gain - mean) * (gain - mean);
    return 0.5 / std::sqrt(squares);
  }

 private:
  static double mean_of(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  }

  std::vector<double> centred_;
  std::vector<double> log_gains_;  // of 1 - L at each frequency
  spectrum::RealFft fft_;
};

}  // namespace

std::size_t local_whittle_bandwidth(std::size_t samples) {
  return static_cast<std::size_t>(std::pow(static_cast<double>(samples), 0.65));
}

Estimate exact_local_whittle(std::span<const double> values, std::size_t frequencies) {
  const std::size_t size = values.size() < 2 ? 0 : spectrum::fast_length_below(values.size());
  if (frequencies < 2 || frequencies >= size / 2) {
    throw std::invalid_argument("exact_local_whittle: the frequencies do not fit the record");
  }
  const bool constant = std::ranges::adjacent_find(values, std::not_equal_to{}) == values.end();
  const LocalWhittle whittle(values.first(size), frequencies);
  constexpr double kLowest = -0.5;
  constexpr double kHighest = 1.0;
  constexpr int kScanSteps = 6;
  constexpr int kBits = 16;  // d to about 1e-5
  const ScalarMinimum best = minimise([&](double order) { return whittle.objective(order); },
                                      kLowest, kHighest, kScanSteps, kBits);
  if (constant || !std::isfinite(best.value)) {
    throw recording::DataError("exact_local_whittle: the record is constant or not finite");
  }
  return {best.at, whittle.standard_error()};
}

}  // namespace zerorate::identify
