#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "firmware/boards/linux/chips/iio_gyro.hpp"
#include "firmware/boards/linux/configuration_tables.hpp"
#include "firmware/toml/error.hpp"
#include "hal/linux/named_socket.hpp"

namespace zerorate::linux_node {
namespace {

using toml_file::ErrorList;
using toml_file::Presence;
using toml_file::Rule;
using toml_file::StrictTable;

constexpr Rule kPositive{[](double x) { return x > 0.0 && x <= 1e6; }, "a positive number"};
constexpr Rule kPulse{[](double x) { return x > 0.0 && x <= 1e3; },
                      "a distance in m, above 0 and at most 1000"};
constexpr Rule kSpeed{[](double x) { return x >= 1e3 && x <= 1e8; },
                      "a whole number of Hz, from 1 000 to 100 000 000"};
constexpr Rule kAddress{[](double x) { return x >= 0x08 && x <= 0x77; },
                        "a 7-bit address, from 0x08 to 0x77"};
constexpr Rule kTimeFactor{[](double x) { return x >= 1.0 && x <= 100.0; },
                           "a factor from 1 to 100"};
constexpr Rule kDebounce{[](double x) { return x >= 0.0 && x <= 1e6; },
                         "microseconds, from 0 to 1 000 000"};
constexpr Rule kLineNumber{[](double x) { return x >= 0.0 && x <= 65535.0; },
                           "a line's name or number"};

/// Lets keys pass that nothing can ask for until something else is mended.
void pass_over(StrictTable& table, std::span<const std::string_view> keys) {
  for (const std::string_view key : keys) (void)table.find(key, "", Presence::optional);
}

void read_chip(StrictTable& table, GyroSettings& gyro) {
  gyro.chip = *name_at(table, "chip", Presence::required);
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

constexpr std::string_view kAccelerationRange = "acceleration_range_g";
constexpr std::array<std::string_view, 5> kBuses{"spi", "i2c", "iio", "udp", "unix"};

/// Reads the bus; false where the table names none of them.
bool read_bus(StrictTable& table, GyroSettings& gyro, ErrorList& errors, Presence presence) {
  return errors.attempt(
      [&] { gyro.bus = static_cast<BusKind>(table.choice("bus", kBuses, presence).value_or(0)); });
}

void read_wiring(StrictTable& table, const ChipDescription& chip, GyroSettings& gyro,
                 ErrorList& errors, bool has_bus) {
  static constexpr std::array<std::string_view, 2> kKeys{"speed_hz", "address"};
  const bool is_told =
      has_bus && errors.attempt([&] { (void)table.choice("bus", kBuses, Presence::required); });
  errors.attempt([&] { gyro.device = *name_at(table, "device", Presence::required); });
  if (!is_told) return pass_over(table, kKeys);
  errors.attempt([&] {
    gyro.bus == BusKind::spi ? read_spi(table, chip, gyro) : read_i2c(table, chip, gyro);
  });
}

void read_simulation(StrictTable& table, GyroSettings& gyro, ErrorList& errors) {
  errors.attempt([&] {
    gyro.time_factor = table.number("time_factor", kTimeFactor, Presence::optional).value_or(1.0);
  });
  errors.attempt([&] { gyro.drives = table.boolean("drives", Presence::optional).value_or(true); });
}

/// Whether the acceleration is to be read. Refuses its range without it.
bool reads_acceleration(StrictTable& table) {
  const bool is_on = table.boolean("acceleration", Presence::optional).value_or(false);
  const bool has_range = table.find(kAccelerationRange, "", Presence::optional) != nullptr;
  if (has_range && !is_on)
    table.fail_at(kAccelerationRange, "stands only beside acceleration = true");
  return is_on;
}

void read_iio_acceleration(StrictTable& table, GyroSettings& gyro) {
  constexpr double kUsualRange_g = 4.0;
  if (!reads_acceleration(table)) return;
  gyro.accelerometer_device = *name_at(table, "accelerometer_device", Presence::required);
  gyro.acceleration_range_g =
      table.number(kAccelerationRange, kPositive, Presence::optional).value_or(kUsualRange_g);
}

/// Reads a gyro of the kernel, also of a chip without a driver here.
void read_iio(StrictTable& table, GyroSettings& gyro, ErrorList& errors) {
  constexpr double kUsualRange_dps = 250.0;
  errors.attempt([&] { gyro.device = *name_at(table, "device", Presence::required); });
  errors.attempt([&] {
    gyro.chip = chip_of_iio(gyro.device);
    if (table.find("chip", "", Presence::optional) == nullptr) return;
    read_chip(table, gyro);
    if (gyro.is_simulated()) table.fail_at("chip", "\"simulated\" is on no bus");
  });
  errors.attempt([&] { gyro.rate_hz = *table.number("rate_hz", kPositive, Presence::required); });
  errors.attempt([&] { read_iio_acceleration(table, gyro); });
  errors.attempt([&] {
    const ChipDescription* const chip = find_chip(gyro.chip);
    const bool has_one_range = chip != nullptr && chip->full_scales_dps.size() == 1;
    gyro.full_scale_dps = table.number("full_scale_dps", kPositive, Presence::optional)
                              .value_or(has_one_range ? chip->full_scales_dps[0] : kUsualRange_dps);
  });
}

/// Reads a gyro of any chip, with any rate and range: another program sends its samples.
void read_by_message(StrictTable& table, Configuration& configuration, ErrorList& errors) {
  constexpr double kUsualRange_g = 4.0;
  GyroSettings& gyro = configuration.gyro;
  errors.attempt([&] {
    configuration.samples = gyro.bus == BusKind::udp
                                ? MessageOrigin{read_udp(table)}
                                : MessageOrigin{UnixSettings{read_socket_path(table, "path")}};
    gyro.device = name_of(*configuration.samples);
  });
  errors.attempt([&] {
    if (table.find("chip", "", Presence::optional) == nullptr) return;
    read_chip(table, gyro);
    if (gyro.is_simulated()) table.fail_at("chip", "\"simulated\" is on no bus");
  });
  errors.attempt([&] { gyro.rate_hz = *table.number("rate_hz", kPositive, Presence::required); });
  errors.attempt([&] {
    gyro.full_scale_dps = *table.number("full_scale_dps", kPositive, Presence::required);
  });
  errors.attempt([&] {
    if (!reads_acceleration(table)) return;
    gyro.acceleration_range_g =
        table.number(kAccelerationRange, kPositive, Presence::optional).value_or(kUsualRange_g);
  });
}

/// Address or node of an accelerometer that answers apart.
void read_second_die(StrictTable& table, const ChipDescription& chip, GyroSettings& gyro) {
  const auto& addresses = chip.accelerometer_addresses;
  if (addresses.empty()) return;
  if (gyro.bus == BusKind::spi) {
    gyro.accelerometer_device = *name_at(table, "accelerometer_device", Presence::required);
    return;
  }
  const auto address = table.integer("accelerometer_address", kAddress, Presence::optional);
  gyro.accelerometer_address = static_cast<std::uint8_t>(address.value_or(addresses[0]));
  if (std::ranges::find(addresses, gyro.accelerometer_address) == addresses.end()) {
    table.fail_at("accelerometer_address",
                  fmt::format("it answers at {:#04x}", fmt::join(addresses, ", ")));
  }
}

void read_acceleration(StrictTable& table, const ChipDescription& chip, GyroSettings& gyro) {
  const bool is_on = reads_acceleration(table);
  if (is_on && chip.acceleration_ranges_g.empty()) {
    table.fail_at("acceleration",
                  "no accelerometer of the chip is read; leave the key out, or set it to false");
  }
  if (!is_on) return;
  read_second_die(table, chip, gyro);
  gyro.acceleration_range_g = one_of(table, kAccelerationRange, chip.acceleration_ranges_g,
                                     chip.usual_acceleration_range_g);
}

/// Path of a file that the chip needs and that is not ours to bring.
void read_config_file(StrictTable& table, const ChipDescription& chip, GyroSettings& gyro) {
  constexpr std::string_view kWords =
      "the path of the maker's file for this chip, which it needs at each start";
  if (!chip.needs_config_file) return;
  (void)table.find("config_file", kWords, Presence::required);
  gyro.config_file = *name_at(table, "config_file", Presence::required);
}

void read_gyro(StrictTable& table, Configuration& configuration, ErrorList& errors) {
  GyroSettings& gyro = configuration.gyro;
  static constexpr std::array<std::string_view, 14> kKeys{"config_file",
                                                          "accelerometer_address",
                                                          "accelerometer_device",
                                                          "bus",
                                                          "device",
                                                          "speed_hz",
                                                          "address",
                                                          "rate_hz",
                                                          "full_scale_dps",
                                                          "fifo",
                                                          "time_factor",
                                                          "drives",
                                                          "acceleration",
                                                          "acceleration_range_g"};
  const bool has_bus = read_bus(table, gyro, errors, Presence::optional);
  if (gyro.bus == BusKind::iio) return read_iio(table, gyro, errors);
  if (gyro.is_by_message()) return read_by_message(table, configuration, errors);
  if (!errors.attempt([&] { read_chip(table, gyro); })) return pass_over(table, kKeys);
  const bool is_simulated = gyro.is_simulated();
  const ChipDescription& chip = *find_chip(gyro.model_chip());
  if (!is_simulated) read_wiring(table, chip, gyro, errors, has_bus);
  const auto simulated = [&](double value) {
    return is_simulated ? std::optional{value} : std::nullopt;
  };
  errors.attempt([&] { gyro.rate_hz = one_of(table, "rate_hz", chip.rates_hz, simulated(104.0)); });
  errors.attempt([&] {
    gyro.full_scale_dps = one_of(table, "full_scale_dps", chip.full_scales_dps, simulated(250.0));
  });
  errors.attempt([&] { read_acceleration(table, chip, gyro); });
  if (is_simulated) {
    errors.attempt([&] {
      if (table.find("bus", "", Presence::optional) != nullptr) {
        table.fail_at("bus", "not beside chip = \"simulated\"");
      }
    });
    return read_simulation(table, gyro, errors);
  }
  errors.attempt([&] { read_config_file(table, chip, gyro); });
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
  errors.attempt([&] {
    static constexpr std::array<std::string_view, 4> kBiases{"as-is", "disabled", "pull-up",
                                                             "pull-down"};
    line.bias = static_cast<hal::linux_os::LineBias>(
        table.choice("bias", kBiases, Presence::optional).value_or(0));
  });
  errors.attempt([&] {
    line.debounce = core::Duration::microseconds(
        table.integer("debounce_us", kDebounce, Presence::optional).value_or(0));
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

constexpr std::array<std::string_view, 4> kOdometerTypes{"gpio", "can", "udp", "unix"};

/// Refuses messages, which come in real time, beside a gyro with a time of its own.
void check_real_time(const StrictTable& table, const GyroSettings& gyro) {
  if (gyro.time_factor != 1.0) {
    table.fail_at("type", "messages come in real time: time_factor of [gyro] must be 1");
  }
}

void read_odometer(StrictTable& table, Configuration& configuration, ErrorList& errors) {
  const std::string_view type =
      kOdometerTypes.at(table.choice("type", kOdometerTypes, Presence::optional).value_or(0));
  if (type != "gpio") {
    check_real_time(table, configuration.gyro);
    configuration.speed = read_speed(table, type);
  } else if (configuration.gyro.is_simulated()) {
    table.fail_at("type",
                  "the simulated gyro brings an odometer of its own; \"can\", \"udp\" or "
                  "\"unix\" take its place");
  } else {
    configuration.odometer = read_line(table, errors);
  }
  configuration.odometer_traits = read_odometer_traits(table, errors);
}

}  // namespace

void read_hardware(StrictTable& root, Configuration& configuration, ErrorList& errors) {
  with_table(root, "gyro", Presence::required, errors,
             [&](StrictTable& table) { read_gyro(table, configuration, errors); });
  with_table(root, "data_ready", Presence::optional, errors, [&](StrictTable& table) {
    configuration.data_ready = read_line(table, errors);
    if (configuration.gyro.is_simulated()) {
      root.fail_at("data_ready", "not beside chip = \"simulated\", which brings its own");
    }
    if (configuration.gyro.is_by_message()) {
      root.fail_at("data_ready", "not beside samples from messages, which carry their stamps");
    }
    if (configuration.gyro.bus == BusKind::iio) {
      root.fail_at("data_ready", "not beside bus = \"iio\": the kernel's driver has the line");
    }
  });
  with_table(root, "odometer", Presence::optional, errors,
             [&](StrictTable& table) { read_odometer(table, configuration, errors); });
  with_table(root, "reference", Presence::optional, errors, [&](StrictTable& table) {
    configuration.reference = read_reference(table);
    check_real_time(table, configuration.gyro);
  });
}

}  // namespace zerorate::linux_node
