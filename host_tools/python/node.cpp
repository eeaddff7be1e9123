#include "host_tools/python/node.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "firmware/app/rate_message.hpp"
#include "firmware/model/catalogue.hpp"
#include "firmware/model/model_file.hpp"
#include "host_tools/lib/evaluate/feed.hpp"
#include "host_tools/lib/evaluate/replay_node.hpp"
#include "host_tools/lib/identify/rest_check.hpp"
#include "host_tools/python/source.hpp"

namespace zerorate::python {
namespace {

/// Messages of the node as arrays that Python owns and this code fills.
struct Messages {
  py::array_t<float> corrected;
  py::array_t<float> bias;
  py::array_t<float> sigma;
  py::array_t<float> turn;
  py::array_t<float> turn_sigma;
  py::array_t<bool> still;
  py::array_t<bool> calibrated;
  py::array_t<bool> has_rate;
  py::array_t<bool> model_inconsistent;
  py::array_t<bool> saturated;
  py::array_t<bool> temperature_missing;
  py::array_t<bool> odometer_disagreement;

  Messages(py::ssize_t rows, py::ssize_t axes)
      : corrected({rows, axes}),
        bias({rows, axes}),
        sigma({rows, axes}),
        turn({rows, axes}),
        turn_sigma({rows, axes}),
        still(rows),
        calibrated(rows),
        has_rate(rows),
        model_inconsistent(rows),
        saturated(rows),
        temperature_missing(rows),
        odometer_disagreement(rows) {}

  [[nodiscard]] py::dict by_name() const {
    py::dict names;
    names["corrected_rad_s"] = corrected;
    names["bias_rad_s"] = bias;
    names["sigma_rad_s"] = sigma;
    names["turn_rad"] = turn;
    names["turn_sigma_rad"] = turn_sigma;
    names["still"] = still;
    names["calibrated"] = calibrated;
    names["has_rate"] = has_rate;
    names["model_inconsistent"] = model_inconsistent;
    names["saturated"] = saturated;
    names["temperature_missing"] = temperature_missing;
    names["odometer_disagreement"] = odometer_disagreement;
    return names;
  }
};

/// Memory of those arrays, for work without the interpreter's lock.
struct MessagePlaces {
  std::size_t axes;
  float* corrected;
  float* bias;
  float* sigma;
  float* turn;
  float* turn_sigma;
  bool* still;
  bool* calibrated;
  bool* has_rate;
  bool* model_inconsistent;
  bool* saturated;
  bool* temperature_missing;
  bool* odometer_disagreement;

  explicit MessagePlaces(Messages& messages)
      : axes(static_cast<std::size_t>(messages.corrected.shape(1))),
        corrected(messages.corrected.mutable_data()),
        bias(messages.bias.mutable_data()),
        sigma(messages.sigma.mutable_data()),
        turn(messages.turn.mutable_data()),
        turn_sigma(messages.turn_sigma.mutable_data()),
        still(messages.still.mutable_data()),
        calibrated(messages.calibrated.mutable_data()),
        has_rate(messages.has_rate.mutable_data()),
        model_inconsistent(messages.model_inconsistent.mutable_data()),
        saturated(messages.saturated.mutable_data()),
        temperature_missing(messages.temperature_missing.mutable_data()),
        odometer_disagreement(messages.odometer_disagreement.mutable_data()) {}

  void put(std::size_t row, const app::RateMessage& message) const {
    for (std::size_t i = 0; i < axes; ++i) {
      const app::AxisRate& axis = message.axes[i];
      corrected[row * axes + i] = axis.corrected.in(core::rad_per_s);
      bias[row * axes + i] = axis.bias.in(core::rad_per_s);
      sigma[row * axes + i] = axis.sigma.in(core::rad_per_s);
      turn[row * axes + i] = message.turn[i].angle.in(core::rad);
      turn_sigma[row * axes + i] = message.turn[i].sigma.in(core::rad);
    }
    still[row] = message.motion == core::Motion::still;
    calibrated[row] = message.health.calibrated;
    has_rate[row] = message.has_rate();
    model_inconsistent[row] = message.health.model_inconsistent;
    saturated[row] = message.health.saturated;
    temperature_missing[row] = message.health.temperature_missing;
    odometer_disagreement[row] = message.health.odometer_disagreement;
  }
};

/// A node of some shape.
class AnyNode {
 public:
  virtual ~AnyNode() = default;
  virtual void run(ArrayRows& rows, const MessagePlaces& places) = 0;
};

template <core::ModelShape Shape>
class NodeOfShape : public AnyNode {
 public:
  NodeOfShape(const evaluate::ReplayOptions& options, const recording::Columns& columns,
              const evaluate::SampleTiming& timing, std::int64_t first_time_ns)
      : node_(options, columns, timing, first_time_ns), feed_(node_.node(), columns.axis_count) {}

  void run(ArrayRows& rows, const MessagePlaces& places) override {
    recording::Row row;
    for (std::size_t i = 0; rows.next(row); ++i) {
      const auto arrival = node_.arrive(row);
      places.put(i, feed_.feed(arrival.sample, arrival.pulses));
    }
  }

