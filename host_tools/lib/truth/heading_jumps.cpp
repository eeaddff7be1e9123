#include "host_tools/lib/truth/heading_jumps.hpp"

#include <algorithm>
#include <cmath>

#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::truth {
namespace {

constexpr std::int64_t kBeside = 3'000'000'000;  ///< longer than a reference is late
constexpr double kLeast_rad = 5.0 * units::kRadPerDeg;

}  // namespace

HeadingJumps::HeadingJumps(const Track& track, const Series& heading, const VerticalAxis& vertical)
    : heading_(heading), longest_ns_(heading.longest_interval_ns()) {
  Series parted;
  for (std::size_t k = 0; k < heading.size(); ++k) {
    turned_rad_.push_back(vertical.sign * track.turned_rad[k][vertical.axis]);
    parted.add(heading.time_ns(k), heading.value(k) - turned_rad_[k]);
  }
  find(parted);
}

bool HeadingJumps::has_between(std::int64_t from_ns, std::int64_t to_ns) const {
  const auto first = std::ranges::lower_bound(jumps_ns_, from_ns);
  return first != jumps_ns_.end() && *first <= to_ns;
}

HeadingJumps::Step HeadingJumps::step(std::size_t k) const {
  return {.reference_rad = heading_.value(k) - heading_.value(k - 1),
          .gyro_rad = turned_rad_[k] - turned_rad_[k - 1],
          .length_s = units::seconds(heading_.time_ns(k) - heading_.time_ns(k - 1))};
}

/// Whether the reference turns by a step that neither the step before nor the one after shows.
bool HeadingJumps::is_spike(std::size_t k) const {
  const double size = step(k).reference_rad;
  const double before = k > 1 ? step(k - 1).reference_rad : 0.0;
  const double after = k + 1 < heading_.size() ? step(k + 1).reference_rad : 0.0;
  return std::min(std::abs(size - before), std::abs(size - after)) > 0.5 * kLeast_rad;
}

/// Whether the gyro measured the same as in a step beside this one, bit by bit but for the sums.
bool HeadingJumps::repeats(std::size_t k) const {
  constexpr double kRounding_rad_s = 1e-8;
  const auto rate = [&](std::size_t at) { return step(at).gyro_rad / step(at).length_s; };
  return (k > 1 && std::abs(rate(k) - rate(k - 1)) < kRounding_rad_s) ||
         (k + 1 < heading_.size() && std::abs(rate(k) - rate(k + 1)) < kRounding_rad_s);
}

/// Whether half of what parted them lies in steps in which the gyro repeats a value or is wild.
bool HeadingJumps::is_fault_of_gyro(std::size_t k, double parted_rad) const {
  double by_gyro_rad = 0.0;
  const std::int64_t at_ns = heading_.time_ns(k);
  std::size_t first = k;
  while (first > 1 && heading_.time_ns(first - 1) >= at_ns - kBeside) --first;
  for (std::size_t i = std::max<std::size_t>(first, 1);
       i < heading_.size() && heading_.time_ns(i) <= at_ns + kBeside; ++i) {
    const Step one = step(i);
    const double apart_rad = one.reference_rad - one.gyro_rad;
    const bool is_wild = std::abs(apart_rad) > 0.5 * kLeast_rad &&
                         std::abs(one.gyro_rad) > std::abs(one.reference_rad) && !is_spike(i);
    if (is_wild || (repeats(i) && !is_spike(i))) by_gyro_rad += apart_rad;
  }
  return by_gyro_rad / parted_rad >= 0.5;
}

void HeadingJumps::find(const Series& parted) {
  // A bias parts them, too: it is the middle one of the steps.
  std::vector<double> steps;
  std::vector<std::size_t> at;
  for (std::size_t k = 0; k < parted.size(); ++k) {
    const auto before = parted.at(parted.time_ns(k) - kBeside, longest_ns_);
    const auto after = parted.at(parted.time_ns(k) + kBeside, longest_ns_);
    if (!before || !after) continue;
    steps.push_back(*after - *before);
    at.push_back(k);
  }
  if (steps.empty()) return;
  const double bias = statistics::median_of(steps);
  std::vector<double> sizes;
  sizes.reserve(steps.size());
  for (const double step : steps) sizes.push_back(std::abs(step - bias));
  const double least = std::max(kLeast_rad, 20.0 * statistics::median_of(sizes));
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (sizes[k] > least && !is_fault_of_gyro(at[k], steps[k] - bias)) {
      jumps_ns_.push_back(parted.time_ns(at[k]));
    }
  }
}

}  // namespace zerorate::truth
