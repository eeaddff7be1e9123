#include "host_tests/emulated/pico/scenario.hpp"

#include <algorithm>
#include <cmath>
#include <istream>
#include <numbers>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "host_tools/lib/simulate/simulate.hpp"
#include "host_tools/lib/simulate/vehicle.hpp"

namespace zerorate::emulated {
namespace {

constexpr double kSamplePeriodS = 64.0 / 6667.0;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kLsbRadS = 0.00875 * kRadPerDeg;
/// When the first conversion comes: after the chip's start-up, whatever polls it when.
constexpr std::int64_t kFirstUs = 200'000;

std::int64_t time_us(std::size_t sample) {
  return kFirstUs + std::llround(static_cast<double>(sample) * kSamplePeriodS * 1e6);
}

std::int16_t raw(double lsb) {
  return static_cast<std::int16_t>(std::clamp(std::round(lsb), -32768.0, 32767.0));
}

double temperature_degc(double time_s) {
  return 40.0 - 15.0 * std::exp(-time_s / 200.0);
}

simulate::Signal sensor_axis(std::size_t samples, const random::RandomStream& stream) {
  simulate::Signal signal(samples, kSamplePeriodS);
  for (std::size_t k = 0; k < samples; ++k) {
    signal.temperature_degc.push_back(temperature_degc(signal.time_s(k)));
  }
  const std::vector<simulate::Effect> effects{
      simulate::ConstantBias{.bias_rad_s = 0.4 * kRadPerDeg},
      simulate::WhiteNoise{.angle_random_walk_rad_rt_s = 0.0027 * kRadPerDeg},
      simulate::FlickerNoise{.bias_instability_rad_s = 5.0 / 3600.0 * kRadPerDeg},
      simulate::TemperatureDrift{.linear_rad_s_per_k = 0.002 * kRadPerDeg, .lag_s = 5.0}};
  return simulate::simulate(std::move(signal), effects, stream);
}

}  // namespace

Scenario make_drive(double duration_s, std::uint64_t seed) {
  const random::RandomStream stream(seed);
  const simulate::VehicleParams params{.duration_s = duration_s,
                                       .mean_stop_s = 15.0,
                                       .mean_drive_s = 30.0,
                                       .metres_per_pulse = 0.04};
  const auto motion = simulate::simulate_vehicle(params, kSamplePeriodS, stream);
  std::vector<simulate::Signal> axes;
  for (std::uint64_t i = 0; i < 3; ++i) {
    axes.push_back(sensor_axis(motion.size(), stream.substream(i)));
  }
  Scenario scenario;
  std::int64_t pulses = 0;
  for (std::size_t k = 0; k < motion.size(); ++k) {
    const std::int64_t at = time_us(k);
    const std::int64_t count = motion.odometer_pulses[k] - pulses;
    for (std::int64_t i = 1; k > 0 && i <= count; ++i) {
      const std::int64_t before = time_us(k - 1);
      scenario.push_back({.time_us = before + (at - before) * i / (count + 1), .is_pulse = true});
    }
    pulses = motion.odometer_pulses[k];
    Event sample{.time_us = at};
    for (std::size_t i = 0; i < 3; ++i) {
      sample.rate[i] = raw((axes[i].rate_rad_s[k] + motion.rate_rad_s[k][i]) / kLsbRadS);
    }
    const double since_start_s = static_cast<double>(k) * kSamplePeriodS;
    sample.temperature = raw((temperature_degc(since_start_s) - 25.0) * 256.0);
    scenario.push_back(sample);
  }
  return scenario;
}

Scenario read_scenario(std::istream& in) {
  Scenario scenario;
  std::string text;
  for (int number = 1; std::getline(in, text); ++number) {
    std::istringstream line(text);
    char kind = 0;
    Event event;
    line >> kind >> event.time_us;
    event.is_pulse = kind == 'p';
    if (kind == 's') line >> event.rate[0] >> event.rate[1] >> event.rate[2] >> event.temperature;
    if (!line || (kind != 'p' && kind != 's')) {
      throw std::runtime_error("scenario, line " + std::to_string(number) + ": " + text);
    }
    scenario.push_back(event);
  }
  return scenario;
}

void write_scenario(const Scenario& scenario, std::ostream& out) {
  for (const Event& event : scenario) {
    out << (event.is_pulse ? 'p' : 's') << ' ' << event.time_us;
    if (!event.is_pulse) {
      for (const std::int16_t rate : event.rate) out << ' ' << rate;
      out << ' ' << event.temperature;
    }
    out << '\n';
  }
}

}  // namespace zerorate::emulated
