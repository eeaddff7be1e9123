#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "firmware/boards/linux/configuration_tables.hpp"
#include "firmware/toml/nearest_name.hpp"

namespace zerorate::linux_node {
namespace {

using toml_file::ErrorList;
using toml_file::Presence;
using toml_file::Rule;
using toml_file::StrictTable;

constexpr Rule kPositive{[](double x) { return x > 0.0 && x <= 1e6; }, "a positive number"};
constexpr Rule kDeadBand{[](double x) { return x >= 0.0 && x <= 10.0; },
                         "a speed in m/s, from 0 to 10"};
constexpr Rule kPulse{[](double x) { return x > 0.0 && x <= 1e3; },
                      "a distance in m, above 0 and at most 1000"};
constexpr Rule kSpeed{[](double x) { return x >= 1e3 && x <= 1e8; },
                      "a whole number of Hz, from 1 000 to 100 000 000"};
constexpr Rule kAddress{[](double x) { return x >= 0x08 && x <= 0x77; },
                        "a 7-bit address, from 0x08 to 0x77"};
constexpr Rule kLineNumber{[](double x) { return x >= 0.0 && x <= 65535.0; },
                           "a line's name or number"};

/// Lets keys pass that nothing can ask for until something else is mended.
void pass_over(StrictTable& table, std::span<const std::string_view> keys) {
  for (const std::string_view key : keys) (void)table.find(key, "", Presence::optional);
}

void read_chip(StrictTable& table, GyroSettings& gyro) {
  gyro.chip = *table.text("chip", Presence::required);
  if (gyro.is_simulated() || find_chip(gyro.chip) != nullptr) return;
  std::vector<std::string_view> names{kSimulatedChip};
  for (const ChipDescription& chip : chips()) names.push_back(chip.name);
  table.fail_at("chip",
                fmt::format("no chip \"{}\" (known are {}){}", gyro.chip, fmt::join(names, ", "),
                            toml_file::suggestion(gyro.chip, names)));
}

double one_of(StrictTable& table, std::string_view key, std::span<const double> values,
              std::optional<double> otherwise) {
  const Presence presence = otherwise ? Presence::optional : Presence::required;
  const auto value = table.number(key, kPositive, presence);
  if (!value) return *otherwise;
  if (std::ranges::find(values, *value) == values.end()) {
    table.fail_at(key, fmt::format("the chip offers {}", fmt::join(values, ", ")));
  }
  return *value;
}

void read_spi(StrictTable& table, const ChipDescription& chip, GyroSettings& gyro) {
  if (const auto speed = table.integer("speed_hz", kSpeed, Presence::optional)) {
    gyro.speed_hz = static_cast<std::uint32_t>(*speed);
  }
  if (gyro.speed_hz > chip.highest_speed_hz) {
    table.fail_at("speed_hz", fmt::format("the chip takes at most {}", chip.highest_speed_hz));
  }
}

void read_i2c(StrictTable& table, const ChipDescription& chip, GyroSettings& gyro) {
  const auto address = table.integer("address", kAddress, Presence::optional);
  if (chip.addresses.empty()) table.fail_at("bus", "the chip has no I2C");
  gyro.address = static_cast<std::uint8_t>(address.value_or(chip.addresses[0]));
  if (std::ranges::find(chip.addresses, gyro.address) == chip.addresses.end()) {
    table.fail_at("address",
                  fmt::format("the chip answers at {:#04x}", fmt::join(chip.addresses, ", ")));
  }
}

void read_wiring(StrictTable& table, const ChipDescription& chip, GyroSettings& gyro,
                 ErrorList& errors) {
  static constexpr std::array<std::string_view, 2> kBuses{"spi", "i2c"};
  static constexpr std::array<std::string_view, 2> kKeys{"speed_hz", "address"};
  const bool has_bus = errors.attempt(
      [&] { gyro.bus = static_cast<BusKind>(*table.choice("bus", kBuses, Presence::required)); });
  errors.attempt([&] { gyro.device = *name_at(table, "device", Presence::required); });
  if (!has_bus) return pass_over(table, kKeys);
  errors.attempt([&] {
    gyro.bus == BusKind::spi ? read_spi(table, chip, gyro) : read_i2c(table, chip, gyro);
  });
}

void read_gyro(StrictTable& table, GyroSettings& gyro, ErrorList& errors) {
  static constexpr std::array<std::string_view, 7> kKeys{
      "bus", "device", "speed_hz", "address", "rate_hz", "full_scale_dps", "fifo"};
  if (!errors.attempt([&] { read_chip(table, gyro); })) return pass_over(table, kKeys);
  const bool is_simulated = gyro.is_simulated();
  const ChipDescription& chip = *find_chip(gyro.model_chip());
  if (!is_simulated) read_wiring(table, chip, gyro, errors);
  const auto simulated = [&](double value) {
    return is_simulated ? std::optional{value} : std::nullopt;
  };
  errors.attempt([&] { gyro.rate_hz = one_of(table, "rate_hz", chip.rates_hz, simulated(104.0)); });
  errors.attempt([&] {
    gyro.full_scale_dps = one_of(table, "full_scale_dps", chip.full_scales_dps, simulated(250.0));
  });
  if (is_simulated) return;
  errors.attempt([&] {
    gyro.fifo = table.boolean("fifo", Presence::optional).value_or(false);
    if (gyro.fifo && !chip.has_fifo) table.fail_at("fifo", "the chip has none");
  });
}

hal::linux_os::LineSettings read_line(StrictTable& table, ErrorList& errors) {
  hal::linux_os::LineSettings line;
  errors.attempt([&] { line.chip = *name_at(table, "chip", Presence::required); });
  errors.attempt([&] {
    const toml::node* const node = table.find("line", kLineNumber.words, Presence::required);
    line.line = node->is_string()
                    ? *name_at(table, "line", Presence::required)
                    : fmt::format("{}", *table.integer("line", kLineNumber, Presence::required));
  });
  errors.attempt([&] {
    static constexpr std::array<std::string_view, 3> kEdges{"rising", "falling", "both"};
    line.edge = static_cast<hal::linux_os::Edge>(
        table.choice("edge", kEdges, Presence::optional).value_or(0));
  });
  return line;
}

core::OdometerTraits read_odometer_traits(StrictTable& table, ErrorList& errors) {
  core::OdometerTraits odometer;
  const auto read = [&](std::string_view key, const Rule& rule, auto take) {
    errors.attempt([&] {
      if (const auto value = table.number(key, rule, Presence::optional)) take(*value);
    });
  };
  read("dead_band_mps", kDeadBand,
       [&](double speed) { odometer.dead_band_mps = static_cast<float>(speed); });
  read("latency_s", kSeconds, [&](double latency) { odometer.latency = duration_of(latency); });
  read("metres_per_pulse", kPulse,
       [&](double distance) { odometer.metres_per_pulse = static_cast<float>(distance); });
  return odometer;
}

}  // namespace

void read_hardware(StrictTable& root, Configuration& configuration, ErrorList& errors) {
  with_table(root, "gyro", Presence::required, errors,
             [&](StrictTable& table) { read_gyro(table, configuration.gyro, errors); });
  if (configuration.gyro.is_simulated()) {
    for (const std::string_view key : {"data_ready", "odometer"}) {
      errors.attempt([&] {
        if (root.find(key, "", Presence::optional) == nullptr) return;
        root.fail_at(key, "not beside chip = \"simulated\", which brings its own");
      });
    }
    return;
  }
  with_table(root, "data_ready", Presence::optional, errors,
             [&](StrictTable& table) { configuration.data_ready = read_line(table, errors); });
  with_table(root, "odometer", Presence::optional, errors, [&](StrictTable& table) {
    configuration.odometer = read_line(table, errors);
    configuration.odometer_traits = read_odometer_traits(table, errors);
  });
}

}  // namespace zerorate::linux_node
