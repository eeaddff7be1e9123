#include "firmware/boards/linux/configuration.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <system_error>

#include "firmware/model/catalogue.hpp"
#include "firmware/model/model_file.hpp"
#include "firmware/model/node_model.hpp"
#include "firmware/toml/nearest_name.hpp"
#include "firmware/toml/strict_table.hpp"
#include "firmware/wire/can_frames.hpp"
#include "hal/linux/named_socket.hpp"

namespace zerorate::linux_node {
namespace {

using toml_file::Presence;
using toml_file::Rule;
using toml_file::StrictTable;

constexpr Rule kPositive{[](double x) { return x > 0.0 && x <= 1e6; }, "a positive number"};
constexpr Rule kFilterRate{[](double x) { return x >= 1e-3 && x <= 1e6; },
                           "a rate in Hz, from 0.001 to 1 000 000"};
constexpr Rule kSeconds{[](double x) { return x >= 0.0 && x <= 1e6; },
                        "seconds, from 0 to 1 000 000"};
constexpr Rule kDeadBand{[](double x) { return x >= 0.0 && x <= 10.0; },
                         "a speed in m/s, from 0 to 10"};
constexpr Rule kPulse{[](double x) { return x > 0.0 && x <= 1e3; },
                      "a distance in m, above 0 and at most 1000"};
constexpr Rule kLatitude{[](double x) { return x >= -90.0 && x <= 90.0; },
                         "degrees from -90 to 90, north positive"};
constexpr Rule kInterval{[](double x) { return x >= 1.0 && x <= 1e6; },
                         "seconds, from 1 to 1 000 000"};
constexpr Rule kSpeed{[](double x) { return x >= 1e3 && x <= 1e8; },
                      "a whole number of Hz, from 1 000 to 100 000 000"};
constexpr Rule kAddress{[](double x) { return x >= 0x08 && x <= 0x77; },
                        "a 7-bit address, from 0x08 to 0x77"};
constexpr Rule kPriority{[](double x) { return x >= 0.0 && x <= 99.0; },
                         "a whole number from 0 to 99"};
constexpr Rule kPort{[](double x) { return x >= 1.0 && x <= 65535.0; },
                     "a whole number from 1 to 65535"};
constexpr Rule kLineNumber{[](double x) { return x >= 0.0 && x <= 65535.0; },
                           "a line's name or number"};
constexpr Rule kCanId{[](double x) { return x >= 0.0 && x <= wire::kGreatestCanId; },
                      "an identifier from 0 to 0x7FC: the axes take the three after it"};

core::Duration duration_of(double seconds) {
  return core::Duration::nanoseconds(std::llround(seconds * 1e9));
}

/// An optional part of the file: read by `read`, which is given an empty table where it is absent,
/// and then searched for names that nothing asked for.
template <class Read>
void with_table(StrictTable& parent, std::string_view key, Presence presence, Read read) {
  if (auto table = parent.table(key, presence)) {
    read(*table);
    table->reject_unknown();
  }
}

/// A path or a name: text that is not empty.
std::optional<std::string> name_at(StrictTable& table, std::string_view key, Presence presence) {
  auto name = table.text(key, presence);
  if (name && name->empty()) table.fail_at(key, "expected text that is not empty");
  return name;
}

/// Reports what `act` finds impossible at a key of the file.
template <class Act>
auto at_key(const StrictTable& table, std::string_view key, Act act) {
  try {
    return act();
  } catch (const std::invalid_argument& error) {
    table.fail_at(key, error.what());
  }
}

const ChipDescription& read_chip(StrictTable& table) {
  const std::string name = *table.text("chip", Presence::required);
  if (const ChipDescription* const chip = find_chip(name)) return *chip;
  std::vector<std::string_view> names;
  for (const ChipDescription& chip : chips()) names.push_back(chip.name);
  table.fail_at("chip", fmt::format("no chip \"{}\"{}; known are {}", name,
                                    toml_file::suggestion(name, names), fmt::join(names, ", ")));
}

double one_of(StrictTable& table, std::string_view key, std::span<const double> values) {
  const double value = *table.number(key, kPositive, Presence::required);
  if (std::ranges::find(values, value) == values.end()) {
    table.fail_at(key, fmt::format("the chip offers {}", fmt::join(values, ", ")));
  }
  return value;
}

void read_wiring(StrictTable& table, const ChipDescription& chip, GyroSettings& gyro) {
  static constexpr std::array<std::string_view, 2> kBuses{"spi", "i2c"};
  gyro.bus = static_cast<BusKind>(*table.choice("bus", kBuses, Presence::required));
  gyro.device = *name_at(table, "device", Presence::required);
  if (gyro.bus == BusKind::spi) {
    if (const auto speed = table.integer("speed_hz", kSpeed, Presence::optional)) {
      gyro.speed_hz = static_cast<std::uint32_t>(*speed);
    }
    if (gyro.speed_hz > chip.highest_speed_hz) {
      table.fail_at("speed_hz", fmt::format("the chip takes at most {}", chip.highest_speed_hz));
    }
    return;
  }
  if (chip.addresses.empty()) table.fail_at("bus", "the chip has no I2C");
  gyro.address = static_cast<std::uint8_t>(
      table.integer("address", kAddress, Presence::optional).value_or(chip.addresses[0]));
  if (std::ranges::find(chip.addresses, gyro.address) == chip.addresses.end()) {
    table.fail_at("address",
                  fmt::format("the chip answers at {:#04x}", fmt::join(chip.addresses, ", ")));
  }
}

void read_gyro(StrictTable& table, GyroSettings& gyro) {
  const ChipDescription& chip = read_chip(table);
  gyro.chip = chip.name;
  read_wiring(table, chip, gyro);
  gyro.rate_hz = one_of(table, "rate_hz", chip.rates_hz);
  gyro.full_scale_dps = one_of(table, "full_scale_dps", chip.full_scales_dps);
  gyro.fifo = table.boolean("fifo", Presence::optional).value_or(false);
  if (gyro.fifo && !chip.has_fifo) table.fail_at("fifo", "the chip has none");
}

hal::linux_os::LineSettings read_line(StrictTable& table) {
  hal::linux_os::LineSettings line;
  line.chip = *name_at(table, "chip", Presence::required);
  const toml::node* const node = table.find("line", kLineNumber.words, Presence::required);
  line.line = node->is_string()
                  ? *name_at(table, "line", Presence::required)
                  : fmt::format("{}", *table.integer("line", kLineNumber, Presence::required));
  static constexpr std::array<std::string_view, 3> kEdges{"rising", "falling", "both"};
  line.edge = static_cast<hal::linux_os::Edge>(
      table.choice("edge", kEdges, Presence::optional).value_or(0));
  return line;
}

core::OdometerTraits read_odometer_traits(StrictTable& table) {
  core::OdometerTraits odometer;
  if (const auto speed = table.number("dead_band_mps", kDeadBand, Presence::optional)) {
    odometer.dead_band_mps = static_cast<float>(*speed);
  }
  if (const auto latency = table.number("latency_s", kSeconds, Presence::optional)) {
    odometer.latency = duration_of(*latency);
  }
  if (const auto distance = table.number("metres_per_pulse", kPulse, Presence::optional)) {
    odometer.metres_per_pulse = static_cast<float>(*distance);
  }
  return odometer;
}

core::StandstillSource read_source(StrictTable& table) {
  static constexpr std::array<std::string_view, 3> kSources{"odometer", "gyro", "odometer-alone"};
  return static_cast<core::StandstillSource>(
      table.choice("source", kSources, Presence::optional).value_or(0));
}

core::EarthRate read_earth(StrictTable& table) {
  const double latitude = *table.number("latitude_deg", kLatitude, Presence::required);
  static constexpr std::array<std::string_view, 6> kUp{"x", "y", "z", "-x", "-y", "-z"};
  constexpr std::size_t kZ = 2;
  const std::size_t up = table.choice("up", kUp, Presence::optional).value_or(kZ);
  return core::earth_rate(static_cast<float>(latitude), {.axis = static_cast<std::uint8_t>(up % 3),
                                                         .points_down = up >= kUp.size() / 2});
}

model::SensorModel read_sensor_model(StrictTable& table, const std::string& chip) {
  const auto file = name_at(table, "file", Presence::optional);
  const auto name = name_at(table, "name", Presence::optional);
  if (file && name) table.fail_at("file", "not beside \"name\": one of the two");
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

void read_filter(StrictTable& table, FilterSettings& filter) {
  if (const auto rate = table.number("rate_hz", kFilterRate, Presence::optional)) {
    filter.rate_hz = *rate;
  }
  if (const auto settle = table.number("settle_s", kSeconds, Presence::optional)) {
    filter.standstill.settle = duration_of(*settle);
  }
  if (const auto hold_back = table.number("hold_back_s", kSeconds, Presence::optional)) {
    filter.standstill.hold_back = duration_of(*hold_back);
  }
  static constexpr std::array<std::string_view, app::kPredictors> kPredictors{
      "kalman", "moving_average", "calibration_mean"};
  filter.published = static_cast<app::Predictor>(
      table.choice("predictor", kPredictors, Presence::optional).value_or(0));
}

/// The node's coefficients; what is impossible about them is reported at the filter's table.
Node::Params make_params(const StrictTable& root, const model::SensorModel& sensor,
                         const FilterSettings& filter, double sample_rate_hz) {
  if (filter.rate_hz > sample_rate_hz) {
    root.fail_at("filter", "rate_hz may not exceed the gyro's");
  }
  const core::Duration period = duration_of(1.0 / sample_rate_hz);
  const core::Duration tick = std::max(period, duration_of(1.0 / filter.rate_hz));
  Node::Params params{.modes = {},
                      .white_variance_rad2_s2 = 0.0F,
                      .sample_period = period,
                      .standstill = filter.standstill,
                      .published = filter.published};
  const auto noise = at_key(root, "model", [&] {
    return model::make_node_model<model::kLargestLearningShape>(sensor, period, tick);
  });
  params.modes = noise.modes;
  params.white_variance_rad2_s2 = noise.white_variance_rad2_s2;
  params.measurement_floor_variance_rad2_s2 = noise.measurement_floor_variance_rad2_s2;
  params.turn_on_variance_rad2_s2 = noise.turn_on_variance_rad2_s2;
  params.gate = noise.gate;
  params.temperature = noise.temperature;
  params.samples = noise.samples;
  params.hypotheses = noise.hypotheses;
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

UdpSettings read_udp(StrictTable& table) {
  UdpSettings udp{
      .address = *table.text("address", Presence::required),
      .port = static_cast<std::uint16_t>(*table.integer("port", kPort, Presence::required))};
  at_key(table, "address", [&] { (void)hal::linux_os::udp_address(udp.address, udp.port); });
  return udp;
}

std::string read_socket_path(StrictTable& table, std::string_view key) {
  std::string path = *table.text(key, Presence::required);
  at_key(table, key, [&] { (void)hal::linux_os::unix_address(path); });
  return path;
}

CanSettings read_can(StrictTable& table) {
  CanSettings can{
      .interface = *table.text("interface", Presence::required),
      .id = static_cast<std::uint16_t>(
          table.integer("id", kCanId, Presence::optional).value_or(wire::kDefaultCanId))};
  at_key(table, "interface", [&] { (void)hal::linux_os::interface_request(can.interface); });
  return can;
}

SinkSettings read_sink(StrictTable& table) {
  static constexpr std::array<std::string_view, 4> kTypes{"json", "udp", "unix", "can"};
  switch (*table.choice("type", kTypes, Presence::required)) {
    case 0:
      return JsonSettings{name_at(table, "file", Presence::optional).value_or("-")};
    case 1:
      return read_udp(table);
    case 2:
      return UnixSettings{read_socket_path(table, "path")};
    default:
      return read_can(table);
  }
}

void read_metrics(StrictTable& table, MetricsSettings& metrics) {
  metrics.file = name_at(table, "file", Presence::optional).value_or("");
  if (table.text("socket", Presence::optional)) metrics.socket = read_socket_path(table, "socket");
}

void read_hardware(StrictTable& root, Configuration& configuration) {
  with_table(root, "gyro", Presence::required,
             [&](StrictTable& table) { read_gyro(table, configuration.gyro); });
  with_table(root, "data_ready", Presence::optional,
             [&](StrictTable& table) { configuration.data_ready = read_line(table); });
  with_table(root, "odometer", Presence::optional, [&](StrictTable& table) {
    configuration.odometer = read_line(table);
    configuration.odometer_traits = read_odometer_traits(table);
  });
}

void read_node(StrictTable& root, Configuration& configuration) {
  const std::string& chip = configuration.gyro.chip;
  std::optional<model::SensorModel> sensor;
  with_table(root, "model", Presence::optional,
             [&](StrictTable& table) { sensor = read_sensor_model(table, chip); });
  FilterSettings filter;
  with_table(root, "filter", Presence::optional,
             [&](StrictTable& table) { read_filter(table, filter); });
  with_table(root, "standstill", Presence::optional,
             [&](StrictTable& table) { filter.standstill.source = read_source(table); });
  const bool asks_gyro = filter.standstill.source == core::StandstillSource::gyro;
  if (!asks_gyro && !configuration.odometer) {
    root.fail_at("odometer",
                 "missing: what tells that the vehicle stands? Without an odometer, "
                 "[standstill] source = \"gyro\" takes the calm of the gyro for rest");
  }
  if (asks_gyro && configuration.odometer) {
    root.fail_at("odometer", "not beside [standstill] source = \"gyro\": one of the two");
  }
  filter.standstill = core::adapted_to(configuration.odometer_traits, filter.standstill);
  configuration.node = make_params(root, sensor ? *sensor : model::find_model(chip), filter,
                                   configuration.gyro.rate_hz);
  with_table(root, "earth", Presence::optional,
             [&](StrictTable& table) { configuration.node.earth = read_earth(table); });
}

void read_outputs(StrictTable& root, Configuration& configuration) {
  with_table(root, "state", Presence::optional,
             [&](StrictTable& table) { read_state(table, configuration.state.emplace()); });
  with_table(root, "metrics", Presence::optional,
             [&](StrictTable& table) { read_metrics(table, configuration.metrics); });
  with_table(root, "real_time", Presence::optional,
             [&](StrictTable& table) { read_real_time(table, configuration.real_time); });
  auto sinks = root.tables("sink");
  for (StrictTable& sink : sinks) {
    configuration.sinks.push_back(read_sink(sink));
    sink.reject_unknown();
  }
}

}  // namespace

Configuration parse_configuration(std::string_view toml, std::string_view origin) {
  const toml_file::Document document(toml, origin);
  const toml::table parsed = document.parse();
  StrictTable root(document, parsed, "");
  if (*root.text("schema", Presence::required) != kConfigurationSchema) {
    root.fail_at("schema", fmt::format("expected \"{}\"", kConfigurationSchema));
  }
  Configuration configuration;
  configuration.user = name_at(root, "user", Presence::optional).value_or("");
  read_hardware(root, configuration);
  read_node(root, configuration);
  read_outputs(root, configuration);
  root.reject_unknown();
  return configuration;
}

Configuration read_configuration(const std::string& file) {
  return parse_configuration(toml_file::read_text(file), file);
}

}  // namespace zerorate::linux_node
