#include <algorithm>
#include <array>
#include <vector>

#include "firmware/boards/linux/configuration_tables.hpp"
#include "hal/linux/named_socket.hpp"

namespace zerorate::linux_node {
namespace {

using toml_file::Presence;
using toml_file::Rule;
using toml_file::StrictTable;

constexpr Rule kSignalId{
    [](double x) { return (x >= 0.0 && x <= 0x7FF) || (x >= 0x80000000 && x <= 0x9FFFFFFF); },
    "an identifier from 0 to 0x7FF, or with bit 31 an extended one, as in a DBC file"};
constexpr Rule kStartBit{[](double x) { return x >= 0.0 && x <= 63.0; }, "a bit from 0 to 63"};
constexpr Rule kLength{[](double x) { return x >= 1.0 && x <= 64.0; }, "1 to 64 bits"};
constexpr Rule kCount{[](double x) { return x >= 0.0 && x < 9.0e15; },
                      "the whole number that stands in the frame, from 0"};
constexpr Rule kScale{[](double x) { return x != 0.0 && x >= -1e6 && x <= 1e6; },
                      "the value of one count, not 0"};
constexpr Rule kOffset{[](double x) { return x >= -1e6 && x <= 1e6; },
                       "a number from -1 000 000 to 1 000 000"};
constexpr Rule kSigma{[](double x) { return x > 0.0 && x <= 90.0; }, "degrees, above 0 to 90"};
constexpr Rule kReferenceLatency{[](double x) { return x >= 0.0 && x <= 1.5; },
                                 "seconds, from 0 to 1.5: two are remembered"};
constexpr Rule kTimeout{[](double x) { return x > 0.0 && x <= 1e6; },
                        "seconds, above 0 and at most 1 000 000"};
constexpr Rule kPort{[](double x) { return x >= 1.0 && x <= 65535.0; },
                     "a whole number from 1 to 65535"};

/// Keys that state the value of a count.
struct ValueKeys {
  std::string_view scale;
  std::string_view offset;
};
constexpr ValueKeys kSpeedKeys{.scale = "scale_mps", .offset = "offset_mps"};
constexpr ValueKeys kHeadingKeys{.scale = "scale_deg", .offset = "offset_deg"};

/// Reads the place of a signal in its frame.
void read_bits(StrictTable& table, CanSignal& signal) {
  static constexpr std::array<std::string_view, 2> kOrders{"little", "big"};
  signal.start_bit =
      static_cast<unsigned>(*table.integer("start_bit", kStartBit, Presence::required));
  signal.length = static_cast<unsigned>(*table.integer("length", kLength, Presence::required));
  signal.is_big_endian = *table.choice("byte_order", kOrders, Presence::required) == 1;
  if (signal.bytes() == 0) table.fail_at("length", "the signal does not fit into eight bytes");
}

void read_value(StrictTable& table, const ValueKeys& keys, CanSignal& signal) {
  signal.is_signed = table.boolean("signed", Presence::optional).value_or(false);
  signal.scale = *table.number(keys.scale, kScale, Presence::required);
  signal.offset = table.number(keys.offset, kOffset, Presence::optional).value_or(0.0);
}

std::uint32_t read_id(StrictTable& table) {
  return static_cast<std::uint32_t>(*table.integer("id", kSignalId, Presence::required));
}

CanSignal read_signal(StrictTable& table, const ValueKeys& keys) {
  CanSignal signal{.interface = read_interface(table), .id = read_id(table)};
  read_bits(table, signal);
  read_value(table, keys, signal);
  return signal;
}

std::uint64_t read_count(StrictTable& table, std::string_view key) {
  return static_cast<std::uint64_t>(*table.integer(key, kCount, Presence::required));
}

SpeedSignal read_speed_signal(StrictTable& table) {
  static constexpr std::array<std::string_view, 3> kRoles{"speed", "valid", "counter"};
  SpeedSignal read;
  read.role = static_cast<SignalRole>(table.choice("role", kRoles, Presence::optional).value_or(0));
  read.signal.id = read_id(table);
  read_bits(table, read.signal);
  if (read.role == SignalRole::speed) {
    read_value(table, kSpeedKeys, read.signal);
    if (table.find("invalid_from", kCount.words, Presence::optional) != nullptr) {
      read.invalid_from = read_count(table, "invalid_from");
    }
  }
  if (read.role == SignalRole::valid) read.valid_value = read_count(table, "value");
  if (auto multiplexer = table.table("multiplexer", Presence::optional)) {
    read.multiplexer.emplace();
    read_bits(*multiplexer, read.multiplexer->signal);
    read.multiplexer->value = read_count(*multiplexer, "value");
    multiplexer->reject_unknown();
  }
  return read;
}

/// [[odometer.signal]]: several signals of one interface.
CanFrames read_signals(StrictTable& table, std::vector<StrictTable>& tables,
                       std::vector<SpeedSignal>& signals) {
  CanFrames frames{.interface = read_interface(table), .ids = {}};
  for (StrictTable& signal : tables) {
    signals.push_back(read_speed_signal(signal));
    signal.reject_unknown();
    const std::uint32_t id = signals.back().signal.id;
    if (std::ranges::find(frames.ids, id) == frames.ids.end()) frames.ids.push_back(id);
  }
  const bool has_speed = std::ranges::any_of(
      signals, [](const SpeedSignal& signal) { return signal.role == SignalRole::speed; });
  if (!has_speed) table.fail_at("signal", "at least one of them has to have the role \"speed\"");
  return frames;
}

MessageOrigin read_origin(StrictTable& table, std::string_view type, const ValueKeys& keys) {
  if (type == "can") return read_signal(table, keys);
  if (type == "udp") return read_udp(table);
  return UnixSettings{read_socket_path(table, "path")};
}

}  // namespace

SpeedSettings read_speed(StrictTable& table, std::string_view type) {
  SpeedSettings speed;
  std::vector<StrictTable> signals;
  if (type == "can") signals = table.tables("signal");
  if (signals.empty()) {
    speed.origin = read_origin(table, type, kSpeedKeys);
  } else {
    speed.origin = read_signals(table, signals, speed.signals);
  }
  // A threshold that nobody stated would be guessed.
  speed.dead_band_mps = *table.number("dead_band_mps", kDeadBand, Presence::required);
  (void)table.number("latency_s", kSeconds, Presence::required);
  speed.timeout =
      duration_of(table.number("timeout_s", kTimeout, Presence::optional).value_or(1.0));
  return speed;
}

ReferenceSettings read_reference(StrictTable& table) {
  static constexpr std::array<std::string_view, 3> kTypes{"can", "udp", "unix"};
  static constexpr std::array<std::string_view, 2> kSenses{"clockwise", "counter-clockwise"};
  const std::string_view type = kTypes.at(*table.choice("type", kTypes, Presence::required));
  return {
      .up = *read_up(table, Presence::required),
      .origin = read_origin(table, type, kHeadingKeys),
      .counts_clockwise = *table.choice("sense", kSenses, Presence::required) == 0,
      .sigma =
          core::deg(static_cast<float>(*table.number("sigma_deg", kSigma, Presence::required))),
      .latency = duration_of(*table.number("latency_s", kReferenceLatency, Presence::required))};
}

UdpSettings read_udp(StrictTable& table) {
  UdpSettings udp{
      .address = *name_at(table, "address", Presence::required),
      .port = static_cast<std::uint16_t>(*table.integer("port", kPort, Presence::required))};
  at_key(table, "address", [&] { (void)hal::linux_os::udp_address(udp.address, udp.port); });
  return udp;
}

std::optional<core::UpAxis> read_up(StrictTable& table, Presence presence) {
  static constexpr std::array<std::string_view, 6> kUp{"x", "y", "z", "-x", "-y", "-z"};
  const auto up = table.choice("up", kUp, presence);
  if (!up) return std::nullopt;
  return core::UpAxis{.axis = static_cast<std::uint8_t>(*up % 3),
                      .points_down = *up >= kUp.size() / 2};
}

std::string read_interface(StrictTable& table) {
  std::string name = *name_at(table, "interface", Presence::required);
  at_key(table, "interface", [&] { (void)hal::linux_os::interface_request(name); });
  return name;
}

std::string read_socket_path(StrictTable& table, std::string_view key) {
  std::string path = *name_at(table, key, Presence::required);
  at_key(table, key, [&] { (void)hal::linux_os::unix_address(path); });
  return path;
}

}  // namespace zerorate::linux_node
