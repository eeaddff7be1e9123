#include "host_tools/lab/campaign/outside_catalogue.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::campaign {
namespace {

using sizing::BaseNoise;
using sizing::Draws;
using sizing::EffectEntry;
using sizing::RecordingSetting;
using sizing::SizedEffect;
using std::numbers::pi;
using Mean = std::vector<double>;
using Basis = std::vector<Mean>;  ///< contrasts of the functions of one explanation

template <class Function>
Mean contrasts_of(std::size_t samples, Function at_share) {
  Mean mean(samples);
  for (std::size_t k = 0; k < samples; ++k) {
    mean[k] = at_share(static_cast<double>(k) / static_cast<double>(samples));
  }
  return sizing::contrasts(mean);
}

/// Curves that the deterministic effects of the catalogue can draw. Tones around the strongest
/// line.
std::vector<Basis> explanations(const RecordingSetting& setting, const Mean& residual) {
  const std::size_t n = setting.samples;
  std::vector<Basis> all{{contrasts_of(n, [](double share) { return share; })}};
  for (double jump = 1.0 / 48; jump < 1.0; jump += 1.0 / 48) {
    all.push_back({contrasts_of(n, [jump](double share) { return share < jump ? 0.0 : 1.0; })});
  }
  for (double tau = 0.01; tau < 0.6; tau *= 1.8) {
    all.push_back({contrasts_of(n, [tau](double share) { return std::exp(-share / tau); })});
  }
  const Mean linear = sizing::contrasts(setting.temperature_degc);
  Mean squares = setting.temperature_degc;
  for (double& t : squares) t = (t - 25.0) * (t - 25.0);
  all.push_back({linear, sizing::contrasts(squares)});
  std::size_t strongest = 0;
  double most = 0.0;
  for (std::size_t k = 0; k < residual.size(); ++k) {
    const double weight = residual[k] * residual[k] / setting.noise.spectrum()[k];
    if (weight > most) strongest = k, most = weight;
  }
  for (double offset = -0.75; offset <= 0.75; offset += 0.25) {
    const double turns = pi * (static_cast<double>(strongest + 1) + offset);
    all.push_back({contrasts_of(n, [turns](double share) { return std::sin(turns * share); }),
                   contrasts_of(n, [turns](double share) { return std::cos(turns * share); })});
  }
  return all;
}

/// Remainder of a mean function when the catalogue has twice taken what it explains best.
Mean unexplained_part(const RecordingSetting& setting, Mean residual) {
  const BaseNoise& noise = setting.noise;
  for (int round = 0; round < 2; ++round) {
    Mean least = residual;
    for (const Basis& basis : explanations(setting, residual)) {
      Mean left = sizing::beyond(noise.spectrum(), residual, basis);
      if (noise.squared_norm(left) < noise.squared_norm(least)) least = std::move(left);
    }
    residual = std::move(least);
  }
  return residual;
}

/// A mean function of the record, in proportion to the size.
SizedEffect outside_mean(const RecordingSetting& setting, std::string_view name, Mean mean) {
  const auto unit = std::make_shared<Mean>(unexplained_part(setting, sizing::contrasts(mean)));
  return {.name = std::string(name),
          .at =
              [mean = std::move(mean)](double size) {
                return [mean, size](simulate::Signal& signal) {
                  for (std::size_t k = 0; k < mean.size(); ++k) {
                    signal.rate_rad_s[k] += size * mean[k];
                  }
                };
              },
          .loss_nats =
              [&setting, unit](double size) {
                Mean scaled = *unit;
                for (double& contrast : scaled) contrast *= size;
                return setting.noise.loss_with_walk_to_mean(scaled);
              },
          .guess = 10.0 / std::sqrt(setting.noise.squared_norm(*unit))};
}

/// Gamma noise of a shape, centred and of unit variance: skewness 2 / sqrt(shape).
double gamma_density(double x, double shape) {
  const double root = std::sqrt(shape);
  const double y = shape + root * x;
  if (y <= 0.0) return 0.0;
  return root * std::exp((shape - 1.0) * std::log(y) - y - std::lgamma(shape));
}

/// Divergence per sample of skewed from symmetric noise, which has the mean of both its sides.
double loss_of_skewness(double shape) {
  constexpr double kStep = 0.002;
  double sum = 0.0;
  for (double x = -12.0; x < 12.0; x += kStep) {
    const double density = gamma_density(x, shape);
    if (density > 0.0) {
      sum += density * std::log(2.0 * density / (density + gamma_density(-x, shape)));
    }
  }
  return sum * kStep;
}

/// Gamma variable of a shape above 1 (Marsaglia and Tsang 2000).
double draw_gamma(double shape, Draws& draws) {
  const double d = shape - 1.0 / 3.0;
  while (true) {
    const double x = draws.normal();
    const double v = std::pow(1.0 + x / std::sqrt(9.0 * d), 3.0);
    if (v > 0.0 && std::log(draws.uniform(0.0, 1.0)) < 0.5 * x * x + d * (1.0 - v + std::log(v))) {
      return d * v;
    }
  }
}

SizedEffect draw_chirp(const RecordingSetting& setting, Draws& draws) {
  const double from = draws.log_uniform(10.0, 0.05 * static_cast<double>(setting.samples));
  const double to = from * draws.uniform(1.5, 4.0);  // cycles per record
  Mean mean(setting.samples);
  for (std::size_t k = 0; k < mean.size(); ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(mean.size());
    mean[k] = std::sin(2.0 * pi * (from + 0.5 * (to - from) * share) * share);
  }
  return outside_mean(setting, "chirp", std::move(mean));
}

SizedEffect draw_temperature_hysteresis(const RecordingSetting& setting, Draws& draws) {
  // A backlash: the bias follows the temperature only when it has been pushed to the edge.
  const auto [lowest, highest] = std::ranges::minmax(setting.temperature_degc);
  const double half_width_k = draws.uniform(0.15, 0.35) * (highest - lowest);
  Mean mean(setting.samples);
  double follower = setting.temperature_degc.front();
  for (std::size_t k = 0; k < mean.size(); ++k) {
    follower = std::clamp(follower, setting.temperature_degc[k] - half_width_k,
                          setting.temperature_degc[k] + half_width_k);
    mean[k] = follower;
  }
  return outside_mean(setting, "temperature_hysteresis", std::move(mean));
}

SizedEffect draw_sawtooth(const RecordingSetting& setting, Draws& draws) {
  const double teeth = draws.uniform(3.0, 40.0);
  const double phase = draws.uniform(0.0, 1.0);
  Mean mean(setting.samples);
  for (std::size_t k = 0; k < mean.size(); ++k) {
    const double turns = teeth * static_cast<double>(k) / static_cast<double>(mean.size()) + phase;
    mean[k] = turns - std::floor(turns) - 0.5;
  }
  return outside_mean(setting, "sawtooth", std::move(mean));
}

SizedEffect draw_burst_noise(const RecordingSetting& setting, Draws& draws) {
  const auto length = static_cast<std::size_t>(draws.log_uniform(20.0, 100.0));
  const auto bursts = static_cast<std::size_t>(draws.log_uniform(5.0, 20.0));
  std::vector<bool> loud(setting.samples);
  for (std::size_t burst = 0; burst < bursts; ++burst) {
    const std::size_t first = draws.below(setting.samples - length);
    for (std::size_t k = 0; k < length; ++k) loud[first + k] = true;
  }
  const auto count = static_cast<double>(std::ranges::count(loud, true));
  return {.name = "burst_noise",
          .at =
              [loud, stream = setting.stream.substream("burst")](double sigma) {
                return [=](simulate::Signal& signal) {
                  for (std::size_t k = 0; k < loud.size(); ++k) {
                    if (loud[k]) {
                      signal.rate_rad_s[k] += sigma * stream.normal(static_cast<std::int64_t>(k));
                    }
                  }
                };
              },
          // Against one variance throughout; who knows the truth pays for each burst's moment.
          .loss_nats =
              [&setting, count, bursts](double sigma) {
                const auto n = static_cast<double>(setting.samples);
                const double ratio = sigma * sigma / setting.noise.innovation_variance();
                return 0.5 * (n * std::log1p(ratio * count / n) - count * std::log1p(ratio)) -
                       static_cast<double>(bursts) * std::log(n / static_cast<double>(bursts));
              },
          .guess = 2.0 * setting.noise.white_sigma()};
}

SizedEffect draw_skewed_noise(const RecordingSetting& setting, Draws& draws) {
  const double sign = draws.sign();
  // The whole white noise becomes gamma noise. The size is its skewness / 2; below 1 the gamma
  // distribution has a density without a pole.
  return {.name = "skewed_noise",
          .at =
              [&setting, sign](double size) {
                return [sign, shape = 1.0 / (size * size), sigma = setting.noise.white_sigma(),
                        white = alone(setting, white_noise_of(setting)),
                        stream = setting.stream.substream("skew")](simulate::Signal& signal) {
                  Draws numbers{stream};
                  for (std::size_t k = 0; k < signal.size(); ++k) {
                    const double skewed = (draw_gamma(shape, numbers) - shape) / std::sqrt(shape);
                    signal.rate_rad_s[k] += sign * sigma * skewed - white[k];
                  }
                };
              },
          .loss_nats =
              [&setting](double size) {
                return static_cast<double>(setting.samples) *
                       loss_of_skewness(1.0 / std::min(size * size, 1.0));
              },
          .guess = 0.1};
}

SizedEffect draw_deadband(const RecordingSetting& setting, Draws& /*draws*/) {
  // Small rates read as zero. As for saturation, a mass at a point is told from cells of a tenth of
  // sigma. The sensor's bias is taken away, or nothing would be small.
  constexpr double kCell = 0.1;
  return {.name = "deadband",
          .at =
              [bias = setting.bias_rad_s](double width) {
                return [bias, width](simulate::Signal& signal) {
                  for (double& rate : signal.rate_rad_s) {
                    rate -= bias;
                    if (std::abs(rate) < width) rate = 0.0;
                  }
                };
              },
          .loss_nats =
              [&setting](double width) {
                const double white = setting.noise.white_sigma();
                double sum = 0.0;
                for (const double slow : setting.slow_rad_s) {
                  const double centre = (slow - setting.bias_rad_s) / white;
                  const double mass = statistics::normal_tail(centre - width / white) -
                                      statistics::normal_tail(centre + width / white);
                  if (mass < 1e-15) continue;
                  // Nothing is left beside the point: what the cell held before is in the mass.
                  sum += mass * std::log(std::max(
                                    1.0, mass / (kCell * statistics::normal_density(centre))));
                }
                return sum;
              },
          .guess = 0.1 * setting.noise.white_sigma()};
}

}  // namespace

std::span<const EffectEntry> outside_catalogue() {
  static constexpr std::array kEntries = {
      EffectEntry{"chirp", draw_chirp},
      EffectEntry{"temperature_hysteresis", draw_temperature_hysteresis},
      EffectEntry{"sawtooth", draw_sawtooth},
      EffectEntry{"burst_noise", draw_burst_noise},
      EffectEntry{"skewed_noise", draw_skewed_noise},
      EffectEntry{"deadband", draw_deadband}};
  return kEntries;
}

}  // namespace zerorate::campaign
