#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

/// A bias that is another from one moment on. The part's shape: the time of the first value after
/// the jump and the interval that it lies in [s from the first value].
class BiasJump final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "bias_jump"; }
  [[nodiscard]] Pace pace() const override { return Pace::slow; }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const double height = fitted.amplitude(0) * kDegPerRad;
    const auto time_s = [&](std::size_t i) {
      return fitted.hypothesis.data().series().start_s + fitted.part().shape[i];
    };
    return {.parameters = {parameter("height_dps", height, fitted.amplitude_error(0) * kDegPerRad),
                           {"time_s", time_s(0), time_s(1), time_s(2)}},
            .sentence = fmt::format("The bias jumps by {:.3g} deg/s at {} s.", height,
                                    units::in_figures(time_s(0), 5)),
            .drawing = drawing_of(fitted)};
  }

  /// Where the bias jumped once it may do so again: a filter that is to follow takes jumps for a
  /// random walk of the same variance. One jump a recording is seen of rates around 1.5 a recording
  /// (the mean for Jeffreys' prior), and of a height that is known to its error.
  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    constexpr double kJumps = 1.5;
    const double height = std::hypot(fitted.amplitude(0), fitted.amplitude_error(0));
    const double walk = height * std::sqrt(kJumps / fitted.hypothesis.data().span_s());
    const double before =
        model.rate_random_walk ? model.rate_random_walk->coefficient_rad_s_per_sqrt_s : 0.0;
    model.rate_random_walk =
        model::RateRandomWalk{.coefficient_rad_s_per_sqrt_s = std::hypot(before, walk)};
  }

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    double crossings = 0.0;
    bool is_second = false;  // the search at the noise that counts
    std::optional<Candidate> candidate = mean_candidate(without, [&](const ColumnSearch& scan) {
      if (std::exchange(is_second, true)) crossings = scan.step_crossings();
      return search(scan);
    });
    if (candidate)
      candidate->surprisal_nats =
          statistics::surprisal_of_search(candidate->gain_nats, 1.0, crossings);
    return candidate;
  }

  [[nodiscard]] std::optional<Part> search(const ColumnSearch& scan) const {
    const std::vector<double> gains = scan.step_gains();
    const auto best = std::ranges::max_element(gains);
    if (*best <= 0.0) return std::nullopt;
    const auto at = static_cast<std::size_t>(best - gains.begin());
    std::size_t lo = at;
    std::size_t hi = at;
    for (std::size_t j = 0; j < gains.size(); ++j) {
      if (gains[j] < *best - kIntervalOfPlace_nats) continue;
      lo = std::min(lo, j);
      hi = std::max(hi, j);
    }
    return Part{.effect = name(),
                .columns = {step_column(scan.data(), at)},
                .shape = {scan.data().time_s(at), scan.data().time_s(lo), scan.data().time_s(hi)}};
  }
};

}  // namespace

std::unique_ptr<Effect> make_bias_jump() {
  return std::make_unique<BiasJump>();
}

}  // namespace zerorate::diagnose
