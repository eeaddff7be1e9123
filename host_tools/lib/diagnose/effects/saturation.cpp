#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/record/level_lattice.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

constexpr double kTieNats = 8.0;  // two continuous values are equal to 1e-4 of sigma by chance
constexpr std::size_t kFewestTies = 3;
constexpr std::size_t kFewestLevels = 8;

/// The end of the measuring range: values pile up at the greatest or the least one. The part's
/// shape: lower and upper end in rad/s (NaN: none) and the number of values there.
class Saturation final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "saturation"; }

  [[nodiscard]] std::string_view obstacle(const Hypothesis& without) const override {
    return without.data().series().is_ticks ? kUnevenSamples : std::string_view{};
  }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const std::vector<double>& shape = fitted.part().shape;
    Description description;
    for (const std::size_t end : {0U, 1U}) {
      if (std::isnan(shape[end])) continue;
      const double value = shape[end] * kDegPerRad;
      description.parameters.push_back(
          {end == 0 ? "lower_end_dps" : "upper_end_dps", value, value, value});
    }
    const Parameter& end = description.parameters.back();
    description.sentence = fmt::format(
        "{:.0f} samples lie at an end of the measuring range, {:.4g} "
        "deg/s: the true rate was beyond.",
        shape[2], end.value);
    description.drawing.effect = name();
    const FitData& data = fitted.hypothesis.data();
    for (const Run& run : fitted.part().replaced) {
      description.drawing.marks.push_back(
          {data.series().time_s(run.first), data.rate_rad_s()[run.first] + data.median_rad_s()});
    }
    return description;
  }

  /// The end that was not reached is taken to lie opposite, or where the values end.
  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    const double lower = fitted.part().shape[0];
    const double upper = fitted.part().shape[1];
    const FitData& data = fitted.hypothesis.data();
    const auto [least, most] = std::ranges::minmax(data.rate_rad_s());
    const double reach = most - least;  // beyond what was measured by as much again
    const double median = data.median_rad_s();
    model.saturation = model::Saturation{
        .lower_rad_s = std::isnan(lower) ? std::min(-upper, median + least - reach) : lower,
        .upper_rad_s = std::isnan(upper) ? std::max(-lower, median + most + reach) : upper};
  }

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    const FitData& data = without.data();
    const std::vector<double> values = data.measured();
    const auto [low, high] = gains_of(values, data.lattice());
    if (low <= 0.0 && high <= 0.0) return std::nullopt;
    const auto [least, most] = std::ranges::minmax(values);
    Candidate candidate{.part = {.effect = name(), .shape = {std::nan(""), std::nan(""), 0.0}},
                        .gain_nats = low + high,
                        .surprisal_nats = low + high};
    if (low > 0.0) {
      candidate.part.shape[0] = least + data.median_rad_s();
      candidate.part.clipped.lo = least;
    }
    if (high > 0.0) {
      candidate.part.shape[1] = most + data.median_rad_s();
      candidate.part.clipped.hi = most;
    }
    for (std::size_t k = 0; k < data.size(); ++k) {
      if (data.series().lost[k]) continue;
      const double rate = data.rate_rad_s()[k];
      if (rate > candidate.part.clipped.lo && rate < candidate.part.clipped.hi) continue;
      candidate.part.replaced.push_back({k, k + 1});
    }
    candidate.part.shape[2] = static_cast<double>(candidate.part.replaced.size());
    return candidate;
  }

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
