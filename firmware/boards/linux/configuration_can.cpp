#include <fmt/format.h>

#include <array>

#include "firmware/boards/linux/configuration_tables.hpp"
#include "firmware/wire/can_frames.hpp"

namespace zerorate::linux_node {
namespace {

using toml_file::Presence;
using toml_file::Rule;
using toml_file::StrictTable;

constexpr Rule kCanId{[](double x) { return x >= 0.0 && x <= wire::kGreatestCanId; },
                      "an identifier from 0 to 0x7F1: the other frames take the fourteen after it"};
constexpr Rule kEvery{[](double x) { return x >= 1.0 && x <= 10'000.0; },
                      "a whole number from 1 to 10 000"};
constexpr Rule kDataId{[](double x) { return x >= 0.0 && x <= 0xFFFF; },
                       "an identifier of the data, from 0 to 0xFFFF"};

/// Protection of a layout that has one. The identifier of the data is that of the frame unless
/// given.
wire::E2eSettings read_e2e(StrictTable& table, std::uint16_t id) {
  static constexpr std::array<std::string_view, 2> kVariants{"11A", "11C"};
  const bool is_both = table.choice("e2e_variant", kVariants, Presence::optional).value_or(1) == 0;
  const auto data_id = table.integer("e2e_data_id", kDataId, Presence::optional);
  const wire::E2eSettings e2e{
      .data_id = static_cast<std::uint16_t>(data_id.value_or(id)),
      .variant = is_both ? wire::E2eVariant::both : wire::E2eVariant::nibble};
  if (!is_both && (e2e.data_id < 0x100 || e2e.data_id > 0xEFF)) {
    table.fail_at("e2e_data_id",
                  fmt::format("{:#05x}{}: variant 11C takes 0x100 to 0xEFF, of which the upper "
                              "four bits are sent",
                              e2e.data_id, data_id ? "" : " by \"id\""));
  }
  return e2e;
}

}  // namespace

CanSettings read_can(StrictTable& table, std::optional<core::UpAxis>& up) {
  static constexpr std::array<std::string_view, 3> kLayouts{"axes", "yaw", "fd"};
  CanSettings can{
      .interface = read_interface(table),
      .id = static_cast<std::uint16_t>(
          table.integer("id", kCanId, Presence::optional).value_or(wire::kDefaultCanId))};
  can.layout =
      static_cast<CanLayout>(table.choice("layout", kLayouts, Presence::optional).value_or(0));
  can.every =
      static_cast<std::uint32_t>(table.integer("every", kEvery, Presence::optional).value_or(1));
  if (can.layout != CanLayout::axes) can.e2e = read_e2e(table, can.id);
  const auto stated = read_up(table, Presence::optional);
  if (stated && up && *up != *stated) {
    table.fail_at("up", "another axis than that of a sink before; a sensor has one");
  }
  if (stated) up = stated;
  return can;
}

}  // namespace zerorate::linux_node
