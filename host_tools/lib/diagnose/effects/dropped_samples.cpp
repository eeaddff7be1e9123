#include <fmt/format.h>

#include <cmath>

#include "host_tools/lib/diagnose/effects/effects.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"

namespace zerorate::diagnose {
namespace {

/// A sound recording misses a sample no more often than this.
constexpr double kSoundRate = 1e-6;

/// Samples that never arrived, by the time stamps.
class DroppedSamples final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "dropped_samples"; }

  [[nodiscard]] std::optional<Offer> examine(const Explanation& without) const override {
    const Losses& losses = without.problem().series().losses;
    if (losses.runs == 0) return std::nullopt;
    const auto runs = static_cast<double>(losses.runs);
    const auto expected = static_cast<double>(losses.expected);
    const double gain =
        runs * std::log(runs / expected / kSoundRate) - (runs - kSoundRate * expected);
    if (gain <= 0.0) return std::nullopt;
    return Offer{{.effect = name()}, gain, gain};
  }

  [[nodiscard]] Account tell(const Found& found) const override {
    const Losses& losses = found.all.problem().series().losses;
    const auto runs = static_cast<double>(losses.runs);
    const double share = static_cast<double>(losses.lost) / static_cast<double>(losses.expected);
    const double mean_run = static_cast<double>(losses.lost) / runs;
    const double log_error = 1.0 / std::sqrt(runs);
    Account account{.parameters = {positive_parameter("lost_share", share, log_error),
                                   positive_parameter("mean_run_samples", mean_run, log_error)}};
    account.sentence =
        losses.is_uneven
            ? fmt::format(
                  "The samples come in bursts: {:.0f} gaps lie between them, and {:.0f} % of "
                  "what the usual interval promises is missing.",
                  runs, 100.0 * share)
            : fmt::format("{} samples are missing, {:.2g} % of all, in {:.0f} gaps.", losses.lost,
                          100.0 * share, runs);
    return account;
  }

  /// Time stamps tell the filter; nothing is to be added.
  void extend(const Found& /*found*/, model::SensorModel& /*model*/) const override {}
};

}  // namespace

std::unique_ptr<Effect> make_dropped_samples() {
  return std::make_unique<DroppedSamples>();
}

}  // namespace zerorate::diagnose
