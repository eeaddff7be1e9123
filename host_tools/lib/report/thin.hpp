/// @file
/// Thinning of long series to what a screen can show.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "host_tools/lib/report/chart.hpp"

namespace zerorate::report {

/// Columns a chart's width is divided into; about the device pixels of a full-width chart.
inline constexpr std::size_t kDisplayColumns = 1000;

/// The span of x that a chart shows.
struct DisplayWindow {
  double from;
  double to;
  Scale scale = Scale::linear;
};

/// Indices, ascending, of the points that draw the same picture as all points do.
///
/// Of every column, evenly spaced on the axis, it keeps the first and the last point and, of each
/// channel, the least and the greatest: the M4 aggregation (Jugel et al. 2014). The
/// envelope is therefore exact; how many points a column held, and what a zoom would show inside
/// it, is lost. A gap (a channel that is not finite) stays a gap unless it begins and ends within
/// one column.
///
/// @param x         not decreasing, inside the window
/// @param channels  values over x, each as long as x; y, or y and the edges of its band
/// @return at most kDisplayColumns * (2 + 2 * channels) indices; all of them where there are at
///         most 4 a column
std::vector<std::size_t> thin_for_display(std::span<const double> x,
                                          std::span<const std::span<const double>> channels,
                                          const DisplayWindow& window);

}  // namespace zerorate::report
