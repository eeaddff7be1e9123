#include "host_tools/lib/report/thin.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace zerorate::report {
namespace {

constexpr std::size_t kKeptUnthinned = 4 * kDisplayColumns;

/// Column of x in a window cut into kDisplayColumns.
std::size_t column_of(double x, const DisplayWindow& window) {
  const double fraction = window.scale == Scale::linear
                              ? (x - window.from) / (window.to - window.from)
                              : std::log(x / window.from) / std::log(window.to / window.from);
  const double column = fraction * static_cast<double>(kDisplayColumns);
  return std::min(kDisplayColumns - 1, static_cast<std::size_t>(std::max(0.0, column)));
}

/// Appends the indices of the least and the greatest finite value in [begin, end), if there are
/// any.
void append_extremes(std::span<const double> values, std::size_t begin, std::size_t end,
                     std::vector<std::size_t>& kept) {
  std::size_t least = end;
  std::size_t greatest = end;
  for (std::size_t i = begin; i < end; ++i) {
    if (!std::isfinite(values[i])) continue;
    if (least == end || values[i] < values[least]) least = i;
    if (greatest == end || values[i] > values[greatest]) greatest = i;
  }
  if (least == end) return;
  kept.push_back(least);
  kept.push_back(greatest);
}

}  // namespace

std::vector<std::size_t> thin_for_display(std::span<const double> x,
                                          std::span<const std::span<const double>> channels,
                                          const DisplayWindow& window) {
  std::vector<std::size_t> kept;
  if (x.size() <= kKeptUnthinned) {
    kept.resize(x.size());
    std::iota(kept.begin(), kept.end(), std::size_t{0});
    return kept;
  }
  for (std::size_t begin = 0; begin < x.size();) {
    const std::size_t column = column_of(x[begin], window);
    std::size_t end = begin + 1;
    while (end < x.size() && column_of(x[end], window) == column) ++end;

    const auto column_start = static_cast<std::ptrdiff_t>(kept.size());
    kept.push_back(begin);
    for (const auto& channel : channels) append_extremes(channel, begin, end, kept);
    kept.push_back(end - 1);
    std::sort(kept.begin() + column_start, kept.end());
    kept.erase(std::unique(kept.begin() + column_start, kept.end()), kept.end());
    begin = end;
  }
  return kept;
}

}  // namespace zerorate::report
