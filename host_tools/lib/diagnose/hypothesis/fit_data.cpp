#include "host_tools/lib/diagnose/hypothesis/fit_data.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_tools/lib/spectrum/real_fft.hpp"
#include "host_tools/lib/statistics/order_statistics.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kFewestBlocks = 65'536;

/// The greatest divisor of a length that leaves enough blocks, an even number of them.
std::size_t block_of(std::size_t size) {
  std::size_t block = std::max<std::size_t>(1, size / kFewestBlocks);
  while (size % (2 * block) != 0) --block;
  return block;
}

}  // namespace

FitData::FitData(const EvenSeries& series, std::uint64_t seed)
    : series_(&series),
      transform_(spectrum::fast_length_below(series.size())),
      block_(block_of(transform_.length())),
      sines_(transform_.length()),
      seed_(seed) {
  const std::size_t n = transform_.length();
  rate_.assign(series.rate_rad_s.begin(),
               series.rate_rad_s.begin() + static_cast<std::ptrdiff_t>(n));
  lost_ = std::make_shared<const std::vector<bool>>(
      series.lost.begin(), series.lost.begin() + static_cast<std::ptrdiff_t>(n));
  median_ = statistics::median_of(rate_);
  for (double& rate : rate_) rate -= median_;
  for (std::size_t k = 0; k < n; ++k) {
    sines_[k] =
        2.0 * std::sin(0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
  }
  if (block_ > 1) block_transform_.emplace(n / block_);
  if (!series.is_ticks) lattice_ = find_lattice(measured());
}

std::vector<double> FitData::measured() const {
  std::vector<double> values;
  for (std::size_t k = 0; k < size(); ++k) {
    if (!series_->lost[k]) values.push_back(rate_[k]);
  }
  return values;
}

}  // namespace zerorate::diagnose