 private:
  evaluate::ReplayNode<Shape> node_;
  evaluate::DirectFeed<typename evaluate::ReplayNode<Shape>::Node> feed_;
};

/// The node of Python. It begins with its first samples, which fix the columns.
class Node {
 public:
  /// @param sample_period_s  nullopt: the mean interval of the first samples, as in a replay
  Node(NodeOptions options, std::optional<double> sample_period_s)
      : options_(to_replay_options(options)), sample_period_s_(sample_period_s) {}

  py::dict replay(Samples samples) {
    ArrayRows rows{samples};
    Messages messages{samples.rate_rad_s.shape(0), samples.rate_rad_s.shape(1)};
    if (rows.rows() == 0) return messages.by_name();
    if (!node_) begin(samples, rows.columns());
    if (rows.columns() != columns_) {
      throw std::invalid_argument("the node was begun with other columns");
    }
    {
      const MessagePlaces places{messages};
      const py::gil_scoped_release release;
      const std::scoped_lock lock{*one_at_a_time_};  // other threads of Python run meanwhile
      node_->run(rows, places);
    }
    return messages.by_name();
  }

 private:
  [[nodiscard]] core::Duration sample_period(const Samples& samples) const {
    if (sample_period_s_) {
      if (!(*sample_period_s_ > 0.0 && *sample_period_s_ < 1e6)) {
        throw std::invalid_argument("sample_period_s: expected a positive number of seconds");
      }
      return core::Duration::nanoseconds(std::llround(*sample_period_s_ * 1e9));
    }
    recording::Reader reader{std::make_unique<ArrayRows>(samples), "the arrays"};
    recording::Row row;
    for (std::size_t i = 0; i < evaluate::kRowsAhead && reader.next(row); ++i) {
    }
    const std::int64_t period_ns = reader.findings().mean_interval_ns();
    if (period_ns == 0) {
      throw std::invalid_argument(
          "one sample does not determine the sample period: give Node(sample_period_s=...)");
    }
    return core::Duration::nanoseconds(period_ns);
  }

  void begin(const Samples& samples, const recording::Columns& columns) {
    const core::Duration period = sample_period(samples);
    const evaluate::SampleTiming timing{period, evaluate::filter_tick(options_, period)};
    const std::int64_t first_ns = samples.time_ns.data()[0];
    node_ = model::with_shape_of<model::kLargestLearningShape>(
        options_.model, columns.acceleration,
        [&]<core::ModelShape Shape>() -> std::unique_ptr<AnyNode> {
          return std::make_unique<NodeOfShape<Shape>>(options_, columns, timing, first_ns);
        });
    columns_ = columns;
  }

  evaluate::ReplayOptions options_;
  std::optional<double> sample_period_s_;
  recording::Columns columns_;
  std::unique_ptr<AnyNode> node_;
  std::unique_ptr<std::mutex> one_at_a_time_ = std::make_unique<std::mutex>();
};

core::Duration seconds(double value, const char* name) {
  if (!(value >= 0.0 && value <= 1e6)) {
    throw std::invalid_argument(std::string(name) + ": expected seconds from 0 to 1e6");
  }
  return core::Duration::nanoseconds(std::llround(value * 1e9));
}

}  // namespace

model::SensorModel model_of(const std::string& text) {
  const bool is_toml = text.find('\n') != std::string::npos;
  return is_toml ? model::parse_model(text, "model") : model::load_model(text);
}

evaluate::ReplayOptions to_replay_options(const NodeOptions& options) {
  evaluate::ReplayOptions replay;
  replay.model = model_of(options.model);
  replay.filter_rate_hz = options.filter_rate_hz;
  replay.standstill = {.settle = seconds(options.settle_s, "settle_s"),
                       .hold_back = seconds(options.hold_back_s, "hold_back_s"),
                       .source = identify::rest_source(options.still_from)};
  replay.learns_noise = options.learns_noise;
  return replay;
}

void add_node(py::module_& module) {
  py::class_<NodeOptions>(module, "NodeOptions")
      .def(py::init<>())
      .def_readwrite("model", &NodeOptions::model)
      .def_readwrite("still_from", &NodeOptions::still_from)
      .def_readwrite("learns_noise", &NodeOptions::learns_noise)
      .def_readwrite("filter_rate_hz", &NodeOptions::filter_rate_hz)
      .def_readwrite("settle_s", &NodeOptions::settle_s)
      .def_readwrite("hold_back_s", &NodeOptions::hold_back_s);
  py::class_<Node>(module, "Node")
      .def(py::init<NodeOptions, std::optional<double>>(), py::arg("options"),
           py::arg("sample_period_s") = py::none())
      .def(
          "replay",
          [](Node& node, Array<std::int64_t> time_ns, Array<float> rate_rad_s,
             std::optional<Array<float>> temperature_degc, std::optional<Array<bool>> still,
             std::optional<Array<std::int64_t>> odometer_pulses,
             std::optional<Array<float>> acceleration_m_s2) {
            return node.replay({std::move(time_ns), std::move(rate_rad_s),
                                std::move(temperature_degc), std::move(still),
                                std::move(odometer_pulses), std::move(acceleration_m_s2)});
          },
          py::arg("time_ns"), py::arg("rate_rad_s"), py::arg("temperature_degc") = py::none(),
          py::arg("still") = py::none(), py::arg("odometer_pulses") = py::none(),
          py::arg("acceleration_m_s2") = py::none());
}

}  // namespace zerorate::python
