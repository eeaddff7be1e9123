#include "host_tools/lib/recording/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace zerorate::recording {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kGravity_m_s2 = 9.80665;  // 3rd CGPM, 1901

constexpr std::array kQuantities = {
    Quantity{"t", Meaning::time, Dimension::time},
    Quantity{"t_ns", Meaning::nanoseconds},
    Quantity{"t_us", Meaning::microseconds},
    Quantity{"gx", Meaning::rate, Dimension::rate, 0, 3},
    Quantity{"gy", Meaning::rate, Dimension::rate, 1, 3},
    Quantity{"gz", Meaning::rate, Dimension::rate, 2, 3},
    Quantity{"rate", Meaning::rate, Dimension::rate, 0, 1},
    Quantity{"temp", Meaning::temperature, Dimension::temperature},
    Quantity{"ax", Meaning::acceleration, Dimension::acceleration, 0, 3},
    Quantity{"ay", Meaning::acceleration, Dimension::acceleration, 1, 3},
    Quantity{"az", Meaning::acceleration, Dimension::acceleration, 2, 3},
    Quantity{"pulses", Meaning::odometer},
    Quantity{"ticks1", Meaning::ticks, Dimension::none, 0},
    Quantity{"ticks2", Meaning::ticks, Dimension::none, 1},
    Quantity{"ticks3", Meaning::ticks, Dimension::none, 2},
    Quantity{"ticks4", Meaning::ticks, Dimension::none, 3},
    Quantity{"still", Meaning::still},
    Quantity{"speed", Meaning::speed, Dimension::speed},
    Quantity{"turn", Meaning::turn, Dimension::rate},
    Quantity{"ref_heading", Meaning::ref_heading, Dimension::angle},
    Quantity{"ref_rate", Meaning::ref_rate, Dimension::rate},
    Quantity{"ref_speed", Meaning::ref_speed, Dimension::speed},
};

struct NamedUnit {
  std::string_view name;
  Dimension dimension;
  Unit unit;
};

constexpr std::array kUnits = {
    NamedUnit{"s", Dimension::time, {.decimals = 9}},
    NamedUnit{"ms", Dimension::time, {.decimals = 6}},
    NamedUnit{"us", Dimension::time, {.decimals = 3}},
    NamedUnit{"ns", Dimension::time, {.decimals = 0}},
    NamedUnit{"iso", Dimension::time, {.is_calendar = true}},
    NamedUnit{"dps", Dimension::rate, {.si_per_unit = kRadPerDeg}},
    NamedUnit{"deg/s", Dimension::rate, {.si_per_unit = kRadPerDeg}},
    NamedUnit{"mdps", Dimension::rate, {.si_per_unit = 1e-3 * kRadPerDeg}},
    NamedUnit{"dph", Dimension::rate, {.si_per_unit = kRadPerDeg / 3600.0}},
    NamedUnit{"radps", Dimension::rate, {}},
    NamedUnit{"rad/s", Dimension::rate, {}},
    NamedUnit{"rad s^-1", Dimension::rate, {}},
    NamedUnit{"deg/sample", Dimension::rate, {.si_per_unit = kRadPerDeg, .is_increment = true}},
    NamedUnit{"rad/sample", Dimension::rate, {.is_increment = true}},
    NamedUnit{"c", Dimension::temperature, {}},
    NamedUnit{"degc", Dimension::temperature, {}},
    NamedUnit{"k", Dimension::temperature, {.zero = 273.15}},
    NamedUnit{"f", Dimension::temperature, {.si_per_unit = 5.0 / 9.0, .zero = 32.0}},
    NamedUnit{"mps2", Dimension::acceleration, {}},
    NamedUnit{"m/s2", Dimension::acceleration, {}},
    NamedUnit{"m/s^2", Dimension::acceleration, {}},
    NamedUnit{"m s^-2", Dimension::acceleration, {}},
    NamedUnit{"g", Dimension::acceleration, {.si_per_unit = kGravity_m_s2}},
    NamedUnit{"mps", Dimension::speed, {}},
    NamedUnit{"m/s", Dimension::speed, {}},
    NamedUnit{"kmh", Dimension::speed, {.si_per_unit = 1.0 / 3.6}},
    NamedUnit{"km/h", Dimension::speed, {.si_per_unit = 1.0 / 3.6}},
    NamedUnit{"mph", Dimension::speed, {.si_per_unit = 0.44704}},
    NamedUnit{"deg", Dimension::angle, {.si_per_unit = kRadPerDeg}},
    NamedUnit{"rad", Dimension::angle, {}},
};

