#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

/// A value and how often it was measured.
struct Level {
  double value = 0.0;
  double count = 0.0;
};

/// Measured values that are neither clipped nor replaced.
std::vector<Level> count_levels(const Hypothesis& hypothesis) {
  std::vector<double> values;
  for (std::size_t k = 0; k < hypothesis.data().size(); ++k) {
    if (!hypothesis.is_replaced()[k]) values.push_back(hypothesis.data().rate_rad_s()[k]);
  }
  std::ranges::sort(values);
  std::vector<Level> levels;
  for (const double value : values) {
    if (levels.empty() || value > levels.back().value) levels.push_back({value, 0.0});
    levels.back().count += 1.0;
  }
  return levels;
}

/// Values that are nearly all different: one that comes again and again.
Tests test_repeated(const FitData& data, const std::vector<Level>& levels) {
  constexpr std::size_t kNeighbours = 8;  // on each side
  double least = 0.0;
  double at = 0.0;
  double places = 0.0;
  for (std::size_t i = kNeighbours; i + kNeighbours < levels.size(); ++i) {
    double around = 0.0;
    for (std::size_t j = i - kNeighbours; j <= i + kNeighbours; ++j) around += levels[j].count;
    around -= levels[i].count;
    places += 1.0;
    // The count of the neighbours is an estimate itself, of at least a half.
    const double mean = (around + 3.0 * std::sqrt(around)) / (2.0 * double{kNeighbours});
    const double log_p = statistics::log_poisson_tail(levels[i].count - 1.0, mean);
    if (log_p >= least) continue;
    least = log_p;
    at = levels[i].value;
  }
  if (places == 0.0) return {};
  return {{fmt::format("the value {:.6g} deg/s occurs far more often than its neighbours",
                       (at + data.median_rad_s()) * kDegPerRad),
           statistics::log_of_smallest(least, places)}};
}

/// The probability of each of the levels within reach of a predicted value, whose error is normal,
/// for values that lie so many times `1 / places` of a step above a level.
class LevelShares {
 public:
  /// @param sigma of a prediction, in steps
  explicit LevelShares(double sigma)
      : places_(std::max<std::ptrdiff_t>(1, std::lround(kPlacesPerSigma / sigma))),
        reach_(static_cast<std::ptrdiff_t>(kReach * sigma) + 2),
        shares_(static_cast<std::size_t>(places_ * width())) {
    auto share = shares_.begin();
    for (std::ptrdiff_t place = 0; place < places_; ++place) {
      const double above = static_cast<double>(place) / static_cast<double>(places_);
      double below = 0.0;
      for (std::ptrdiff_t level = -reach_; level <= reach_; ++level) {
        const double end = (static_cast<double>(level) + 0.5 - above) / sigma;
        const double up_to = 0.5 * std::erfc(-end / std::numbers::sqrt2);
        *share++ = up_to - below;
        below = up_to;
      }
    }
  }

  /// Rounded to a place.
  [[nodiscard]] std::int64_t place_of(double predicted) const {
    return std::llround(predicted * static_cast<double>(places_));
  }

  /// Adds what so many values predicted at a place let each level expect.
  void add(std::int64_t place, double values, std::vector<double>& expected) const {
    const std::ptrdiff_t above = (place % places_ + places_) % places_;
    const std::ptrdiff_t lowest = (place - above) / places_ - reach_;
    const auto levels = static_cast<std::ptrdiff_t>(expected.size());
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, -lowest);
         i < std::min(width(), levels - lowest); ++i) {
      expected[static_cast<std::size_t>(lowest + i)] +=
          values * shares_[static_cast<std::size_t>(above * width() + i)];
    }
  }

 private:
  static constexpr double kReach = 6.0;              // standard deviations
  static constexpr double kPlacesPerSigma = 1024.0;  // a share is off by 1e-7 of itself on average

  [[nodiscard]] std::ptrdiff_t width() const { return 2 * reach_ + 1; }

  std::ptrdiff_t places_;
  std::ptrdiff_t reach_;
  std::vector<double> shares_;  ///< shares of the levels from -reach to reach, place after place
};

