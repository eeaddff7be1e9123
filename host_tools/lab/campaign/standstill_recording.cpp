#include "host_tools/lab/campaign/standstill_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "host_tools/lib/simulate/sizing/sized_effect.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::campaign {
namespace {

using sizing::Draws;
using sizing::RecordingSetting;

constexpr std::size_t kStandstills = 12;
constexpr double kMovingShare = 0.25;  // share of each standstill, at its beginning
constexpr double kGravity_m_s2 = 9.80665;

/// Force and vibration that the sensor is exposed to, standstill by standstill.
struct Exposure {
  std::vector<std::array<double, 3>> attitude;  ///< specific force [g]
  std::vector<double> vibration_g2;             ///< summed over the axes
};

Exposure draw_exposure(Draws& draws) {
  Exposure exposure;
  for (std::size_t i = 0; i < kStandstills; ++i) {
    std::array<double, 3> up{draws.normal(), draws.normal(), draws.normal()};
    const double length = std::hypot(up[0], up[1], up[2]);
    for (double& one : up) one /= length;
    exposure.attitude.push_back(up);
    exposure.vibration_g2.push_back(draws.log_uniform(1e-4, 3e-2));
  }
  return exposure;
}

std::size_t standstill_of(std::size_t sample, std::size_t samples) {
  return std::min(sample * kStandstills / samples, kStandstills - 1);
}
bool is_moving(std::size_t sample, std::size_t samples) {
  const std::size_t length = samples / kStandstills;
  return static_cast<double>(sample % length) < kMovingShare * static_cast<double>(length);
}

/// A share of the bias in proportion to an input, at the size at which the best base model loses
/// the nats. Only the samples at rest tell of it.
/// @param input  of each standstill
/// @return the factor of the input [rad/s]; nothing if no size does
std::optional<double> add_input(const RecordingSetting& setting, const std::vector<double>& input,
                                double nats, simulate::Signal& signal) {
  std::vector<double> mean(setting.samples);
  for (std::size_t k = 0; k < mean.size(); ++k) mean[k] = input[standstill_of(k, mean.size())];
  const std::vector<double> unit = sizing::contrasts(mean);
  const sizing::SizedEffect effect{.loss_nats =
                                       [&](double size) {
                                         std::vector<double> scaled = unit;
                                         for (double& contrast : scaled) contrast *= size;
                                         return (1.0 - kMovingShare) *
                                                setting.noise.loss_to_mean(scaled);
                                       },
                                   .guess = 10.0 / std::sqrt(setting.noise.squared_norm(unit))};
  const std::optional<double> size = sizing::size_for(effect, nats);
  if (size) {
    for (std::size_t k = 0; k < mean.size(); ++k) signal.rate_rad_s[k] += *size * mean[k];
  }
  return size;
}

/// Deviation of the rate on the move at which a cut toward zero costs the nats: of the samples
/// expected on the level 0, were they rounded, 2 log 2 - 1 each. Nothing where the bias is so large
/// that zero is hardly ever read.
std::optional<double> motion_sigma(const RecordingSetting& setting, double step_rad_s,
                                   double nats) {
  const double wanted = nats / (2.0 * std::numbers::ln2 - 1.0);
  const double moving = kMovingShare * static_cast<double>(setting.samples);
  const auto expected = [&](double sigma) {
    const double away = setting.bias_rad_s / sigma;
    return moving * step_rad_s / sigma * statistics::normal_density(away);
  };
  double least = std::max(std::abs(setting.bias_rad_s), 2.0 * step_rad_s);
  if (expected(least) < wanted) return std::nullopt;
  double most = 2.0 * least;
  while (expected(most) > wanted) most *= 2.0;
  constexpr int kHalvings = 30;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (least + most);
    (expected(middle) > wanted ? least : most) = middle;
  }
  return most;
}

void add_motion(double sigma_rad_s, const random::RandomStream& stream, simulate::Signal& signal) {
  constexpr double kKept = 0.9;
  const double fresh = std::sqrt(1.0 - kKept * kKept) * sigma_rad_s;
  double rate = 0.0;
  for (std::size_t k = 0; k < signal.size(); ++k) {
    rate = kKept * rate + fresh * stream.normal(static_cast<std::int64_t>(k));
    if (is_moving(k, signal.size())) signal.rate_rad_s[k] += rate;
  }
}

