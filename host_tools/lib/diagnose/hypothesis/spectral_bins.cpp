#include "host_tools/lib/diagnose/hypothesis/spectral_bins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kBinGrowth = 1.03;
constexpr double kShareOfEnd = 0.1;  // of the coefficients up to the last one, in a bin
constexpr std::size_t kFewestInEnd = 8;

/// Width of a bin that begins at a coefficient, so that it does not blur a line.
std::size_t width_near(std::size_t line, std::size_t first) {
  if (line == 0) return std::numeric_limits<std::size_t>::max() / 2;
  const std::size_t distance = line > first ? line - first : first - line;
  return std::max<std::size_t>(1, distance / 10);
}

}  // namespace

std::vector<SpectralBin> bin_coefficients(std::span<const double> coefficients, std::size_t line) {
  const std::size_t n = coefficients.size();
  std::vector<SpectralBin> bins;
  for (std::size_t first = 1; first < n;) {
    const auto grown = static_cast<std::size_t>(static_cast<double>(first) * kBinGrowth);
    const bool single = first <= kSingleBins;
    const auto end_width = std::max(
        kFewestInEnd, static_cast<std::size_t>(kShareOfEnd * static_cast<double>(n - first)));
    const std::size_t end = single ? first + 1
                                   : std::min({std::max(grown, first + 1), first + end_width,
                                               first + width_near(line, first), n});
    const double sum = sum_of_squares(coefficients.subspan(first, end - first));
    const auto count = static_cast<double>(end - first);
    const double centre = 0.5 * static_cast<double>(first + end - 1);
    const double sine = 2.0 * std::sin(0.5 * std::numbers::pi * centre / static_cast<double>(n));
    bins.push_back({sine, sum / count, count, single ? first : 0});
    first = end;
  }
  return bins;
}

void update_bins(std::span<SpectralBin> bins, std::span<const double> coefficients,
                 std::size_t end) {
  std::size_t first = 1;
  for (SpectralBin& bin : bins) {
    if (first >= end) return;
    const auto count = static_cast<std::size_t>(bin.count);
    bin.mean_square = sum_of_squares(coefficients.subspan(first, count)) / bin.count;
    first += count;
  }
}

}  // namespace zerorate::diagnose
