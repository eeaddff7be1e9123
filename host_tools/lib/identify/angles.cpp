#include "host_tools/lib/identify/angles.hpp"

#include <fmt/format.h>

#include <cmath>

#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

constexpr std::size_t kLongestLag = 512;

double mean_square_change(const RestSamples& samples, std::size_t axis, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t k = lag; k < samples.time.size(); ++k) {
    const double change =
        double{samples.rate_rad_s[k][axis]} - double{samples.rate_rad_s[k - lag][axis]};
    sum += change * change;
  }
  return sum / static_cast<double>(samples.time.size() - lag);
}

bool is_sum_of_noise(const RestSamples& samples, std::size_t axis) {
  constexpr double kGrowth = 1.8;
  double shorter = mean_square_change(samples, axis, 1);
  for (std::size_t lag = 2; lag <= 2 * kLongestLag; lag *= 2) {
    const double longer = mean_square_change(samples, axis, lag);
    if (!(longer >= kGrowth * shorter) || !(shorter > 0.0)) return false;
    shorter = longer;
  }
  return true;
}

}  // namespace

std::optional<std::string> angles_not_rates(const RestSamples& samples,
                                            const std::vector<std::size_t>& axes) {
  if (samples.time.size() < 20 * kLongestLag) return std::nullopt;
  for (const std::size_t axis : axes) {
    if (!is_sum_of_noise(samples, axis)) continue;
    return fmt::format(
        "axis {} has no white noise: it changes by {:.2g} deg/s (rms) from sample to sample and by "
        "{:.2g} deg/s over {} samples, as a sum of noise does: angles, not rates? A column of "
        "rates is needed, or the angle of each sample (--units rate=deg/sample)",
        samples.axis_name(axis),
        std::sqrt(mean_square_change(samples, axis, 1)) * units::kDegPerRad,
        std::sqrt(mean_square_change(samples, axis, 2 * kLongestLag)) * units::kDegPerRad,
        2 * kLongestLag);
  }
  return std::nullopt;
}

}  // namespace zerorate::identify
