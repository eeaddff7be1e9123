// Effects that change single samples, or their distribution.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_tools/lib/simulate/sizing/sized_effect.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::sizing {
namespace {

/// Divergence per sample of rounded normal numbers, of unit variance, from a normal density read at
/// the levels, where the mean may lie anywhere between two levels.
double rounding_loss(double step) {
  constexpr int kPhases = 64;
  const double spread = std::sqrt(1.0 + step * step / 12.0);  // Sheppard's correction
  const int reach = static_cast<int>(std::ceil(9.0 / step)) + 1;
  double loss = 0.0;
  for (int phase = 0; phase < kPhases; ++phase) {
    const double centre = (phase + 0.5) / kPhases - 0.5;  // steps
    for (int level = -reach; level <= reach; ++level) {
      const double from = (level - 0.5 - centre) * step;
      const double mass = statistics::normal_tail(from) - statistics::normal_tail(from + step);
      if (mass < 1e-15) continue;
      const double believed =
          step * statistics::normal_density((level - centre) * step / spread) / spread;
      loss += mass * std::log(mass / believed) / kPhases;
    }
  }
  return loss;
}

}  // namespace

SizedEffect draw_variable_noise(const RecordingSetting& setting, Draws& draws) {
  const double period_s = setting.record_s() / draws.log_uniform(0.7, 8.0);
  return {.name = "variable_noise",
          .at =
              [&setting, period_s](double sigma) {
                const double arw = spectrum::angle_random_walk(sigma * sigma, setting.period_s);
                return part_of(setting, simulate::VariableNoise{arw, period_s});
              },
          // Each sample against the same variance throughout, one step ahead of the filter.
          .loss_nats =
              [&setting, period_s](double sigma) {
                const double steady = setting.noise.innovation_variance();
                double sum = 0.0;
                double sum_of_logs = 0.0;
                for (std::size_t k = 0; k < setting.samples; ++k) {
                  const double time_s = setting.period_s * static_cast<double>(k);
                  const double share = std::sin(std::numbers::pi * time_s / period_s);
                  const double variance = steady + sigma * sigma * share * share;
                  sum += variance;
                  sum_of_logs += std::log(variance);
                }
                const auto n = static_cast<double>(setting.samples);
                return 0.5 * (n * std::log(sum / n) - sum_of_logs);
              },
          .noise_with = [](const BaseNoise& noise,
                           double sigma) { return noise.with_white_noise(0.5 * sigma * sigma); },
          .guess = 0.3 * setting.noise.white_sigma(),
          .figures = [period_s](double) -> Figures {
            return {{"swing_period_s", period_s}};
          }};
}

SizedEffect draw_quantization(const RecordingSetting& setting, Draws& draws) {
  // The base is not asked to know the lattice: its density is read at the steps. What it loses then
  // is little up to about two sigma, and a finer lattice is as plain to see; so the step of the
  // recording is drawn between a tenth of the sized one and that.
  const double finer = draws.log_uniform(setting.finest_step_share, 1.0);
  const double white = setting.noise.white_sigma();
  return {.name = "quantization",
          .at = [&setting, finer](
                    double step) { return part_of(setting, simulate::Quantization{finer * step}); },
          .loss_nats =
              [&setting, white](double step) {
                return static_cast<double>(setting.samples) * rounding_loss(step / white);
              },
          .noise_with =
              [finer](const BaseNoise& noise, double step) {
                return noise.with_white_noise(finer * step * finer * step / 12.0);
              },
          .guess = 2.0 * white,
          .figures = [finer](double step) -> Figures {
            return {{"step_dps", finer * step * kDegPerRad}};
          }};
}

SizedEffect draw_saturation(const RecordingSetting& setting, Draws& /*draws*/) {
  // A density has no mass at a point: the loss is told from cells of a tenth of sigma, as a
  // histogram would. The size is the inverse of the distance of full scale from the bias.
  constexpr double kCell = 0.1;
  const double white = setting.noise.white_sigma();
  const double level = std::abs(setting.bias_rad_s);
  const double sign = setting.bias_rad_s < 0.0 ? -1.0 : 1.0;
  const auto full_scale = [=](double size) { return level + white / size; };
  return {
      .name = "saturation",
      .at = [&setting, full_scale](
                double size) { return part_of(setting, simulate::Saturation{full_scale(size)}); },
      .loss_nats =
          [&setting, white, sign, full_scale](double size) {
            double sum = 0.0;
            for (const double slow : setting.slow_rad_s) {
              const double z = (full_scale(size) - sign * slow) / white;
              const double mass = statistics::normal_tail(z);
              if (mass < 1e-15) continue;
              sum +=
                  mass * std::log(mass / std::max(1e-300, kCell * statistics::normal_density(z)));
            }
            return sum;
          },
      .guess = 0.3};
}

SizedEffect draw_dropped_samples(const RecordingSetting& setting, Draws& draws) {
  // The base is a link that loses one sample in 100,000.
  constexpr double kGoodLink = 1e-5;
  const double mean_run = draws.log_uniform(1.0, 20.0);
  return {.name = "dropped_samples",
          .at =
              [&setting, mean_run](double probability) {
                return part_of(setting, simulate::DroppedSamples{probability, mean_run});
              },
          .loss_nats =
              [&setting](double probability) {
                const double p = std::min(probability, 0.5);
                return static_cast<double>(setting.samples) *
                       (p * std::log(p / kGoodLink) +
                        (1.0 - p) * (std::log1p(-p) - std::log1p(-kGoodLink)));
              },
          .guess = 1e-3,
          .figures = [mean_run](double probability) -> Figures {
            return {{"lost_share", probability / (probability + 1.0 / mean_run)},
                    {"mean_run_samples", mean_run}};
          }};
}

}  // namespace zerorate::sizing
