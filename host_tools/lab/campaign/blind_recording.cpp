#include "host_tools/lab/campaign/blind_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "host_tools/lab/campaign/drive_recording.hpp"
#include "host_tools/lab/campaign/outside_catalogue.hpp"
#include "host_tools/lab/campaign/standstill_recording.hpp"
#include "host_tools/lib/recording/writer.hpp"
#include "host_tools/lib/simulate/sizing/sized_effect.hpp"

namespace zerorate::campaign {
namespace {

using sizing::Draws;
using sizing::EffectEntry;
using sizing::HiddenEffect;
using sizing::RecordingSetting;

/// Classes between which a pair is drawn: within one, two effects can be each other's alternative.
enum class Class : std::uint8_t { slow, coloured, pointwise };

Class class_of(std::string_view effect) {
  constexpr std::array<std::string_view, 3> kColoured = {"periodic_disturbance", "sensor_bandwidth",
                                                         "correlated_noise"};
  constexpr std::array<std::string_view, 6> kPointwise = {"quantization",         "outliers",
                                                          "dropped_samples",      "saturation",
                                                          "motion_contamination", "variable_noise"};
  if (std::ranges::find(kColoured, effect) != kColoured.end()) return Class::coloured;
  if (std::ranges::find(kPointwise, effect) != kPointwise.end()) return Class::pointwise;
  return Class::slow;
}

/// The order in which a sensor and its bus do these things; what adds itself comes first.
int place_in_the_sensor(std::string_view effect) {
  constexpr std::array<std::string_view, 6> kOrder = {
      "sensor_bandwidth", "outliers", "deadband", "saturation", "quantization", "dropped_samples"};
  const auto* const found = std::ranges::find(kOrder, effect);
  return found == kOrder.end() ? -1 : static_cast<int>(found - kOrder.begin());
}

/// Draws the other parameters again where no sizes give so many nats; nothing where that does not
/// help either.
std::optional<std::vector<HiddenEffect>> hide(const std::vector<EffectEntry>& entries,
                                              const RecordingSetting& setting, double nats,
                                              Draws& draws) {
  constexpr int kMostTries = 20;
  for (int attempt = 0; attempt < kMostTries; ++attempt) {
    if (auto effects = size_together(entries, setting, nats, draws)) return effects;
  }
  return std::nullopt;
}

std::vector<EffectEntry> choose(Kind kind, const BlindOptions& options, std::size_t run,
                                Draws& draws) {
  const auto known = sizing::catalogue();
  const auto unknown = outside_catalogue();
  switch (kind) {
    case Kind::clean:
      return {};
    case Kind::single: {
      if (options.only.empty()) return {known[run % Round::kRuns]};
      const auto found = std::ranges::find(known, options.only, &EffectEntry::name);
      if (found == known.end()) throw std::invalid_argument("no effect is called " + options.only);
      return {*found};
    }
    case Kind::pair: {
      const EffectEntry first = known[draws.below(known.size())];
      while (true) {
        const EffectEntry second = known[draws.below(known.size())];
        if (class_of(first.name) != class_of(second.name)) return {first, second};
      }
    }
    case Kind::outside:
      return {
          unknown[(run / Round::kRuns * Round::kOutside + run % Round::kRuns) % unknown.size()]};
  }
  return {};
}

std::string describe(const RecordingSetting& setting, const std::vector<HiddenEffect>& effects) {
  std::string text =
      fmt::format("{:g} Hz, white {:.4f} deg/s, white/flicker {:.1f}", setting.rate_hz(),
                  setting.noise.white_sigma() * sizing::kDegPerRad,
                  setting.noise.white_sigma() / setting.flicker_sigma_rad_s);
  for (const HiddenEffect& effect : effects) {
    text += fmt::format(", {} of size {:.3g}", effect.name, effect.size);
  }
  return text;
}

simulate::Signal compose(const RecordingSetting& setting, std::vector<HiddenEffect> effects) {
  simulate::Signal signal(setting.samples, setting.period_s);
  signal.temperature_degc = setting.temperature_degc;
  for (double& rate : signal.rate_rad_s) rate = setting.bias_rad_s;
  white_noise_of(setting)(signal);
  const auto replaces = [](const HiddenEffect& effect) { return effect.replaces_flicker; };
  if (std::ranges::none_of(effects, replaces)) flicker_noise_of(setting)(signal);
  std::ranges::stable_sort(
      effects, {}, [](const HiddenEffect& effect) { return place_in_the_sensor(effect.name); });
  for (const HiddenEffect& effect : effects) effect.part(signal);
  return signal;
}

std::optional<BlindRecording> try_blind_recording(const BlindOptions& options, std::size_t run,
                                                  const random::RandomStream& stream) {
  RecordingSetting setting = sizing::draw_setting(options.samples, options.rate_hz, stream);
  setting.finest_step_share = options.finest_step_share;
  Draws draws{stream.substream("effects")};
  const Kind kind = options.only.empty() ? kind_of_run(run) : Kind::single;
  const double nats = options.nats * (kind == Kind::outside ? options.outside_factor : 1.0);
  const auto effects = hide(choose(kind, options, run, draws), setting, nats, draws);
  if (!effects) return std::nullopt;
  BlindRecording blind{.kind = kind,
                       .description = describe(setting, *effects),
                       .with_temperature = draws.with_probability(0.5),
                       .signal = compose(setting, *effects)};
  const auto [least, most] = std::ranges::minmax(blind.signal.rate_rad_s);
  if (!(least < most)) return std::nullopt;  // a coarse quantizer has left one level
  for (const HiddenEffect& effect : *effects) {
    blind.truth.push_back(effect.name);
    blind.figures[effect.name] = effect.figures;
    blind.with_temperature |= effect.name.starts_with("temperature");
  }
  return blind;
}

}  // namespace

std::string_view name(Kind kind) {
  constexpr std::array<std::string_view, 4> kNames = {"clean", "single", "pair", "outside"};
  return kNames[static_cast<std::size_t>(kind)];
}

Kind kind_of_run(std::size_t run) {
  const std::size_t place = run % Round::kRuns;
  if (place < Round::kSingles) return Kind::single;
  if (place < Round::kSingles + Round::kClean) return Kind::clean;
  return place < Round::kRuns - Round::kOutside ? Kind::pair : Kind::outside;
}

BlindRecording draw_blind_recording(const BlindOptions& options, std::size_t run) {
  if (options.drives) return draw_drive_recording(options, run);
  if (options.standstills) return draw_standstill_recording(options, run);
  const auto stream = random::RandomStream(options.seed).substream(run);
  // Some base noise hides an effect whatever its size: then another is drawn.
  constexpr std::size_t kMostTries = 20;
  for (std::size_t attempt = 0; attempt < kMostTries; ++attempt) {
    auto blind =
        try_blind_recording(options, run, attempt == 0 ? stream : stream.substream(attempt));
    if (blind) return *std::move(blind);
  }
  throw std::runtime_error(
      fmt::format("run {}: no effect could be made to cost {} nats", run, options.nats));
}

void write_drive(const simulate::ScenarioDrive& drive, const std::filesystem::path& path) {
  recording::Writer writer{path, drive.columns};
  for (const simulate::ScenarioRow& row : drive.rows) writer.write(row.row);
  writer.finish();
}

void write_recording(const BlindRecording& blind, const std::filesystem::path& path) {
  if (blind.drive) {
    write_drive(*blind.drive, path);
    return;
  }
  const simulate::Signal& signal = blind.signal;
  recording::Columns columns{.axis_count = 1, .temperature = blind.with_temperature};
  columns.still = !blind.still.empty();
  columns.acceleration = !blind.acceleration_m_s2.empty();
  recording::Writer writer{path, columns};
  for (std::size_t k = 0; k < signal.size(); ++k) {
    if (signal.missing[k]) continue;
    recording::Row row{.time_ns = std::llround(signal.time_s(k) * 1e9),
                       .rate_rad_s = {static_cast<float>(signal.rate_rad_s[k])},
                       .temperature_degc = static_cast<float>(signal.temperature_degc[k])};
    if (columns.still) row.still = blind.still[k];
    if (columns.acceleration) row.acceleration_m_s2 = blind.acceleration_m_s2[k];
    writer.write(row);
  }
  writer.finish();
}

}  // namespace zerorate::campaign
