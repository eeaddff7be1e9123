#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/effects/mean_effect.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"
#include "host_tools/lib/statistics/search_significance.hpp"

namespace zerorate::diagnose {
namespace {

/// A bias that is another from one moment on. The part's shape: the first value after the jump and
/// the interval that it lies in.
class BiasJump final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "bias_jump"; }

  [[nodiscard]] std::optional<Offer> examine(const Explanation& without) const override {
    double crossings = 0.0;
    bool is_second = false;  // the search at the noise that counts
    std::optional<Offer> offer = offer_of_mean(without, [&](const MeanScan& scan) {
      if (std::exchange(is_second, true)) crossings = scan.step_crossings();
      return search(scan);
    });
    if (offer)
      offer->surprise_nats = statistics::surprise_of_search(offer->gain_nats, 1.0, crossings);
    return offer;
  }

  [[nodiscard]] Account tell(const Found& found) const override {
    const double height = found.amplitude(0) * kDegPerRad;
    const auto time_s = [&](std::size_t i) {
      return found.all.problem().series().start_s +
             found.part().shape[i] * found.all.problem().period_s();
    };
    return {
        .parameters = {parameter("height_dps", height, found.amplitude_error(0) * kDegPerRad),
                       {"time_s", time_s(0), time_s(1), time_s(2)}},
        .sentence = fmt::format("The bias jumps by {:.3g} deg/s at {:.5g} s.", height, time_s(0)),
        .drawing = drawing_of(found)};
  }

  /// Where the bias jumped once it may do so again: a filter that is to follow takes jumps for a
  /// random walk of the same variance. One jump a recording is seen of rates around 1.5 a recording
  /// (the mean for Jeffreys' prior), and of a height that is known to its error.
  void extend(const Found& found, model::SensorModel& model) const override {
    constexpr double kJumps = 1.5;
    const double height = std::hypot(found.amplitude(0), found.amplitude_error(0));
    const double walk = height * std::sqrt(kJumps / found.all.problem().span_s());
    const double before =
        model.rate_random_walk ? model.rate_random_walk->coefficient_rad_s_per_sqrt_s : 0.0;
    model.rate_random_walk =
        model::RateRandomWalk{.coefficient_rad_s_per_sqrt_s = std::hypot(before, walk)};
  }

 private:
  [[nodiscard]] std::optional<Part> search(const MeanScan& scan) const {
    // The place of a jump is not regular: chi squared's 1.92 nats would be too few (Siegmund 1988).
    constexpr double kInterval = 3.0;
    const std::vector<double> gains = scan.step_gains();
    const auto best = std::ranges::max_element(gains);
    if (*best <= 0.0) return std::nullopt;
    const auto at = static_cast<std::size_t>(best - gains.begin());
    std::size_t lo = at;
    std::size_t hi = at;
    for (std::size_t j = 0; j < gains.size(); ++j) {
      if (gains[j] < *best - kInterval) continue;
      lo = std::min(lo, j);
      hi = std::max(hi, j);
    }
    return Part{
        .effect = name(),
        .columns = {step_column(scan.problem(), at)},
        .shape = {static_cast<double>(at), static_cast<double>(lo), static_cast<double>(hi)}};
  }
};

}  // namespace

std::unique_ptr<Effect> make_bias_jump() {
  return std::make_unique<BiasJump>();
}

}  // namespace zerorate::diagnose
