#include "host_tools/lib/identify/near_zero_mean.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>

#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

using units::kDegPerRad;

struct Level {
  double mean_rad_s = 0.0;
  double scatter_rad_s = 0.0;  ///< standard deviation of the means of tenths
};

std::optional<Level> level_of(const RestSamples& samples, std::size_t axis) {
  constexpr std::size_t kParts = 10;
  const std::size_t size = samples.time.size();
  if (size < kParts * kParts) return std::nullopt;
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::size_t first = part * size / kParts;
    const std::size_t end = (part + 1) * size / kParts;
    double mean = 0.0;
    for (std::size_t k = first; k < end; ++k) mean += double{samples.rate_rad_s[k][axis]};
    mean /= static_cast<double>(end - first);
    sum += mean;
    squares += mean * mean;
  }
  const double mean = sum / kParts;
  return Level{mean, std::sqrt(std::max(0.0, squares - kParts * mean * mean) / (kParts - 1))};
}

bool is_near_zero(const std::optional<Level>& level) {
  constexpr double kShare = 0.5;
  constexpr double kDrift_rad_s = 0.05 / kDegPerRad;
  return level && std::abs(level->mean_rad_s) < kShare * level->scatter_rad_s &&
         level->scatter_rad_s <= kDrift_rad_s;
}

RestDoubt doubt_of(const std::string& axes, const Level& level) {
  return {doubt::kBias,
          fmt::format("the mean of {} is {:.2g} deg/s, and means of tenths of the recording "
                      "scatter by {:.2g} deg/s: a bias already taken out upstream? Slow noise went "
                      "with it, and a node needs the rates of the chip",
                      axes, level.mean_rad_s * kDegPerRad, level.scatter_rad_s * kDegPerRad),
          false};
}

}  // namespace

bool is_mean_near_zero(const RestSamples& samples, std::size_t axis) {
  return is_near_zero(level_of(samples, axis));
}

std::vector<RestDoubt> doubts_of_near_zero_means(const RestSamples& samples) {
  std::vector<RestDoubt> doubts;
  std::optional<Level> largest;
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
    const std::optional<Level> level = level_of(samples, axis);
    if (!is_near_zero(level)) continue;
    if (!largest || std::abs(level->mean_rad_s) > std::abs(largest->mean_rad_s)) largest = level;
    doubts.push_back(doubt_of("axis " + samples.axis_name(axis), *level));
    doubts.back().axis = axis;
  }
  if (doubts.size() < samples.axis_count || samples.axis_count == 1) return doubts;
  return {doubt_of("every axis is near zero, the largest", *largest)};
}

}  // namespace zerorate::identify
