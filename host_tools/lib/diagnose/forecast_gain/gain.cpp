#include "host_tools/lib/diagnose/forecast_gain/gain.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "host_tools/lib/diagnose/forecast_gain/scores.hpp"
#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/statistics/half_width.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::uint32_t kCycles = 24;      // stops and drives in the part that is judged
constexpr double kLongestCycle_s = 400.0;  // a quarter of it at rest
constexpr std::size_t kFewestBlocks = 8;
using units::kDegPerRad;

core::Duration duration(double seconds) {
  return core::Duration::nanoseconds(std::llround(seconds * 1e9));
}

/// Neighbouring drives share the slow noise: blocks of about the cube root of their number.
BootstrapFigure with_interval(std::size_t size, const statistics::Statistic& statistic,
                              std::uint64_t seed) {
  if (size < kFewestBlocks) return {};
  return statistics::bootstrap(
      size, statistic, random::RandomStream(seed).substream("bootstrap"),
      {.draws = 400, .block = static_cast<std::size_t>(std::cbrt(static_cast<double>(size)))});
}

double rms_heading(const std::vector<ScoredDrive>& drives,
                   const std::vector<std::size_t>& indices) {
  double squares = 0.0;
  for (const std::size_t i : indices) {
    squares += drives[i].integrated_rad * drives[i].integrated_rad;
  }
  return std::sqrt(squares / static_cast<double>(indices.size()));
}

double mean_rsse(const std::vector<ScoredDrive>& drives, const std::vector<std::size_t>& indices) {
  double sum = 0.0;
  for (const std::size_t i : indices) sum += std::sqrt(drives[i].squares_rad2_s2);
  return sum / static_cast<double>(indices.size());
}

/// The spread of the integrated error about its mean, as in the paper's table I.
double ie_deviation(const std::vector<ScoredDrive>& drives,
                    const std::vector<std::size_t>& indices) {
  const auto size = static_cast<double>(indices.size());
  double mean = 0.0;
  for (const std::size_t i : indices) mean += drives[i].integrated_rad / size;
  double squares = 0.0;
  for (const std::size_t i : indices) {
    const double off = drives[i].integrated_rad - mean;
    squares += off * off / size;
  }
  return std::sqrt(squares);
}

double coverage95(const std::vector<ScoredDrive>& drives, const std::vector<std::size_t>& indices) {
  double covered = 0.0;
  for (const std::size_t i : indices) {
    if (std::abs(drives[i].integrated_rad) <= statistics::kHalfWidth95 * drives[i].sigma_rad)
      covered += 1.0;
  }
  return covered / static_cast<double>(indices.size());
}

/// Every second one, unless all are asked for.
template <class One>
std::vector<One> part_of(const std::vector<One>& all, HeldOutPart part) {
  if (part == HeldOutPart::all) return all;
  std::vector<One> chosen;
  for (std::size_t i = part == HeldOutPart::to_choose ? 0 : 1; i < all.size(); i += 2) {
    chosen.push_back(all[i]);
  }
  return chosen;
}

void compare_drives(const std::vector<ScoredDrive>& base, const std::vector<ScoredDrive>& extended,
                    std::uint64_t seed, Gain& gain) {
  using Score = double (*)(const std::vector<ScoredDrive>&, const std::vector<std::size_t>&);
  const auto ratio = [&](Score score) {
    return with_interval(
        base.size(),
        [&](const auto& indices) { return score(extended, indices) / score(base, indices); }, seed);
  };
  const auto of = [&](const std::vector<ScoredDrive>& drives, Score score, double unit) {
    return with_interval(
        drives.size(), [&](const auto& indices) { return unit * score(drives, indices); }, seed);
  };
  gain.rsse_ratio = ratio(mean_rsse);
  gain.ie_ratio = ratio(ie_deviation);
  gain.heading_drift_ratio = ratio(rms_heading);
  gain.heading_drift_base_deg = of(base, rms_heading, kDegPerRad);
  gain.heading_drift_extended_deg = of(extended, rms_heading, kDegPerRad);
  gain.coverage95_base = of(base, coverage95, 1.0);
  gain.coverage95_extended = of(extended, coverage95, 1.0);
}

