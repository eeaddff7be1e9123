#include "host_tools/lib/fleet/simulated_fleet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host_tools/lib/fleet/analysis.hpp"
#include "host_tools/lib/fleet/database.hpp"
#include "host_tools/lib/output/output_file.hpp"
#include "host_tools/lib/parallel/parallel.hpp"
#include "host_tools/lib/recording/writer.hpp"
#include "host_tools/lib/simulate/sizing/sized_effect.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::fleet {
namespace {

using sizing::Draws;
using sizing::kDegPerRad;
using sizing::RecordingSetting;

constexpr std::size_t kAxes = recording::kMaxAxes;

/// Noise of one axis, in the unit of each option.
struct AxisTruth {
  double white_dps_per_sqrt_hz = 0.0;
  double flicker_dph = 0.0;
  double order = 0.0;
};

struct SensorTruth {
  std::size_t lot = 0;
  bool is_of_bad_lot = false;
  std::array<AxisTruth, kAxes> axes{};
  std::optional<std::size_t> hidden_axis;
};

/// A quantity of all axes of a sensor.
std::array<double, kAxes> draw(const Lognormal& quantity, double common_share, Draws& draws) {
  std::array<double, kAxes> values{};
  const double common = std::sqrt(common_share) * draws.normal();
  for (double& value : values) {
    const double deviation = common + std::sqrt(1.0 - common_share) * draws.normal();
    value = quantity.median * std::exp(quantity.log_sigma * deviation);
  }
  return values;
}

/// The effect in one recording, or nothing where no size gives the nats.
std::optional<sizing::Part> draw_effect(const RecordingSetting& setting, double nats, Draws& draws,
                                        std::string& name) {
  const auto catalogue = sizing::catalogue();
  constexpr int kMostTries = 20;
  for (int attempt = 0; attempt < kMostTries; ++attempt) {
    const sizing::EffectEntry& entry = catalogue[draws.below(catalogue.size())];
    if (entry.name == "fractional_order") continue;  // the order is the population's
    const sizing::SizedEffect effect = entry.draw(setting, draws);
    if (const auto size = sizing::size_for(effect, nats)) {
      name = effect.name;
      return effect.at(*size);
    }
  }
  return std::nullopt;
}

class Fleet {
 public:
  Fleet(const SimulatedFleetOptions& options, const std::filesystem::path& folder)
      : options_(options), folder_(folder), truth_(options.sensors * options.recordings) {}

  void write_recording(std::size_t index) {
    const std::size_t sensor = index / options_.recordings;
    const SensorTruth truth = sensor_truth(sensor);
    const random::RandomStream stream =
        stream_of(sensor).substream(1 + static_cast<std::uint64_t>(index % options_.recordings));
    std::array<std::string, kAxes> effects;
    std::vector<simulate::Signal> signals;
    std::vector<double> temperature_degc;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      // All axes feel one temperature.
      RecordingSetting setting =
          sizing::draw_setting(options_.samples, options_.rate_hz, stream.substream("sensor"));
      temperature_degc = setting.temperature_degc;
      signals.push_back(signal_of(truth, axis, stream.substream(axis), setting, effects[axis]));
    }
    write(index, signals, temperature_degc);
    truth_[index] = describe(index, truth, effects);
  }

