#include "host_tools/lib/diagnose/materiality.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "host_tools/lib/diagnose/forecast_gain/scores.hpp"
#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"
#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/parallel/parallel.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::array kDrives_s = {10.0, 60.0, 300.0};
constexpr std::size_t kFewestDrives = 8;
constexpr std::uint32_t kFewestTicks = 4;  // ticks of a drive
constexpr double kLearning = 0.1;          // share of the record before the first drive
constexpr std::size_t kSimulations = 16;
/// Two-sided 95 % for three lengths, of Student's distribution with 15 degrees of freedom.
constexpr double kStudent = 2.69;

core::Duration duration(double seconds) {
  return core::Duration::nanoseconds(std::llround(seconds * 1e9));
}

/// A tick of whole samples.
class Ticks {
 public:
  explicit Ticks(const FitData& data) : period_s_(data.period_s()) {
    const core::Duration tick =
        identify::identification_tick(duration(data.span_s()), duration(period_s_));
    samples_ = static_cast<std::size_t>(
        std::max(1.0, std::round(static_cast<double>(tick.ns()) * 1e-9 / period_s_)));
    size_ = spectrum::fast_length_below(data.size() / samples_);
    temperature_ = data.series().temperature_degc;
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t samples() const { return samples_; }
  [[nodiscard]] double tick_s() const { return period_s_ * static_cast<double>(samples_); }

  [[nodiscard]] std::vector<identify::TickMean> means_of(std::span<const double> values) const {
    std::vector<identify::TickMean> means(size_);
    for (std::size_t k = 0; k < size_; ++k) {
      double sum = 0.0;
      for (const double value : values.subspan(k * samples_, samples_)) sum += value;
      means[k].tick = static_cast<std::uint32_t>(k);
      means[k].samples = static_cast<std::uint32_t>(samples_);
      means[k].rate_rad_s[0] = static_cast<float>(sum / static_cast<double>(samples_));
    }
    return means;
  }

  /// Stops and drives over ticks; a quarter of the time at rest.
  [[nodiscard]] ScoredTicks cut(std::span<const identify::TickMean> means, double drive_s) const {
    const auto drive = static_cast<std::uint32_t>(std::round(drive_s / tick_s()));
    return {.ticks = means,
            .temperature_degc = temperature_,
            .sample_period = duration(period_s_),
            .tick = duration(tick_s()),
            .judged_from = static_cast<std::uint32_t>(kLearning * static_cast<double>(size_)),
            .stop_ticks = std::max(1U, drive / 3),
            .drive_ticks = drive};
  }

  /// Number of drives of a length that fit; none where one has too few ticks.
  [[nodiscard]] std::size_t drives(double drive_s) const {
    const auto drive = static_cast<std::size_t>(std::round(drive_s / tick_s()));
    if (drive < kFewestTicks) return 0;
    const auto rest = (1.0 - kLearning) * static_cast<double>(size_);
    return static_cast<std::size_t>(
        rest / static_cast<double>(drive + std::max<std::size_t>(1, drive / 3)));
  }

 private:
  double period_s_;
  std::size_t samples_ = 1;
  std::size_t size_ = 0;
  std::span<const double> temperature_;  ///< temperature of each sample; empty where there is none
};

/// Model without single disturbed samples, which neither the record nor the simulations hold.
model::SensorModel of_ticks(model::SensorModel model) {
  model.outliers.reset();
  model.motion_contamination.reset();
  model.variable_noise.reset();
  model.saturation.reset();
  return model;
}

double log_rms_heading(const model::SensorModel& model, const ScoredTicks& ticks) {
  double squares = 0.0;
  const std::vector<ScoredDrive> drives = score_drives(model, ticks);
  for (const ScoredDrive& drive : drives) squares += drive.integrated_rad * drive.integrated_rad;
  return 0.5 * std::log(squares / static_cast<double>(drives.size()));
}

/// Draws tick means by the density of a hypothesis, its mean functions included. The mean of m
/// samples keeps the share D = sin(m w/2) / (m sin(w/2)) of a coefficient at the frequency w. In
/// the DCT of N ticks it is coefficient k, 2 N - k, 2 N + k, ... that fall together.
class Simulator {
 public:
  Simulator(const Hypothesis& hypothesis, const Ticks& ticks)
      : transform_(ticks.size()),
        means_(
            ticks.means_of(hypothesis.data().transform().inverse(mean_coefficients(hypothesis)))),
        sigma_(ticks.size()),
        stream_(random::RandomStream(hypothesis.data().seed()).substream("materiality")) {
    const std::vector<double>& density = hypothesis.density();
    const std::size_t turn = 2 * ticks.size();
    const auto samples = static_cast<double>(ticks.samples());
    for (std::size_t k = 1; k < density.size(); ++k) {
      const std::size_t folded = std::min(k % turn, turn - k % turn);
      if (folded == 0 || folded == ticks.size()) continue;
      const double half =
          0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(density.size());
      const double kept = std::sin(samples * half) / (samples * std::sin(half));
      sigma_[folded] += kept * kept * density[k] / samples;
    }
    for (double& sigma : sigma_) sigma = std::sqrt(sigma);
  }