/// How many values the noise lets each level of a lattice expect: every value predicted from all
/// others, with a normal error before rounding.
std::vector<double> expected_counts(const Hypothesis& hypothesis, const LevelLattice& lattice,
                                    std::vector<double>& counts) {
  const double information = hypothesis.mean_precision();
  const double rounding = lattice.step * lattice.step / 12.0;
  const LevelShares shares(std::sqrt(std::max(1.0 / information - rounding, rounding)) /
                           lattice.step);
  const std::vector<double>& rate = hypothesis.data().rate_rad_s();
  const std::vector<double>& weighted = hypothesis.precision_weighted_residual();
  const auto levels = static_cast<std::ptrdiff_t>(lattice.counts.size());
  counts.assign(lattice.counts.size(), 0.0);
  std::vector<std::int64_t> places;
  places.reserve(rate.size());
  for (std::size_t k = 0; k < rate.size(); ++k) {
    if (hypothesis.is_replaced()[k]) continue;
    const std::ptrdiff_t level = std::lround((rate[k] - lattice.offset) / lattice.step);
    if (level >= 0 && level < levels) counts[static_cast<std::size_t>(level)] += 1.0;
    const double predicted = rate[k] - weighted[k] / information - lattice.offset;
    places.push_back(shares.place_of(predicted / lattice.step));
  }
  std::ranges::sort(places);
  std::vector<double> expected(lattice.counts.size());
  for (auto first = places.begin(); first != places.end();) {
    const auto end = std::find_if(first, places.end(), [&](auto place) { return place != *first; });
    shares.add(*first, static_cast<double>(end - first), expected);
    first = end;
  }
  return expected;
}

/// How many more values than its neighbours let expect a level may hold, as a share of these: codes
/// of a converter are up to twice as wide as others, and where a step is small beside the noise
/// that changes nothing but the counts.
double allowance_for_converter(const Hypothesis& hypothesis, const LevelLattice& lattice) {
  constexpr double kFinest = 0.05;  // share of the noise; finer steps are no quantization
  constexpr double kWider = 1.5;
  const double steps_of_noise = lattice.step * std::sqrt(hypothesis.mean_precision());
  return steps_of_noise < kFinest ? kWider : 0.0;
}

/// Standard deviations by which a count lies beyond what is due, from none up to the allowance.
double beyond(double count, double due, double allowance, double deviation) {
  const double most = due * (1.0 + allowance);
  if (count > most) return (count - most) / deviation;
  return allowance > 0.0 ? 0.0 : (count - due) / deviation;
}

/// Levels of a lattice, each against what it and two neighbours on each side let expect.
Tests test_lattice(const Hypothesis& hypothesis, const LevelLattice& lattice, bool is_clipped) {
  constexpr double kFewest = 20.0;  // values, for a count to be as good as normal
  const FitData& data = hypothesis.data();
  std::vector<double> counts;
  const std::vector<double> expected = expected_counts(hypothesis, lattice, counts);
  const double allowance = allowance_for_converter(hypothesis, lattice);
  // A pile at an end of the range belongs to another effect.
  const std::size_t margin = is_clipped ? 3 : 2;
  double farthest = 0.0;
  std::size_t at = 0;
  double places = 0.0;
  for (std::size_t i = margin; i + margin < counts.size(); ++i) {
    double near = 0.0;
    double due = 0.0;
    for (const std::size_t j : {i - 2, i - 1, i + 1, i + 2}) {
      near += counts[j];
      due += expected[j];
    }
    if (expected[i] < kFewest || near < kFewest) continue;
    const double share = expected[i] / due;
    places += 1.0;
    const double z =
        beyond(counts[i], share * near, allowance, std::sqrt(share * near * (1.0 + share)));
    if (std::abs(z) <= std::abs(farthest)) continue;
    farthest = z;
    at = i;
  }
  if (places == 0.0) return {};
  const double value = lattice.offset + lattice.step * static_cast<double>(at);
  return {
      {fmt::format("the value {:.6g} deg/s occurs {} often than its neighbours let expect",
                   (value + data.median_rad_s()) * kDegPerRad, farthest > 0.0 ? "more" : "less"),
       statistics::log_of_smallest(statistics::log_normal_tails(farthest), places)}};
}

}  // namespace

Tests test_levels(const StandardisedResidual& residual) {
  const Hypothesis& hypothesis = *residual.hypothesis;
  const FitData& data = hypothesis.data();
  const bool is_clipped = std::ranges::any_of(
      hypothesis.parts(), [](const Part& part) { return !(part.clipped == Range{}); });
  if (!data.lattice()) return test_repeated(data, count_levels(hypothesis));
  return test_lattice(hypothesis, *data.lattice(), is_clipped);
}

}  // namespace zerorate::diagnose
