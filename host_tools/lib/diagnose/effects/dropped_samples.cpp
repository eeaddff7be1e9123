#include <fmt/format.h>

#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/gamma.hpp>
#include <cmath>
#include <string>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

/// A sound recording misses a sample no more often than this.
constexpr double kSoundRate = 1e-6;

/// Samples that never arrived, by the time stamps and by values that came again.
class DroppedSamples final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "dropped_samples"; }
  [[nodiscard]] bool is_in_base() const override { return true; }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const Losses& losses = fitted.hypothesis.data().series().losses;
    return losses.in_bursts ? describe_bursts(losses, fitted.hypothesis.data().series().span_s)
                            : describe_losses(losses);
  }

  /// The filter has the time stamps; nothing is to be added.
  void add_to_model(const FittedPart& /*fitted*/, model::SensorModel& /*model*/) const override {}

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    const Losses& losses = without.data().series().losses;
    if (losses.runs == 0) return std::nullopt;
    // One Poisson rate: losses of a sound recording against those that were found.
    const bool in_bursts = losses.in_bursts;
    const auto missing = static_cast<double>(in_bursts ? losses.runs : losses.lost);
    const double due =
        kSoundRate * static_cast<double>(in_bursts ? without.data().size() : losses.expected);
    const double gain = missing * std::log(missing / due) - (missing - due);
    if (gain <= 0.0) return std::nullopt;
    return Candidate{{.effect = name()}, gain, gain};
  }

  static constexpr double kTail = 0.025;

  /// Runs that are geometrically distributed: that `runs` of them hold `lost` samples is a negative
  /// binomial, whose interval is exact by quantiles of the beta distribution.
  static Parameter mean_run(double runs, double lost) {
    using boost::math::beta_distribution;
    const double most_ends =
        lost > runs ? quantile(beta_distribution<>(runs, lost - runs), 1.0 - kTail) : 1.0;
    const double fewest_ends = quantile(beta_distribution<>(runs, lost - runs + 1.0), kTail);
    return {"mean_run_samples", lost / runs, 1.0 / most_ends, 1.0 / fewest_ends};
  }

  /// The odds are runs begun a sample that arrives (Poisson: Garwood 1936), times the mean run; the
  /// two exact intervals together as Zou and Donner (2008) do.
  static Parameter lost_share(double runs, double lost, double expected) {
    using boost::math::gamma_distribution;
    const double arrived = expected - lost;
    const double fewest = quantile(gamma_distribution<>(runs), kTail);
    const double most = quantile(gamma_distribution<>(runs + 1.0), 1.0 - kTail);
    const Parameter run = mean_run(runs, lost);
    const auto share = [&](double log_factor) {
      const double odds = lost / arrived * std::exp(log_factor);
      return odds / (1.0 + odds);
    };
    return {"lost_share", share(0.0),
            share(-std::hypot(std::log(runs / fewest), std::log(run.value / run.lo))),
            share(std::hypot(std::log(most / runs), std::log(run.hi / run.value)))};
  }

  static Description describe_losses(const Losses& losses) {
    const auto runs = static_cast<double>(losses.runs);
    const auto lost = static_cast<double>(losses.lost);
    const double share = lost / static_cast<double>(losses.expected);
    const std::string repeated =
        losses.repeated == 0
            ? ""
            : fmt::format(" In the place of {} the sample before came again.", losses.repeated);
    return {
        .parameters = {lost_share(runs, lost, static_cast<double>(losses.expected)),
                       mean_run(runs, lost)},
        .sentence = fmt::format("{} samples are missing, {:.2g} % of all, in {:.0f} gap{}.{}",
                                losses.lost, 100.0 * share, runs, runs > 1.0 ? "s" : "", repeated)};
  }
  static Description describe_bursts(const Losses& losses, double span_s) {
    const auto gaps = static_cast<double>(losses.runs);
    const double log_error = 1.0 / std::sqrt(gaps);
    return {.parameters = {positive_parameter("gaps", gaps, log_error),
                           positive_parameter("mean_gap_s", losses.gaps_s / gaps, log_error)},
            .sentence = fmt::format("The samples come in bursts, as if they were stamped when they "
                                    "were read: {:.0f} gaps of {} s on average take up {:.0f} % "
                                    "of the time. How many samples are missing the stamps do not "
                                    "tell.",
                                    gaps, units::in_figures(losses.gaps_s / gaps, 2),
                                    100.0 * losses.gaps_s / span_s)};
  }
};

}  // namespace

std::unique_ptr<Effect> make_dropped_samples() {
  return std::make_unique<DroppedSamples>();
}

}  // namespace zerorate::diagnose
