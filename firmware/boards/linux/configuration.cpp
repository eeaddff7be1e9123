#include "firmware/boards/linux/configuration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "firmware/boards/linux/configuration_tables.hpp"
#include "firmware/model/catalogue.hpp"
#include "firmware/model/model_file.hpp"
#include "firmware/model/node_model.hpp"
#include "firmware/toml/strict_table.hpp"

namespace zerorate::linux_node {
namespace {

using toml_file::ErrorList;
using toml_file::Presence;
using toml_file::Rule;
using toml_file::StrictTable;

constexpr Rule kFilterRate{[](double x) { return x >= 1e-3 && x <= 1e6; },
                           "a rate in Hz, from 0.001 to 1 000 000"};
constexpr Rule kLatitude{[](double x) { return x >= -90.0 && x <= 90.0; },
                         "degrees from -90 to 90, north positive"};
constexpr Rule kInterval{[](double x) { return x >= 1.0 && x <= 1e6; },
                         "seconds, from 1 to 1 000 000"};
constexpr Rule kPriority{[](double x) { return x >= 0.0 && x <= 99.0; },
                         "a whole number from 0 to 99"};

core::StandstillSource read_source(StrictTable& table) {
  static constexpr std::array<std::string_view, 3> kSources{"odometer", "gyro", "odometer-alone"};
  return static_cast<core::StandstillSource>(
      table.choice("source", kSources, Presence::optional).value_or(0));
}

/// @param measures_vertical whether the axis may be left to the accelerometer
/// @param up the axis that [reference] states, if there is one; becomes that of the table
core::EarthRate read_earth(StrictTable& table, bool measures_vertical,
                           std::optional<core::UpAxis>& up) {
  const double latitude = *table.number("latitude_deg", kLatitude, Presence::required);
  const auto stated = read_up(table, Presence::optional);
  const core::UpAxis of_earth = stated.value_or(core::UpAxis{});
  if (!stated && measures_vertical) {
    return core::earth_rate(static_cast<float>(latitude), up.value_or(core::UpAxis{}));
  }
  if (up.value_or(of_earth) != of_earth) {
    table.fail_at("up",
                  "not the axis of \"up\" in [reference] or [[sink]], and a sensor has one; "
                  "expected the same in both, and z where it is absent");
  }
  up = of_earth;
  return core::earth_rate(static_cast<float>(latitude), of_earth);
}

/// @param told  becomes the name or the file
model::SensorModel read_sensor_model(StrictTable& table, const std::string& chip,
                                     std::string& told) {
  const auto file = name_at(table, "file", Presence::optional);
  const auto name = name_at(table, "name", Presence::optional);
  if (file && name) table.fail_at("file", "not beside \"name\": one of the two");
  told = file ? *file : name.value_or(chip);
  if (!file) return at_key(table, "name", [&] { return model::find_model(name.value_or(chip)); });
  try {
    return model::read_model(*file);
  } catch (const std::system_error& error) {
    table.fail_at("file", error.what());
  }
}

struct FilterSettings {
  double rate_hz = 2.0;
  core::Standstill::Params standstill;
  app::Predictor published = app::Predictor::kalman;
};

void read_filter(StrictTable& table, FilterSettings& filter, ErrorList& errors) {
  errors.attempt([&] {
    filter.rate_hz =
        table.number("rate_hz", kFilterRate, Presence::optional).value_or(filter.rate_hz);
  });
  const auto read_seconds = [&](std::string_view key, core::Duration& duration) {
    errors.attempt([&] {
      const auto seconds = table.number(key, kSeconds, Presence::optional);
      if (seconds) duration = duration_of(*seconds);
    });
  };
  read_seconds("settle_s", filter.standstill.settle);
  read_seconds("hold_back_s", filter.standstill.hold_back);
  errors.attempt([&] {
    static constexpr std::array<std::string_view, app::kPredictors> kPredictors{
        "kalman", "moving_average", "calibration_mean"};
    filter.published = static_cast<app::Predictor>(
        table.choice("predictor", kPredictors, Presence::optional).value_or(0));
  });
}

/// The node's coefficients; what is impossible about them is reported at the filter's table.
Node::Params make_params(const StrictTable& root, const model::SensorModel& sensor,
                         const FilterSettings& filter, double sample_rate_hz) {
  if (filter.rate_hz > sample_rate_hz) {
    root.fail_at("filter", "rate_hz may not exceed the gyro's");
  }
  const core::Duration period = duration_of(1.0 / sample_rate_hz);
  const core::Duration tick = std::max(period, duration_of(1.0 / filter.rate_hz));
  const Node::Params params{
      .model = at_key(root, "model",
                      [&] {
                        return model::make_node_model<model::kWidestLearningShape>(sensor, period,
                                                                                   tick);
                      }),
      .standstill = filter.standstill,
      .published = filter.published};
  if (const auto possible = Node::check(params); !possible) {
    root.fail_at("filter", "hold_back_s is longer than the node can hold at this rate_hz");
  }
  return params;
}

void read_state(StrictTable& table, StateSettings& state) {
  state.file = *name_at(table, "file", Presence::required);
  state.save_interval =
      duration_of(table.number("save_interval_s", kInterval, Presence::optional).value_or(60.0));
}

void read_real_time(StrictTable& table, RealTimeSettings& real_time) {
  real_time.priority =
      static_cast<int>(table.integer("priority", kPriority, Presence::optional).value_or(0));
  real_time.lock_memory = table.boolean("lock_memory", Presence::optional).value_or(true);
}

SinkSettings read_sink(StrictTable& table, std::optional<core::UpAxis>& up) {
  static constexpr std::array<std::string_view, 4> kTypes{"json", "udp", "unix", "can"};
  switch (*table.choice("type", kTypes, Presence::required)) {
    case 0:
      return JsonSettings{name_at(table, "file", Presence::optional).value_or("-")};
    case 1:
      return read_udp(table);
    case 2:
      return UnixSettings{read_socket_path(table, "path")};
    default:
      return read_can(table, up);
  }
}

void read_metrics(StrictTable& table, MetricsSettings& metrics, ErrorList& errors) {
  errors.attempt([&] { metrics.file = name_at(table, "file", Presence::optional).value_or(""); });
  errors.attempt([&] {
    if (table.text("socket", Presence::optional)) {
      metrics.socket = read_socket_path(table, "socket");
    }
  });
}

constexpr std::string_view kNodeName = "1 to 32 letters, digits, '-', '_' and '.'";

/// Whether a text may name a node.
bool is_node_name(std::string_view text) {
  constexpr std::size_t kLongest = 32;
  return !text.empty() && text.size() <= kLongest && std::ranges::all_of(text, [](char character) {
    return (character >= 'a' && character <= 'z') || (character >= 'A' && character <= 'Z') ||
           (character >= '0' && character <= '9') || character == '-' || character == '_' ||
           character == '.';
  });
}

/// Name that stands in lines, metrics and logs as it is.
std::string read_name(StrictTable& root) {
  std::string name = root.text("name", Presence::optional).value_or("");
  if (!name.empty() && !is_node_name(name)) {
    root.fail_at("name", fmt::format("expected {}", kNodeName));
  }
  return name;
}

/// Whether there is an odometer exactly where something asks for it.
void check_odometer(const StrictTable& root, const Configuration& configuration, bool asks_gyro) {
  const bool has_odometer = configuration.odometer || configuration.speed;
  if (!asks_gyro && !has_odometer && !configuration.gyro.is_simulated()) {
    root.fail_at("odometer",
                 "missing: what decides that the vehicle stands? Without an odometer, "
                 "[standstill] source = \"gyro\" takes the calm of the gyro for rest");
  }
  if (asks_gyro && has_odometer) {
    root.fail_at("odometer", "not beside [standstill] source = \"gyro\": one of the two");
  }
}

/// Whether a sink and [reference] state one axis that points up.
void check_up_of_sinks(const StrictTable& root, const Configuration& configuration) {
  if (configuration.reference && configuration.reference->up != *configuration.up) {
    root.fail_at("sink", "\"up\" is another axis than that of [reference]; a sensor has one");
  }
}

/// Whether the vertical is known where a sink sends the rate about it.
void check_vertical_of_sinks(const StrictTable& root, const Configuration& configuration) {
  if (configuration.node.up || configuration.gyro.acceleration_range_g) return;
  for (const SinkSettings& sink : configuration.sinks) {
    const auto* can = std::get_if<CanSettings>(&sink);
    if (can != nullptr && can->layout == CanLayout::yaw) {
      root.fail_at("sink",
                   "layout = \"yaw\" sends the rate about the vertical, and nothing shows the "
                   "vertical: expected \"up\" beside it, such as up = \"z\", or [gyro] "
                   "acceleration = true");
    }
  }
}

void read_node(StrictTable& root, Configuration& configuration, ErrorList& errors) {
  const std::string chip{configuration.gyro.model_chip()};
  std::optional<model::SensorModel> sensor;
  configuration.model_name = chip;
  with_table(root, "model", Presence::optional, errors, [&](StrictTable& table) {
    sensor = read_sensor_model(table, chip, configuration.model_name);
  });
  if (chip.empty() && !sensor && errors.is_empty()) {
    errors.attempt([&] {
      root.fail_at("model",
                   "missing: the device's name is no chip of the catalogue; \"name\" or "
                   "\"file\" of [model], or \"chip\" of [gyro]");
    });
  }
  FilterSettings filter;
  with_table(root, "filter", Presence::optional, errors,
             [&](StrictTable& table) { read_filter(table, filter, errors); });
  with_table(root, "standstill", Presence::optional, errors,
             [&](StrictTable& table) { filter.standstill.source = read_source(table); });
  std::optional<core::EarthRate> earth;
  std::optional<core::UpAxis> up;
  if (configuration.reference) up = configuration.reference->up;
  if (configuration.up) {
    errors.attempt([&] { check_up_of_sinks(root, configuration); });
    up = configuration.up;
  }
  with_table(root, "earth", Presence::optional, errors, [&](StrictTable& table) {
    earth = read_earth(table, configuration.gyro.acceleration_range_g.has_value(), up);
  });
  // Values that depend on each other can be judged when each of them is right.
  if (!errors.is_empty()) return;
  errors.attempt([&] {
    const bool asks_gyro = filter.standstill.source == core::StandstillSource::gyro;
    check_odometer(root, configuration, asks_gyro);
    filter.standstill = core::adapted_to(configuration.odometer_traits, filter.standstill);
    if (!sensor) sensor = model::find_model(chip);
    configuration.states_scale_factor = sensor->scale_factor.has_value();
    const bool has_accelerometer = configuration.gyro.acceleration_range_g.has_value();
    configuration.node = make_params(root, model::for_node(*sensor, has_accelerometer), filter,
                                     configuration.gyro.rate_hz);
    configuration.node.up = up;
    check_vertical_of_sinks(root, configuration);
    if (earth) configuration.node.earth = *earth;
  });
}

void read_outputs(StrictTable& root, Configuration& configuration, ErrorList& errors) {
  with_table(root, "state", Presence::optional, errors,
             [&](StrictTable& table) { read_state(table, configuration.state.emplace()); });
  with_table(root, "metrics", Presence::optional, errors,
             [&](StrictTable& table) { read_metrics(table, configuration.metrics, errors); });
  with_table(root, "real_time", Presence::optional, errors,
             [&](StrictTable& table) { read_real_time(table, configuration.real_time); });
  errors.attempt([&] {
    for (StrictTable& sink : root.tables("sink")) {
      errors.attempt([&] {
        configuration.sinks.push_back(read_sink(sink, configuration.up));
        sink.reject_unknown();
      });
    }
  });
}

/// Name of a node whose file gives none: that of the file without its folder and ending.
std::string name_of_file(const std::string& file) {
  std::string name = std::filesystem::path(file).stem().string();
  if (is_node_name(name)) return name;
  throw std::invalid_argument(
      fmt::format("{}: the file's name is no name for a node; \"name\" is {}", file, kNodeName));
}

/// Whether a further node can run in one process with those before it, which came from the first of
/// the files.
void check_beside(const std::vector<Configuration>& others, const std::vector<std::string>& files,
                  const Configuration& one) {
  const std::string& file = files[others.size()];
  const auto twin = std::ranges::find(others, one.name, &Configuration::name);
  if (twin != others.end()) {
    throw std::invalid_argument(
        fmt::format("{} and {} give two nodes one name, \"{}\"; tell them apart by \"name\"",
                    files[static_cast<std::size_t>(twin - others.begin())], file, one.name));
  }
  if (!others.empty() && !one.user.empty() && one.user != others.front().user) {
    throw std::invalid_argument(fmt::format(
        "{}: \"user\" is another one than in {}; a process has one", file, files.front()));
  }
}

}  // namespace

Configuration parse_configuration(std::string_view toml, std::string_view origin) {
  const toml_file::Document document(toml, origin);
  const toml::table parsed = document.parse();
  StrictTable root(document, parsed, "");
  ErrorList errors;
  Configuration configuration;
  errors.attempt([&] {
    if (*root.text("schema", Presence::required) != kConfigurationSchema) {
      root.fail_at("schema", fmt::format("expected \"{}\"", kConfigurationSchema));
    }
  });
  errors.attempt([&] { configuration.name = read_name(root); });
  errors.attempt(
      [&] { configuration.user = name_at(root, "user", Presence::optional).value_or(""); });
  read_hardware(root, configuration, errors);
  read_outputs(root, configuration, errors);
  read_node(root, configuration, errors);
  errors.attempt([&] { root.reject_unknown(); });
  errors.raise();
  return configuration;
}

Configuration read_configuration(const std::string& file) {
  return parse_configuration(toml_file::read_text(file), file);
}

std::vector<Configuration> read_configurations(const std::vector<std::string>& files) {
  std::vector<Configuration> all;
  for (const std::string& file : files) {
    Configuration one = read_configuration(file);
    if (files.size() > 1 && one.name.empty()) one.name = name_of_file(file);
    check_beside(all, files, one);
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace zerorate::linux_node
