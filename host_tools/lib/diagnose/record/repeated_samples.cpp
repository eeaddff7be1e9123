#include "host_tools/lib/diagnose/record/repeated_samples.hpp"

#include <algorithm>
#include <cmath>

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kFewest = 5;
constexpr double kOverChance = 4.0;
constexpr double kMostOfOneValue = 0.2;  // of the repetitions
constexpr double kNear = 0.05;           // of the differences are taken for those about zero
constexpr double kCoarse = 0.25;         // of the middle difference: the most for a level

/// How many neighbours would be equal by chance, by how close together the least differences lie.
/// All of them where the levels are too coarse to tell.
double equal_by_chance(const std::vector<double>& rates) {
  std::vector<double> differences;
  differences.reserve(rates.size());
  for (std::size_t k = 1; k < rates.size(); ++k) {
    if (rates[k] != rates[k - 1]) differences.push_back(std::abs(rates[k] - rates[k - 1]));
  }
  const auto all = static_cast<double>(rates.size());
  if (differences.empty()) return all;
  const auto quantile = [&](double share) {
    const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(differences.size()));
    std::ranges::nth_element(differences, differences.begin() + place);
    return *(differences.begin() + place);
  };
  const double width = quantile(kNear);
  const double least = std::ranges::min(differences);
  if (least > kCoarse * quantile(0.5)) return all;
  const auto within = static_cast<double>(std::ranges::count_if(
      differences, [width](double difference) { return difference <= width; }));
  return 0.5 * within * least / width;
}

double most_of_one_value(std::vector<double> values) {
  std::ranges::sort(values);
  std::ptrdiff_t most = 0;
  for (auto first = values.begin(); first != values.end();) {
    const auto end = std::upper_bound(first, values.end(), *first);
    most = std::max(most, end - first);
    first = end;
  }
  return static_cast<double>(most);
}

}  // namespace

std::vector<std::size_t> find_repeated_samples(const Record& record) {
  const std::vector<double>& rates = record.rate_rad_s;
  std::vector<std::size_t> repeated;
  std::vector<double> values;
  for (std::size_t k = 1; k < rates.size(); ++k) {
    if (rates[k] != rates[k - 1]) continue;
    repeated.push_back(k);
    values.push_back(rates[k]);
  }
  const auto count = static_cast<double>(repeated.size());
  const bool is_chance = repeated.size() < kFewest || count <= kOverChance * equal_by_chance(rates);
  if (is_chance || most_of_one_value(std::move(values)) > kMostOfOneValue * count) return {};
  return repeated;
}

Record without_samples(const Record& record, const std::vector<std::size_t>& left_out) {
  Record rest = record;
  const auto thin = [&](std::vector<double>& values) {
    if (values.empty()) return;
    std::size_t kept = 0;
    auto next = left_out.begin();
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (next != left_out.end() && *next == k) {
        ++next;
        continue;
      }
      values[kept++] = values[k];
    }
    values.resize(kept);
  };
  thin(rest.time_s);
  thin(rest.rate_rad_s);
  thin(rest.temperature_degc);
  return rest;
}

}  // namespace zerorate::diagnose