  [[nodiscard]] std::vector<identify::TickMean> ticks(std::size_t run) const {
    std::vector<double> coefficients(sigma_.size());
    stream_.substream(run).fill_normal(0, coefficients);
    for (std::size_t k = 0; k < coefficients.size(); ++k) coefficients[k] *= sigma_[k];
    const std::vector<double> noise = transform_.inverse(coefficients);
    std::vector<identify::TickMean> ticks = means_;
    for (std::size_t k = 0; k < ticks.size(); ++k) {
      ticks[k].rate_rad_s[0] += static_cast<float>(noise[k]);
    }
    return ticks;
  }

 private:
  spectrum::CosineTransform transform_;
  std::vector<identify::TickMean> means_;  ///< tick means of the mean functions
  std::vector<double> sigma_;              ///< sigma of the coefficients of the tick means
  random::RandomStream stream_;
};

/// Ratio of a measured figure to simulated ones, all as logarithms.
BootstrapFigure ratio_of(double measured, std::span<const double> simulated) {
  const auto count = static_cast<double>(simulated.size());
  double mean = 0.0;
  for (const double one : simulated) mean += one / count;
  double squares = 0.0;
  for (const double one : simulated) squares += (one - mean) * (one - mean);
  const double spread = std::sqrt(squares / (count - 1.0) * (1.0 + 1.0 / count));
  const double off = measured - mean;
  return {std::exp(off), std::exp(off - kStudent * spread), std::exp(off + kStudent * spread)};
}

}  // namespace

std::optional<Materiality> weigh_remainder(const Hypothesis& hypothesis,
                                           const model::SensorModel& given) try {
  const Ticks ticks(hypothesis.data());
  const model::SensorModel model = of_ticks(given);
  const auto measured = ticks.means_of(hypothesis.repaired_values());
  Materiality materiality;
  std::vector<double> logs;
  for (const double drive_s : kDrives_s) {
    const std::size_t drives = ticks.drives(drive_s);
    if (drives < kFewestDrives) continue;
    logs.push_back(log_rms_heading(model, ticks.cut(measured, drive_s)));
    materiality.by_drive.push_back({.drive_s = drive_s, .drives = drives});
  }
  if (logs.empty()) return std::nullopt;
  const Simulator simulator(hypothesis, ticks);
  std::vector<std::vector<double>> simulated(logs.size(), std::vector<double>(kSimulations));
  const auto simulate = [&](std::size_t run) {
    const auto means = simulator.ticks(run);
    for (std::size_t i = 0; i < logs.size(); ++i) {
      simulated[i][run] = log_rms_heading(model, ticks.cut(means, materiality.by_drive[i].drive_s));
    }
  };
  parallel::for_each(kSimulations, parallel::kAllThreads, simulate, {});
  for (std::size_t i = 0; i < logs.size(); ++i) {
    materiality.by_drive[i].ratio = ratio_of(logs[i], simulated[i]);
  }
  return materiality;
} catch (const ModelCannotRun&) {
  return std::nullopt;
}

}  // namespace zerorate::diagnose
