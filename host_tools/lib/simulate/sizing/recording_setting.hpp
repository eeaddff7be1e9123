/// @file
/// Everything of a blind recording but the effect hidden in it.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/simulate.hpp"
#include "host_tools/lib/simulate/sizing/base_loss.hpp"

namespace zerorate::sizing {

/// Random choices, one after the other.
class Draws {
 public:
  explicit Draws(const random::RandomStream& stream) : stream_(stream) {}

  double uniform(double lo, double hi) { return lo + (hi - lo) * stream_.uniform(next_++); }
  double log_uniform(double lo, double hi) { return std::exp(uniform(std::log(lo), std::log(hi))); }
  double normal() { return stream_.normal(next_++); }
  bool with_probability(double p) { return stream_.uniform(next_++) < p; }
  double sign() { return with_probability(0.5) ? 1.0 : -1.0; }
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>(stream_.bits(next_++) % count);
  }

 private:
  random::RandomStream stream_;
  std::int64_t next_ = 0;
};

/// Sample rate, base noise, bias and temperature of a recording, drawn from its seed.
struct RecordingSetting {
  std::size_t samples = 0;
  double period_s = 0.0;
  BaseNoise noise;  ///< noise of all but the last few samples (see contrasts)
  double flicker_sigma_rad_s = 0.0;
  double bias_rad_s = 0.0;
  std::vector<double> temperature_degc;  ///< smooth, over a few kelvin
  std::vector<double> slow_rad_s;  ///< the bias and the 1/f noise that this recording will have
  random::RandomStream stream;
  double finest_step_share = 0.1;  ///< finest step over the one with the wanted cost

  [[nodiscard]] double record_s() const { return static_cast<double>(samples) * period_s; }
  [[nodiscard]] double rate_hz() const { return 1.0 / period_s; }
};

/// Function that adds a part to a signal.
using Part = std::function<void(simulate::Signal&)>;

/// The effect with the random numbers that it has in this recording, whatever its size.
[[nodiscard]] Part part_of(const RecordingSetting& setting, const simulate::Effect& effect);
[[nodiscard]] Part white_noise_of(const RecordingSetting& setting);
[[nodiscard]] Part flicker_noise_of(const RecordingSetting& setting);

/// Signal of a part alone, at the temperature of the setting.
[[nodiscard]] std::vector<double> alone(const RecordingSetting& setting, const Part& part);

/// @param samples  of the recording
/// @param rate_hz  of its samples; 0: drawn
[[nodiscard]] RecordingSetting draw_setting(std::size_t samples, double rate_hz,
                                            const random::RandomStream& stream);

}  // namespace zerorate::sizing
