#include "host_tools/lib/diagnose/hypothesis/fit_data.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

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

namespace {

/// Standard deviation of white noise from the differences of good neighbours.
double rough_sigma(const std::vector<double>& values, const std::vector<bool>& bad) {
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t k = 1; k < values.size(); ++k) {
    if (bad[k] || bad[k - 1]) continue;
    const double step = values[k] - values[k - 1];
    squares += step * step;
    count += 1.0;
  }
  return std::sqrt(0.5 * squares / std::max(count, 1.0));
}

/// The straight line across a hole [first, end) between the good values on both sides.
class Bridge {
 public:
  Bridge(const std::vector<double>& values, const std::vector<bool>& bad, std::size_t first,
         std::size_t end)
      : first_(first), width_(static_cast<double>(end - first + 1)) {
    for (std::size_t k = first; k-- > 0 && before_.count < kReach;) before_.add(values[k], bad[k]);
    for (std::size_t k = end; k < values.size() && after_.count < kReach; ++k) {
      after_.add(values[k], bad[k]);
    }
  }

  [[nodiscard]] double at(std::size_t k) const {
    if (before_.count == 0) return after_.mean();
    if (after_.count == 0) return before_.mean();
    const double share = static_cast<double>(k - first_ + 1) / width_;
    return (1.0 - share) * before_.mean() + share * after_.mean();
  }

 private:
  static constexpr std::size_t kReach = 8;
  struct Side {
    double sum = 0.0;
    std::size_t count = 0;
    void add(double value, bool bad) {
      if (bad) return;
      sum += value;
      ++count;
    }
    [[nodiscard]] double mean() const {
      return count == 0 ? 0.0 : sum / static_cast<double>(count);
    }
  };

  std::size_t first_;
  double width_;
  Side before_;
  Side after_;
};

double normal_share_below(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// A normal number; beyond the end of the range where the measured value lies at that end.
double draw_beyond(const Range& range, double measured, double mean, double sigma, double uniform) {
  double lo = 0.0;
  double hi = 1.0;
  if (measured >= range.hi) lo = normal_share_below((range.hi - mean) / sigma);
  if (measured <= range.lo) hi = normal_share_below((range.lo - mean) / sigma);
  const double share = std::clamp(lo + uniform * (hi - lo), 1e-15, 1.0 - 1e-15);
  return mean + sigma * random::normal_quantile(share);
}

}  // namespace

std::vector<double> repair(const std::vector<double>& values, const std::vector<bool>& is_replaced,
                           const Range& range, std::uint64_t seed) {
  std::vector<double> repaired = values;
  if (std::ranges::find(is_replaced, true) == is_replaced.end()) return repaired;
  const double sigma = rough_sigma(values, is_replaced);
  const random::RandomStream noise = random::RandomStream(seed).substream("replaced values");
  for (std::size_t first = 0; first < values.size(); ++first) {
    if (!is_replaced[first]) continue;
    const auto end =
        static_cast<std::size_t>(std::find(is_replaced.begin() + static_cast<std::ptrdiff_t>(first),
                                           is_replaced.end(), false) -
                                 is_replaced.begin());
    const Bridge bridge(values, is_replaced, first, end);
    for (std::size_t k = first; k < end; ++k) {
      const double uniform = noise.uniform(static_cast<std::int64_t>(k));
      repaired[k] = draw_beyond(range, values[k], bridge.at(k), sigma, uniform);
    }
    first = end;
  }
  return repaired;
}

}  // namespace zerorate::diagnose