struct NamedDimension {
  std::string_view name;
  Dimension dimension;
  std::string_view units;
};

constexpr std::array kDimensions = {
    NamedDimension{"time", Dimension::time, "s, ms, us, ns or iso"},
    NamedDimension{"rate", Dimension::rate,
                   "dps, radps, mdps, dph, deg/sample or rad/sample, with a factor for raw counts "
                   "(0.00875dps)"},
    NamedDimension{"temp", Dimension::temperature, "c, k or f"},
    NamedDimension{"acceleration", Dimension::acceleration, "mps2 or g"},
    NamedDimension{"speed", Dimension::speed, "mps, kmh or mph"},
    NamedDimension{"angle", Dimension::angle, "deg or rad"},
};

std::string keys() {
  std::string text;
  for (const Quantity& quantity : kQuantities) {
    text.append(text.empty() ? "" : ", ").append(quantity.key);
  }
  return text;
}

/// Calls take(key, value) for each "key=value" of a list separated by commas.
template <class Take>
void for_each_pair(std::string_view text, Take take) {
  while (!text.empty()) {
    const std::string_view item = text.substr(0, text.find(','));
    text.remove_prefix(std::min(item.size() + 1, text.size()));
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos || equals == 0 || equals + 1 == item.size()) {
      throw std::invalid_argument(
          fmt::format("expected key=value, separated by commas; found \"{}\"", item));
    }
    take(item.substr(0, equals), item.substr(equals + 1));
  }
}

}  // namespace

std::span<const Quantity> quantities() {
  return kQuantities;
}

const Quantity* find_quantity(std::string_view key) {
  const auto* const found = std::ranges::find(kQuantities, key, &Quantity::key);
  return found != kQuantities.end() ? found : nullptr;
}

std::optional<Unit> parse_unit(Dimension dimension, std::string_view text) {
  double factor = 1.0;
  if (dimension != Dimension::time) {
    const auto [stop, fault] = std::from_chars(text.data(), text.data() + text.size(), factor);
    if (fault == std::errc{}) text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
    if (!std::isfinite(factor) || factor == 0.0) return std::nullopt;
  }
  const auto* const found = std::ranges::find_if(kUnits, [&](const NamedUnit& unit) {
    return unit.dimension == dimension && unit.name == text;
  });
  if (found == kUnits.end()) return std::nullopt;
  Unit unit = found->unit;
  unit.si_per_unit *= factor;
  return unit;
}

std::string_view unit_names(Dimension dimension) {
  return std::ranges::find(kDimensions, dimension, &NamedDimension::dimension)->units;
}

std::string_view name(Dimension dimension) {
  return std::ranges::find(kDimensions, dimension, &NamedDimension::dimension)->name;
}

void Layout::set_columns(std::string_view text) {
  for_each_pair(text, [&](std::string_view key, std::string_view column) {
    const Quantity* const quantity = find_quantity(key);
    if (quantity == nullptr) {
      throw std::invalid_argument(
          fmt::format("no quantity \"{}\" that a column could hold; there are {}", key, keys()));
    }
    if (!columns.emplace(quantity->key, column).second) {
      throw std::invalid_argument(fmt::format("{} is given twice", key));
    }
  });
}

void Layout::set_where(std::string_view text) {
  for_each_pair(
      text, [&](std::string_view column, std::string_view value) { where.emplace(column, value); });
}

void Layout::set_units(std::string_view text) {
  for_each_pair(text, [&](std::string_view key, std::string_view unit) {
    const auto* const found = std::ranges::find(kDimensions, key, &NamedDimension::name);
    if (found == kDimensions.end()) {
      throw std::invalid_argument(
          fmt::format("expected time, rate, temp, acceleration, speed or angle before =, "
                      "found \"{}\"",
                      key));
    }
    const auto parsed = parse_unit(found->dimension, unit);
    if (!parsed) {
      throw std::invalid_argument(
          fmt::format("\"{}\" is no unit of a {}; there are {}", unit, key, found->units));
    }
    units[found->dimension] = *parsed;
  });
}

void Layout::set_delimiter(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, char>, 6> kDelimiters{
      {{",", ','}, {";", ';'}, {"|", '|'}, {"tab", '\t'}, {"\\t", '\t'}, {"space", ' '}}};
  for (const auto& [word, character] : kDelimiters) {
    if (word == text) {
      delimiter = character;
      return;
    }
  }
  throw std::invalid_argument(fmt::format("expected , ; | tab or space, found \"{}\"", text));
}

}  // namespace zerorate::recording