  void write_lists() const {
    std::string list = "recording,sensor,lot\n";
    std::string truth =
        "recording,sensor,lot,lot_is_bad,axis,white_dps_per_sqrt_hz,flicker_dph,order,effect\n";
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      const std::size_t sensor = i / options_.recordings;
      list +=
          fmt::format("{},{},{}\n", file_name(i), sensor_name(sensor), lot_name(lot_of(sensor)));
      truth += truth_[i];
    }
    output::write_file(folder_ / kListName, list);
    output::write_file(folder_ / "truth.csv", truth);
  }

 private:
  [[nodiscard]] random::RandomStream stream_of(std::size_t sensor) const {
    return random::RandomStream{options_.seed}.substream("fleet").substream(sensor);
  }
  [[nodiscard]] std::size_t lot_of(std::size_t sensor) const {
    return sensor * options_.lots / options_.sensors;
  }
  static std::string lot_name(std::size_t lot) { return fmt::format("L{:02}", lot + 1); }
  static std::string sensor_name(std::size_t sensor) { return fmt::format("S{:05}", sensor + 1); }
  [[nodiscard]] std::string file_name(std::size_t index) const {
    return fmt::format("{}-{}.csv.gz", sensor_name(index / options_.recordings),
                       index % options_.recordings + 1);
  }

  [[nodiscard]] SensorTruth sensor_truth(std::size_t sensor) const {
    Draws lots{random::RandomStream{options_.seed}.substream("bad lot")};
    const std::size_t bad_lot = lots.below(options_.lots);
    Draws draws{stream_of(sensor).substream("population")};
    SensorTruth truth{.lot = lot_of(sensor)};
    truth.is_of_bad_lot = truth.lot == bad_lot && options_.bad_lot_factor != 1.0;
    const double factor = truth.is_of_bad_lot ? options_.bad_lot_factor : 1.0;
    const auto white = draw(options_.white_dps_per_sqrt_hz, options_.common_share, draws);
    const auto flicker = draw(options_.flicker_dph, options_.common_share, draws);
    const auto order = draw(options_.order, options_.common_share, draws);
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      truth.axes[axis] = {factor * white[axis], factor * flicker[axis],
                          std::min(order[axis], 0.94)};
    }
    if (draws.with_probability(options_.hidden_share)) truth.hidden_axis = draws.below(kAxes);
    return truth;
  }

  [[nodiscard]] simulate::Signal signal_of(const SensorTruth& truth, std::size_t axis,
                                           const random::RandomStream& stream,
                                           RecordingSetting& setting, std::string& effect) const {
    const AxisTruth& noise = truth.axes[axis];
    const double white_rad = noise.white_dps_per_sqrt_hz / kDegPerRad;
    const double flicker_rad = noise.flicker_dph / 3600.0 / kDegPerRad;
    Draws draws{stream.substream("axis")};
    setting.stream = stream;
    setting.bias_rad_s = 0.5 * draws.normal() / kDegPerRad;
    // The base that sizes effects has the order 1/2; it is as strong where the node compares.
    setting.flicker_sigma_rad_s = flicker_rad * std::pow(Grid::kPivot_rad_s, 0.5 - noise.order);
    setting.noise =
        sizing::BaseNoise(spectrum::fast_length_below(options_.samples),
                          white_rad * std::sqrt(options_.rate_hz), setting.flicker_sigma_rad_s);
    const sizing::Part flicker = sizing::part_of(
        setting,
        simulate::FlickerNoise{.bias_instability_rad_s = flicker_rad, .order = noise.order});
    setting.slow_rad_s = sizing::alone(setting, flicker);
    for (double& rate : setting.slow_rad_s) rate += setting.bias_rad_s;

    simulate::Signal signal(options_.samples, setting.period_s);
    signal.temperature_degc = setting.temperature_degc;
    signal.rate_rad_s = setting.slow_rad_s;
    sizing::part_of(setting, simulate::WhiteNoise{white_rad})(signal);
    if (truth.hidden_axis == axis) {
      if (const auto part = draw_effect(setting, options_.nats, draws, effect)) (*part)(signal);
    }
    return signal;
  }

  void write(std::size_t index, const std::vector<simulate::Signal>& signals,
             const std::vector<double>& temperature_degc) const {
    recording::Writer writer{folder_ / file_name(index), {.temperature = true}};
    for (std::size_t k = 0; k < options_.samples; ++k) {
      recording::Row row;
      row.time_ns = std::llround(signals.front().time_s(k) * 1e9);
      row.temperature_degc = static_cast<float>(temperature_degc[k]);
      for (std::size_t axis = 0; axis < kAxes; ++axis) {
        row.rate_rad_s[axis] = signals[axis].missing[k]
                                   ? std::numeric_limits<float>::quiet_NaN()
                                   : static_cast<float>(signals[axis].rate_rad_s[k]);
      }
      writer.write(row);
    }
    writer.finish();
  }

  [[nodiscard]] std::string describe(std::size_t index, const SensorTruth& truth,
                                     const std::array<std::string, kAxes>& effects) const {
    std::string lines;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      const AxisTruth& one = truth.axes[axis];
      lines += fmt::format("{},{},{},{:d},{},{:.8g},{:.8g},{:.8g},{}\n", file_name(index),
                           sensor_name(index / options_.recordings), lot_name(truth.lot),
                           truth.is_of_bad_lot, "xyz"[axis], one.white_dps_per_sqrt_hz,
                           one.flicker_dph, one.order, effects[axis]);
    }
    return lines;
  }

  const SimulatedFleetOptions& options_;
  const std::filesystem::path& folder_;
  std::vector<std::string> truth_;
};

}  // namespace

void simulate_fleet(const SimulatedFleetOptions& options, const std::filesystem::path& folder,
                    const std::function<void(double)>& on_progress) {
  if (options.sensors == 0 || options.recordings == 0 || options.lots == 0) {
    throw std::invalid_argument("a fleet needs at least one sensor, recording and lot");
  }
  std::filesystem::create_directories(folder);
  Fleet fleet{options, folder};
  parallel::for_each(
      options.sensors * options.recordings, options.jobs,
      [&](std::size_t i) { fleet.write_recording(i); }, on_progress);
  fleet.write_lists();
}

}  // namespace zerorate::fleet
