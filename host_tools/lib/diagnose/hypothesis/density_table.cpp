#include "host_tools/lib/diagnose/hypothesis/density_table.hpp"

#include <algorithm>
#include <limits>

#include "host_tools/lib/diagnose/hypothesis/noise_density.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kNodes = 2048;  // in each octave

}  // namespace

std::vector<double> density_table(const NoiseSpectrum& spectrum, std::span<const double> sines,
                                  std::size_t end) {
  const std::size_t n = sines.size();
  const DensityFactors factors(spectrum);
  const auto at = [&](std::size_t k) { return factors.density(sines[k], k, n); };
  std::vector<double> density(end);
  if (end == 0) return density;
  density[0] = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < std::min(end, 2 * kNodes); ++k) density[k] = at(k);
  for (std::size_t first = 2 * kNodes; first < end;) {
    const std::size_t next = std::min(first + first / kNodes, n - 1);
    const double start = at(first);
    const double rise = next > first ? (at(next) - start) / static_cast<double>(next - first) : 0.0;
    const std::size_t last = std::min(next > first ? next : first + 1, end);
    for (std::size_t k = first; k < last; ++k) {
      density[k] = start + rise * static_cast<double>(k - first);
    }
    first = last;
  }
  return density;
}

}  // namespace zerorate::diagnose
