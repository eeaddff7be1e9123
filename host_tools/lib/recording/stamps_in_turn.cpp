#include "host_tools/lib/recording/stamps_in_turn.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>
#include <span>
#include <vector>

namespace zerorate::recording {
namespace {

constexpr std::size_t kMostSensors = 3;

using Stamps = std::span<const std::int64_t>;

bool is_back(Stamps stamps, std::size_t k) {
  return stamps[k] < stamps[k - 1];
}

/// Steps backwards, to a stamp that was there shortly before.
std::size_t count_returns(Stamps stamps) {
  constexpr std::size_t kShortly = 8;
  std::size_t returns = 0;
  for (std::size_t k = 1; k < stamps.size(); ++k) {
    const std::size_t rows = std::min(k, kShortly);
    const Stamps before = stamps.subspan(k - rows, rows);
    const bool returned = std::ranges::find(before, stamps[k]) != before.end();
    returns += is_back(stamps, k) && returned ? 1U : 0U;
  }
  return returns;
}

/// True if nearly no stamp is before the one that is `sensors` rows ahead of it, and one place of
/// the turn has no step backwards.
bool has_turns(Stamps stamps, std::size_t sensors) {
  constexpr std::size_t kOneOf = 50;
  std::size_t disorder = 0;
  std::array<std::size_t, kMostSensors> back{};
  for (std::size_t k = sensors; k < stamps.size(); ++k) {
    disorder += stamps[k] < stamps[k - sensors] ? 1U : 0U;
    back[k % sensors] += is_back(stamps, k) ? 1U : 0U;
  }
  const std::size_t fewest = *std::ranges::min_element(std::span{back}.first(sensors));
  return disorder * kOneOf <= stamps.size() && fewest * kOneOf <= stamps.size();
}

/// True if each sorted stamp is nearer to its place in the file than a turn.
bool is_nearly_sorted(Stamps stamps, Stamps sorted, std::size_t sensors) {
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const std::size_t first = k - std::min(k, sensors - 1);
    const Stamps near = stamps.subspan(first, std::min(k + sensors, stamps.size()) - first);
    if (std::ranges::find(near, sorted[k]) == near.end()) return false;
  }
  return true;
}

/// True if the intervals between sorted stamps are the same from place to place of the turn.
bool is_even(Stamps sorted, std::size_t sensors) {
  constexpr double kUneven = 0.1;
  std::array<std::vector<std::int64_t>, kMostSensors> intervals;
  for (std::size_t k = 1; k < sorted.size(); ++k)
    intervals[k % sensors].push_back(sorted[k] - sorted[k - 1]);
  std::array<std::int64_t, kMostSensors> typical{};
  for (std::size_t place = 0; place < sensors; ++place) {
    const auto middle = intervals[place].begin() + std::ssize(intervals[place]) / 2;
    std::ranges::nth_element(intervals[place], middle);
    typical[place] = *middle;
  }
  const auto [least, most] = std::ranges::minmax(std::span{typical}.first(sensors));
  const std::int64_t turn = std::accumulate(typical.begin(), typical.end(), std::int64_t{0});
  return static_cast<double>(most - least) <= kUneven * static_cast<double>(turn);
}

/// True if rows of one sensor stand in the wrong order within their turns.
bool is_one_sensor(Stamps stamps, std::size_t sensors) {
  std::vector<std::int64_t> sorted{stamps.begin(), stamps.end()};
  std::ranges::sort(sorted);
  return is_nearly_sorted(stamps, sorted, sensors) && is_even(sorted, sensors);
}

bool take_turns(Stamps stamps) {
  constexpr std::size_t kOneOf = 10;
  std::size_t back = 0;
  for (std::size_t k = 1; k < stamps.size(); ++k) back += is_back(stamps, k) ? 1U : 0U;
  if (back * kOneOf < stamps.size()) return false;
  if (count_returns(stamps) * kOneOf >= stamps.size()) return true;
  return std::ranges::any_of(std::array<std::size_t, 2>{2, kMostSensors}, [&](std::size_t sensors) {
    return has_turns(stamps, sensors) && !is_one_sensor(stamps, sensors);
  });
}

}  // namespace

void StampsInTurn::add(std::int64_t stamp_ns) {
  stamps_ += rows_ == 0 || stamp_ns != newest_ns_ ? 1U : 0U;
  back_ += rows_ > 0 && stamp_ns < newest_ns_ ? 1U : 0U;
  ++rows_;
  newest_ns_ = stamp_ns;
  block_[size_++] = stamp_ns;
  if (size_ < block_.size()) return;
  size_ = 0;
  ++blocks_;
  in_turn_ += take_turns(block_) ? 1U : 0U;
}

}  // namespace zerorate::recording
