/// @file
/// Figures and words of a population for text, JSON and report alike.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host_tools/lib/fleet/population.hpp"

namespace zerorate::fleet {

/// Presentation of a coordinate.
struct Shown {
  const char* name;
  const char* key;
  const char* unit;
  double per_si;
  bool is_log;
};
[[nodiscard]] const std::array<Shown, kCoordinates>& shown();

/// A place of the coordinate, so many spreads from the mean, in its unit.
[[nodiscard]] double at(const Population& population, int coordinate, double sigmas);
/// A value of a lot in the unit of its figure.
[[nodiscard]] double in_unit(const LotFigure& figure, double value);
/// Times by which a lot has more of N or B than the reference, or what its order has more.
[[nodiscard]] LotEffect effect_in_words(const LotFigure& figure);
/// Text of a difference; empty where it is not known.
[[nodiscard]] std::string effect_text(const LotFigure& figure);
/// Sensors that leave the population, the most certain first.
[[nodiscard]] std::vector<const Sensor*> outliers(const Population& population);
/// Sensors that changed between their recordings, the most certain first.
[[nodiscard]] std::vector<const Sensor*> changed(const Population& population);
/// Slopes of the bias over the temperature [deg/h/K], in order.
[[nodiscard]] std::vector<double> temperature_slopes(const Population& population);
[[nodiscard]] std::string words(const Reason& reason);
/// Yield and capability in one sentence each; empty where no limits were given.
[[nodiscard]] std::string words(const Population& population, const Quality& quality);
/// Yield, capability and charts of a report, before its distributions.
void add_quality(const Population& population, const Quality& quality, report::Report& report);
/// Shades where a histogram of a coordinate lies inside of the limits, and names them in its
/// caption. Leaves a figure without limits as it is.
void shade_limits(const Quality& quality, std::size_t coordinate, report::Chart& chart);
/// A rate of false discoveries as text: "below 1e-6" where it is less.
[[nodiscard]] std::string rate_text(double q);
/// The paragraph that stands first.
[[nodiscard]] std::string lead_of(const Population& population);

}  // namespace zerorate::fleet
