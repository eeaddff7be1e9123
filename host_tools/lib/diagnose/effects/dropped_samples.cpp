#include <fmt/format.h>

#include <cmath>
#include <string>

#include "host_tools/lib/diagnose/effects/effects.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"

namespace zerorate::diagnose {
namespace {

/// A sound recording misses a sample no more often than this.
constexpr double kSoundRate = 1e-6;

/// Samples that never arrived, by the time stamps and by values that came again.
class DroppedSamples final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "dropped_samples"; }

  [[nodiscard]] std::optional<Offer> examine(const Explanation& without) const override {
    const Losses& losses = without.problem().series().losses;
    if (losses.runs == 0) return std::nullopt;
    // What a sound recording would have lost, against what did not arrive: one Poisson rate.
    const bool in_bursts = losses.in_bursts;
    const auto missing = static_cast<double>(in_bursts ? losses.runs : losses.lost);
    const double due =
        kSoundRate * static_cast<double>(in_bursts ? without.problem().size() : losses.expected);
    const double gain = missing * std::log(missing / due) - (missing - due);
    if (gain <= 0.0) return std::nullopt;
    return Offer{{.effect = name()}, gain, gain};
  }

  [[nodiscard]] Account tell(const Found& found) const override {
    const Losses& losses = found.all.problem().series().losses;
    return losses.in_bursts ? tell_bursts(losses, found.all.problem().series().span_s)
                            : tell_losses(losses);
  }

  /// Time stamps tell the filter; nothing is to be added.
  void extend(const Found& /*found*/, model::SensorModel& /*model*/) const override {}

 private:
  static Account tell_losses(const Losses& losses) {
    const auto runs = static_cast<double>(losses.runs);
    const double share = static_cast<double>(losses.lost) / static_cast<double>(losses.expected);
    const double log_error = 1.0 / std::sqrt(runs);
    const std::string repeated =
        losses.repeated == 0
            ? ""
            : fmt::format(" In the place of {} the sample before came again.", losses.repeated);
    return {
        .parameters = {positive_parameter("lost_share", share, log_error),
                       positive_parameter("mean_run_samples",
                                          static_cast<double>(losses.lost) / runs, log_error)},
        .sentence = fmt::format("{} samples are missing, {:.2g} % of all, in {:.0f} gap{}.{}",
                                losses.lost, 100.0 * share, runs, runs > 1.0 ? "s" : "", repeated)};
  }
  static Account tell_bursts(const Losses& losses, double span_s) {
    const auto gaps = static_cast<double>(losses.runs);
    const double log_error = 1.0 / std::sqrt(gaps);
    return {
        .parameters = {positive_parameter("gaps", gaps, log_error),
                       positive_parameter("mean_gap_s", losses.gaps_s / gaps, log_error)},
        .sentence = fmt::format("The samples come in bursts, as if they were stamped when they "
                                "were read: {:.0f} gaps of {:.2g} s on average take up {:.0f} % "
                                "of the time. How many samples are missing the stamps do not "
                                "tell.",
                                gaps, losses.gaps_s / gaps, 100.0 * losses.gaps_s / span_s)};
  }
};

}  // namespace

std::unique_ptr<Effect> make_dropped_samples() {
  return std::make_unique<DroppedSamples>();
}

}  // namespace zerorate::diagnose
