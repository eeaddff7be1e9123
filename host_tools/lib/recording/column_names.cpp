#include "host_tools/lib/recording/column_names.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace zerorate::recording {
namespace {

struct AcceptedName {
  std::string_view name;
  std::string_view key;   ///< key of the quantity
  std::string_view unit;  ///< empty: a count, or stated in brackets behind the name
};

/// Names of zerorate's own format; of two with one meaning the first is the one that is written.
constexpr std::array kAcceptedNames = {
    AcceptedName{"t_s", "t", "s"},
    AcceptedName{"time_s", "t", "s"},
    AcceptedName{"gx_dps", "gx", "dps"},
    AcceptedName{"gy_dps", "gy", "dps"},
    AcceptedName{"gz_dps", "gz", "dps"},
    AcceptedName{"gx_radps", "gx", "radps"},
    AcceptedName{"gy_radps", "gy", "radps"},
    AcceptedName{"gz_radps", "gz", "radps"},
    AcceptedName{"rate_dps", "rate", "dps"},
    AcceptedName{"rate_radps", "rate", "radps"},
    AcceptedName{"temp_c", "temp", "c"},
    AcceptedName{"temperature_c", "temp", "c"},
    AcceptedName{"ax_mps2", "ax", "mps2"},
    AcceptedName{"ay_mps2", "ay", "mps2"},
    AcceptedName{"az_mps2", "az", "mps2"},
    AcceptedName{"ax_g", "ax", "g"},
    AcceptedName{"ay_g", "ay", "g"},
    AcceptedName{"az_g", "az", "g"},
    AcceptedName{"odometer_pulses", "pulses", ""},
    AcceptedName{"still", "still", ""},
    AcceptedName{"speed_mps", "speed", "mps"},
    AcceptedName{"ref_heading_deg", "ref_heading", "deg"},
    AcceptedName{"ref_rate_dps", "ref_rate", "dps"},
    AcceptedName{"ref_speed_mps", "ref_speed", "mps"},
};

/// Names of other formats, known where a unit in brackets follows: "timestamp [ns]".
constexpr std::array kNamesBeforeUnits = {
    AcceptedName{"timestamp", "t", ""}, AcceptedName{"time", "t", ""},
    AcceptedName{"w_RS_S_x", "gx", ""}, AcceptedName{"w_RS_S_y", "gy", ""},
    AcceptedName{"w_RS_S_z", "gz", ""}, AcceptedName{"gyro_x", "gx", ""},
    AcceptedName{"gyro_y", "gy", ""},   AcceptedName{"gyro_z", "gz", ""},
    AcceptedName{"a_RS_S_x", "ax", ""}, AcceptedName{"a_RS_S_y", "ay", ""},
    AcceptedName{"a_RS_S_z", "az", ""}, AcceptedName{"accel_x", "ax", ""},
    AcceptedName{"accel_y", "ay", ""},  AcceptedName{"accel_z", "az", ""},
    AcceptedName{"temp", "temp", ""},   AcceptedName{"speed", "speed", ""},
};

template <std::size_t N>
const AcceptedName* find_name(const std::array<AcceptedName, N>& names, std::string_view name) {
  const auto* const found = std::ranges::find(names, name, &AcceptedName::name);
  return found != names.end() ? found : nullptr;
}

/// The unit in brackets behind a name; empty where there is none.
std::string_view unit_in_brackets(std::string_view name) {
  const std::size_t open = name.find(" [");
  if (open == std::string_view::npos || !name.ends_with(']')) return {};
  return name.substr(open + 2, name.size() - open - 3);
}

}  // namespace

std::optional<Unit> unit_in_name(Dimension dimension, std::string_view name) {
  const AcceptedName* const accepted = find_name(kAcceptedNames, name);
  return parse_unit(dimension, accepted != nullptr ? accepted->unit : unit_in_brackets(name));
}

const Quantity* quantity_in_name(std::string_view name) {
  if (const AcceptedName* const accepted = find_name(kAcceptedNames, name)) {
    return find_quantity(accepted->key);
  }
  const std::string_view unit = unit_in_brackets(name);
  if (unit.empty()) return nullptr;
  const AcceptedName* const stem = find_name(kNamesBeforeUnits, name.substr(0, name.find(" [")));
  if (stem == nullptr) return nullptr;
  const Quantity* const quantity = find_quantity(stem->key);
  return parse_unit(quantity->dimension, unit) ? quantity : nullptr;
}

bool begins_with(std::string_view name, std::string_view lower_case_stem) {
  return name.size() >= lower_case_stem.size() &&
         std::equal(
             lower_case_stem.begin(), lower_case_stem.end(), name.begin(),
             [](char stem, char c) { return stem == std::tolower(static_cast<unsigned char>(c)); });
}

}  // namespace zerorate::recording