/// Mean gain of a sample, the ticks gathered in blocks that are nearly independent.
BootstrapFigure log_score_gain(const NodeScores& base, const NodeScores& extended,
                               double samples_per_tick, HeldOutPart part, std::uint64_t seed) {
  constexpr std::size_t kBlocks = 30;
  std::vector<double> gains;
  gains.reserve(base.log_scores.size());
  for (std::size_t k = 0; k < base.log_scores.size(); ++k) {
    gains.push_back((extended.log_scores[k] - base.log_scores[k]) / samples_per_tick);
  }
  const std::size_t length = std::max<std::size_t>(1, gains.size() / kBlocks);
  std::vector<double> blocks;
  blocks.reserve(kBlocks + 1);
  for (std::size_t first = 0; first + length <= gains.size(); first += length) {
    const auto block = std::span{gains}.subspan(first, length);
    blocks.push_back(std::accumulate(block.begin(), block.end(), 0.0) /
                     static_cast<double>(length));
  }
  blocks = part_of(blocks, part);
  return with_interval(
      blocks.size(),
      [&](const auto& indices) {
        double sum = 0.0;
        for (const std::size_t i : indices) sum += blocks[i];
        return sum / static_cast<double>(indices.size());
      },
      seed);
}

}  // namespace

HeldOutDrives::HeldOutDrives(const Record& record, double holdout, std::uint64_t seed)
    : record_(&record), seed_(seed) {
  const identify::RestSamples samples = samples_of(record);
  tick_ = identify::identification_tick(samples);
  means_ = identify::average_ticks(samples, tick_);
  const std::uint32_t all = means_.back().tick + 1;
  judged_from_ = static_cast<std::uint32_t>((1.0 - holdout) * static_cast<double>(all));
}

ScoredTicks HeldOutDrives::cut(double level_step_rad_s) const {
  const std::uint32_t all = means_.back().tick + 1;
  const double tick_s = static_cast<double>(tick_.ns()) * 1e-9;
  const auto longest = static_cast<std::uint32_t>(std::max(4.0, kLongestCycle_s / tick_s));
  const std::uint32_t cycle = std::clamp((all - judged_from_) / kCycles, 4U, longest);
  return {.ticks = means_,
          .rate_rad_s = record_->rate_rad_s,
          .temperature_degc = record_->temperature_degc,
          .level_step_rad_s = level_step_rad_s,
          .sample_period = duration(record_->mean_period_s),
          .tick = tick_,
          .judged_from = judged_from_,
          .stop_ticks = std::max(1U, cycle / 4),
          .drive_ticks = cycle - std::max(1U, cycle / 4)};
}

const NodeScores& HeldOutDrives::scores(const model::SensorModel& model, const ScoredTicks& ticks,
                                        ScoreOf what, Learning learning) {
  const auto known = std::ranges::find_if(scored_, [&](const Scored& scored) {
    return scored.level_step_rad_s == ticks.level_step_rad_s && scored.what == what &&
           scored.learning == learning && scored.model == model;
  });
  if (known != scored_.end()) return known->scores;
  scored_.push_back(
      {model, ticks.level_step_rad_s, what, learning, score(model, ticks, what, learning)});
  return scored_.back().scores;
}

Gain HeldOutDrives::gain(const model::SensorModel& base, const model::SensorModel& extended,
                         HeldOutPart part, Learning learning) {
  const ScoredTicks scored = cut(extended.quantization ? extended.quantization->step_rad_s : 0.0);
  const ScoreOf what = level_of(extended);
  const NodeScores& with_base = scores(base, scored, what, learning);
  const NodeScores& with_extended = scores(extended, scored, what, learning);

  Gain gain{.drive_s =
                static_cast<double>(tick_.ns()) * 1e-9 * static_cast<double>(scored.drive_ticks)};
  double judged_samples = 0.0;
  for (const identify::TickMean& mean : means_) {
    if (mean.tick >= judged_from_) judged_samples += static_cast<double>(mean.samples);
  }
  gain.holdout_samples =
      static_cast<std::size_t>(part == HeldOutPart::all ? judged_samples : 0.5 * judged_samples);
  compare_drives(part_of(with_base.drives, part), part_of(with_extended.drives, part), seed_, gain);
  const double samples_per_tick =
      judged_samples / static_cast<double>(std::max<std::size_t>(1, with_base.log_scores.size()));
  gain.log_score_gain_nats_per_sample =
      log_score_gain(with_base, with_extended, samples_per_tick, part, seed_);
  return gain;
}

Gain measure_gain(const Record& record, const model::SensorModel& base,
                  const model::SensorModel& extended, double holdout, std::uint64_t seed) {
  return HeldOutDrives(record, holdout, seed).gain(base, extended);
}

}  // namespace zerorate::diagnose
