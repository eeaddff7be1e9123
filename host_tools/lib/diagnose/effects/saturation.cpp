#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"
#include "host_tools/lib/diagnose/record/level_lattice.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kTieNats = 8.0;  // two continuous values are equal to 1e-4 of sigma by chance
constexpr std::size_t kFewestTies = 3;
constexpr std::size_t kFewestLevels = 8;

/// The end of the measuring range: values pile up at the greatest or the least one. The part's
/// shape: lower and upper end in rad/s (NaN: none) and the number of values there.
class Saturation final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "saturation"; }

  [[nodiscard]] std::optional<Offer> examine(const Explanation& without) const override {
    const Problem& problem = without.problem();
    if (problem.series().is_ticks) return std::nullopt;
    const std::vector<double> values = problem.measured();
    const auto [low, high] = gains_of(values, problem.lattice());
    if (low <= 0.0 && high <= 0.0) return std::nullopt;
    const auto [least, most] = std::ranges::minmax(values);
    Offer offer{.part = {.effect = name(), .shape = {std::nan(""), std::nan(""), 0.0}},
                .gain_nats = low + high,
                .surprise_nats = low + high};
    if (low > 0.0) {
      offer.part.shape[0] = least + problem.median_rad_s();
      offer.part.clipped.lo = least;
    }
    if (high > 0.0) {
      offer.part.shape[1] = most + problem.median_rad_s();
      offer.part.clipped.hi = most;
    }
    for (std::size_t k = 0; k < problem.size(); ++k) {
      if (problem.series().lost[k]) continue;
      const double rate = problem.rate_rad_s()[k];
      if (rate > offer.part.clipped.lo && rate < offer.part.clipped.hi) continue;
      offer.part.replaced.push_back({k, k + 1});
    }
    offer.part.shape[2] = static_cast<double>(offer.part.replaced.size());
    return offer;
  }

  [[nodiscard]] Account tell(const Found& found) const override {
    const std::vector<double>& shape = found.part().shape;
    Account account;
    for (const std::size_t end : {0U, 1U}) {
      if (std::isnan(shape[end])) continue;
      const double value = shape[end] * kDegPerRad;
      account.parameters.push_back(
          {end == 0 ? "lower_end_dps" : "upper_end_dps", value, value, value});
    }
    const Parameter& end = account.parameters.back();
    account.sentence = fmt::format(
        "{:.0f} samples lie at an end of the measuring range, {:.4g} "
        "deg/s: the true rate was beyond.",
        shape[2], end.value);
    account.drawing.effect = name();
    const Problem& problem = found.all.problem();
    for (const Run& run : found.part().replaced) {
      account.drawing.marks.push_back({problem.series().time_s(run.first),
                                       problem.rate_rad_s()[run.first] + problem.median_rad_s()});
    }
    return account;
  }

  /// The end that was not reached is taken to lie opposite, or where the values end.
  void extend(const Found& found, model::SensorModel& model) const override {
    const double lower = found.part().shape[0];
    const double upper = found.part().shape[1];
    const Problem& problem = found.all.problem();
    const auto [least, most] = std::ranges::minmax(problem.rate_rad_s());
    const double reach = most - least;  // beyond what was measured by as much again
    const double median = problem.median_rad_s();
    model.saturation = model::Saturation{
        .lower_rad_s = std::isnan(lower) ? std::min(-upper, median + least - reach) : lower,
        .upper_rad_s = std::isnan(upper) ? std::max(-lower, median + most + reach) : upper};
  }

 private:
  struct Gains {
    double low = 0.0;
    double high = 0.0;
  };

  static Gains gains_of(const std::vector<double>& values,
                        const std::optional<LevelLattice>& lattice) {
    if (!lattice) {
      const ExtremeCounts counts = count_extremes(values);
      return {gain_of_ties(counts.lowest), gain_of_ties(counts.highest)};
    }
    const std::vector<std::size_t>& counts = lattice->counts;
    if (counts.size() < kFewestLevels) return {};
    return {gain_of_pile(counts[0], counts[1]),
            gain_of_pile(counts.back(), counts[counts.size() - 2])};
  }
  static double gain_of_ties(std::size_t count) {
    return count < kFewestTies ? 0.0 : static_cast<double>(count - 1) * kTieNats;
  }
  /// On a lattice the tail falls: the last level holds fewer than the one before. Likelihood ratio
  /// of the binomial share to one half.
  static double gain_of_pile(std::size_t last, std::size_t before) {
    if (last < kFewestTies || last <= before) return 0.0;
    const auto a = static_cast<double>(last);
    const auto b = static_cast<double>(before);
    const double all = a + b;
    const double gain =
        a * std::log(2.0 * a / all) + (before > 0 ? b * std::log(2.0 * b / all) : 0.0);
    constexpr double kChance = 3.0;
    return gain > kChance ? gain : 0.0;
  }
};

}  // namespace

std::unique_ptr<Effect> make_saturation() {
  return std::make_unique<Saturation>();
}

}  // namespace zerorate::diagnose
