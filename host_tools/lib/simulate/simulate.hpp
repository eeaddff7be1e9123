/// @file
/// A simulated gyro axis at rest, composed of effects:
///
///     const std::vector<Effect> effects{
///         WhiteNoise{.angle_random_walk_rad_rt_s = 1e-4},
///         FlickerNoise{.bias_instability_rad_s = 3e-5, .order = 0.5}};
///     const Signal signal = simulate(Signal(100'000, 0.01), effects, random::RandomStream(seed));
#pragma once

#include <span>
#include <string_view>
#include <variant>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/bias.hpp"
#include "host_tools/lib/simulate/effects/noise.hpp"
#include "host_tools/lib/simulate/effects/samples.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// One part of a simulated sensor: physical parameters in SI, a kName, and
/// `void apply(Signal&, const random::RandomStream&) const`, which adds the effect to the signal.
using Effect = std::variant<BiasJump, ConstantBias, CorrelatedNoise, DroppedSamples, FlickerNoise,
                            MotionContamination, Outliers, PeriodicDisturbance, Quantization,
                            RandomTelegraphNoise, RateRamp, RateRandomWalk, Relaxation, Saturation,
                            SensorBandwidth, TemperatureDrift, TemperatureRate, VariableNoise,
                            WarmUpTransient, WhiteNoise>;

[[nodiscard]] std::string_view name(const Effect& effect);

/// Applies the effects in the order given: what acts on the whole (bandwidth, saturation,
/// quantization) comes last, as in the sensor. Each effect draws from a stream that depends on the
/// seed, its name and its occurrence only, so that adding an effect leaves the others as they were.
[[nodiscard]] Signal simulate(Signal signal, std::span<const Effect> effects,
                              const random::RandomStream& stream);

}  // namespace zerorate::simulate
