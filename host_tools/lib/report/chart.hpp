/// @file
/// Data of a chart, drawn in the reader's browser when the report is opened.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace zerorate::report {

enum class Scale { linear, logarithmic };

/// The inks of all charts, told apart under the common colour-vision deficiencies and in grey
/// print. `by_position` takes them in this order, so that a chart needs no colours of its own;
/// naming one keeps a quantity's colour the same from chart to chart.
enum class Colour { by_position, blue, vermilion, green, purple, amber, grey, ink };

struct Axis {
  std::string label{};  ///< name of the quantity: "Cluster time"
  std::string unit{};   ///< "s", "deg/h"; empty for a ratio or a count
  Scale scale = Scale::linear;
  double origin = 0.0;  ///< zero of the axis: the chart shows x minus it (of y: unused)
};

/// Style in which the points of a series are drawn.
enum class SeriesStyle {
  line,
  steps,  ///< the value holds until the next point
  points
};

/// y over x. Equally long, x finite and not decreasing. A y that is not finite breaks the line; on
/// a logarithmic axis so does one that is not positive, and points with such an x are left out.
struct Series {
  std::string name{};
  std::vector<double> x{};
  std::vector<double> y{};
  SeriesStyle style = SeriesStyle::line;
  Colour colour = Colour::by_position;
  bool dashed = false;       ///< for truth, limits and references
  bool marks = false;        ///< a dot at every point besides the line
  std::vector<double> lo{};  ///< lower and upper edge of the uncertainty band: both as long as y,
  std::vector<double> hi{};  ///< or both empty for none
};

/// A range of x, for example one standstill.
struct Interval {
  double from;
  double to;
};

/// Curves over a common x axis, with zoom and a read-out under the pointer.
struct Chart {
  std::string title{};
  std::string caption{};  ///< explanation, and how the figure was made
  Axis x{};
  Axis y{};
  std::vector<Series> series{};
  std::vector<Interval> shaded{};
  std::string shaded_name{};  ///< legend of the shaded ranges: "standstill"
};

/// One bar a category. Values that are not finite leave their place empty.
struct BarGroup {
  std::string name{};
  std::vector<double> values{};
  Colour colour = Colour::by_position;
  std::vector<double> lo{};  ///< ends of the error bars: both as long as values, or both empty
  std::vector<double> hi{};
};

/// A level to compare the bars with: 1 for a ratio, 0.95 for a coverage.
struct Reference {
  std::string name{};
  double value = 0;
};

/// Groups of bars side by side in every category, on an axis that contains zero.
struct BarChart {
  std::string title{};
  std::string caption{};
  Axis y{};  ///< linear: the length of a bar is its value
  std::vector<std::string> categories{};
  std::vector<BarGroup> groups{};
  std::optional<Reference> reference{};
};

}  // namespace zerorate::report