void accelerate(const Exposure& exposure, const random::RandomStream& stream,
                BlindRecording& blind) {
  const std::size_t samples = blind.signal.size();
  for (std::size_t k = 0; k < samples; ++k) {
    const std::size_t i = standstill_of(k, samples);
    const double sigma_g = std::sqrt(exposure.vibration_g2[i] / 3.0);
    std::array<float, 3> acceleration{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double noise = stream.normal(static_cast<std::int64_t>(3 * k + axis));
      acceleration[axis] =
          static_cast<float>(kGravity_m_s2 * (exposure.attitude[i][axis] + sigma_g * noise));
    }
    blind.acceleration_m_s2.push_back(acceleration);
    blind.still.push_back(!is_moving(k, samples));
  }
}

std::optional<BlindRecording> try_recording(const BlindOptions& options, std::size_t run,
                                            const random::RandomStream& stream) {
  Draws draws{stream.substream("effects")};
  const double rate_hz = options.rate_hz > 0.0 ? options.rate_hz : draws.log_uniform(25.0, 200.0);
  const RecordingSetting setting = sizing::draw_setting(options.samples, rate_hz, stream);
  const Exposure exposure = draw_exposure(draws);
  const std::size_t place = run % (2 * kStandstillEffects.size());
  const bool is_clean = place >= kStandstillEffects.size();
  const std::string effect{is_clean ? "" : kStandstillEffects[place]};
  BlindRecording blind{.kind = is_clean ? Kind::clean : Kind::single,
                       .signal = {setting.samples, setting.period_s}};
  simulate::Signal& signal = blind.signal;
  signal.temperature_degc = setting.temperature_degc;
  std::ranges::fill(signal.rate_rad_s, setting.bias_rad_s);
  white_noise_of(setting)(signal);
  flicker_noise_of(setting)(signal);
  const double white = setting.noise.white_sigma();
  const double step = white * draws.log_uniform(0.2, 1.2);
  double motion = white * draws.log_uniform(20.0, 200.0);
  std::vector<double> input;
  if (effect == "g_sensitivity") {
    const std::array<double, 3> along{draws.normal(), draws.normal(), draws.normal()};
    for (const auto& up : exposure.attitude) {
      input.push_back(along[0] * up[0] + along[1] * up[1] + along[2] * up[2]);
    }
    const auto size = add_input(setting, input, options.nats, signal);
    if (!size) return std::nullopt;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      blind.figures[effect][fmt::format("along_{}_dps_per_g", "xyz"[axis])] =
          *size * along[axis] * sizing::kDegPerRad;
    }
  } else if (effect == "vibration_rectification") {
    input = exposure.vibration_g2;
    const auto size = add_input(setting, input, options.nats, signal);
    if (!size) return std::nullopt;
    blind.figures[effect]["rectification_dps_per_g2"] = *size * sizing::kDegPerRad;
  } else if (effect == "truncation") {
    const auto sigma = motion_sigma(setting, step, options.nats);
    if (!sigma) return std::nullopt;
    motion = *sigma;
    blind.figures[effect]["step_dps"] = step * sizing::kDegPerRad;
  }
  add_motion(motion, stream.substream("motion"), signal);
  if (effect == "truncation") {
    for (double& rate : signal.rate_rad_s) rate = step * std::trunc(rate / step);
    blind.also = {"quantization"};
  }
  if (!is_clean) blind.truth = {effect};
  blind.description = fmt::format("{:.0f} Hz, white {:.4f} deg/s, white/flicker {:.1f}", rate_hz,
                                  white * sizing::kDegPerRad, white / setting.flicker_sigma_rad_s);
  accelerate(exposure, stream.substream("acceleration"), blind);
  return blind;
}

}  // namespace

BlindRecording draw_standstill_recording(const BlindOptions& options, std::size_t run) {
  const auto stream = random::RandomStream(options.seed).substream("standstills").substream(run);
  constexpr std::size_t kMostTries = 20;
  for (std::size_t attempt = 0; attempt < kMostTries; ++attempt) {
    auto blind = try_recording(options, run, stream.substream(attempt));
    if (blind) return *std::move(blind);
  }
  throw std::runtime_error(
      fmt::format("run {}: no effect could be made to cost {} nats", run, options.nats));
}

}  // namespace zerorate::campaign
