#include "host_tools/python/source.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>
#include <vector>

#include "host_tools/lib/recording/error.hpp"

namespace zerorate::python {
namespace {

/// The elements, of which there must be as many as there are samples.
template <class T>
const T* elements(const std::optional<Array<T>>& array, std::size_t rows, const char* name) {
  if (!array) return nullptr;
  if (array->ndim() != 1 || static_cast<std::size_t>(array->shape(0)) != rows) {
    throw std::invalid_argument(std::string(name) + ": expected one element per sample");
  }
  return array->data();
}

/// The accelerations, of which there must be three a sample.
const float* accelerations(const std::optional<Array<float>>& array, std::size_t rows) {
  if (!array) return nullptr;
  if (array->ndim() != 2 || static_cast<std::size_t>(array->shape(0)) != rows ||
      static_cast<std::size_t>(array->shape(1)) != recording::kMaxAxes) {
    throw std::invalid_argument("acceleration_m_s2: expected n by 3 elements, a row per sample");
  }
  return array->data();
}

/// Hands a vector over to Python without copying it.
template <class T>
py::array to_array(std::vector<T> values, std::vector<py::ssize_t> shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  T* const data = kept->data();
  const py::capsule owner{kept.release(), [](void* vector) {
                            std::unique_ptr<std::vector<T>>{static_cast<std::vector<T>*>(vector)};
                          }};
  return py::array_t<T>(std::move(shape), data, owner);
}

/// Columns of a recording that is read to its end.
struct Table {
  recording::Columns columns;
  std::vector<std::int64_t> time_ns;
  std::vector<float> rate_rad_s;
  std::vector<float> temperature_degc;
  std::vector<std::uint8_t> still;
  std::vector<std::int64_t> odometer_pulses;
  std::vector<float> acceleration_m_s2;
  std::vector<float> ref_heading_rad;
  std::vector<float> ref_rate_rad_s;
  std::vector<float> ref_speed_m_s;

  void add(const recording::Row& row) {
    time_ns.push_back(row.time_ns);
    rate_rad_s.insert(rate_rad_s.end(), row.rate_rad_s.begin(),
                      row.rate_rad_s.begin() + static_cast<std::ptrdiff_t>(columns.axis_count));
    if (columns.temperature) temperature_degc.push_back(row.temperature_degc);
    if (columns.still) still.push_back(row.still ? 1 : 0);
    if (columns.odometer) odometer_pulses.push_back(row.odometer_pulses);
    if (columns.acceleration) {
      acceleration_m_s2.insert(acceleration_m_s2.end(), row.acceleration_m_s2.begin(),
                               row.acceleration_m_s2.end());
    }
    if (columns.ref_heading) ref_heading_rad.push_back(row.ref_heading_rad);
    if (columns.ref_rate) ref_rate_rad_s.push_back(row.ref_rate_rad_s);
    if (columns.ref_speed) ref_speed_m_s.push_back(row.ref_speed_m_s);
  }
};

Table read_table(const Source& source) {
  recording::Reader reader = source.open();
  Table table{.columns = reader.columns()};
  for (recording::Row row; reader.next(row);) table.add(row);
  return table;
}

py::dict read(const Source& source) {
  Table table;
  {
    const py::gil_scoped_release release;
    table = read_table(source);
  }
  const auto rows = static_cast<py::ssize_t>(table.time_ns.size());
  const auto axes = static_cast<py::ssize_t>(table.columns.axis_count);
  py::dict arrays;
  arrays["time_ns"] = to_array(std::move(table.time_ns), {rows});
  arrays["rate_rad_s"] = to_array(std::move(table.rate_rad_s), {rows, axes});
  if (table.columns.temperature)
    arrays["temperature_degc"] = to_array(std::move(table.temperature_degc), {rows});
  if (table.columns.still)
    arrays["still"] = to_array(std::move(table.still), {rows}).attr("view")("bool");
  if (table.columns.odometer)
    arrays["odometer_pulses"] = to_array(std::move(table.odometer_pulses), {rows});
  const auto give = [&](bool is_there, const char* name, std::vector<float>& values) {
    if (is_there) arrays[name] = to_array(std::move(values), {rows});
  };
  give(table.columns.ref_heading, "ref_heading_rad", table.ref_heading_rad);
  give(table.columns.ref_rate, "ref_rate_rad_s", table.ref_rate_rad_s);
  give(table.columns.ref_speed, "ref_speed_m_s", table.ref_speed_m_s);
  if (table.columns.acceleration) {
    constexpr auto kAxes = static_cast<py::ssize_t>(recording::kMaxAxes);
    arrays["acceleration_m_s2"] = to_array(std::move(table.acceleration_m_s2), {rows, kAxes});
  }
  return arrays;
}

recording::Input input_of(const std::string& path, const std::string& columns,
                          const std::string& units, const std::string& delimiter) {
  recording::Input input{path};
  if (!columns.empty()) input.layout.set_columns(columns);
  if (!units.empty()) input.layout.set_units(units);
  if (!delimiter.empty()) input.layout.set_delimiter(delimiter);
  return input;
}

}  // namespace

ArrayRows::ArrayRows(const Samples& samples)
    : time_ns_(samples.time_ns.data()),
      rate_(samples.rate_rad_s.data()),
      rows_(static_cast<std::size_t>(samples.time_ns.size())) {
  const Array<float>& rate = samples.rate_rad_s;
  if (samples.time_ns.ndim() != 1 || rate.ndim() != 2 ||
      static_cast<std::size_t>(rate.shape(0)) != rows_ ||
      (rate.shape(1) != 1 && rate.shape(1) != 3)) {
    throw std::invalid_argument(
        "expected n times and n by 3 rates (or n by 1 of a single axis) in rad/s");
  }
  temperature_ = elements(samples.temperature_degc, rows_, "temperature_degc");
  still_ = elements(samples.still, rows_, "still");
  pulses_ = elements(samples.odometer_pulses, rows_, "odometer_pulses");
  acceleration_ = accelerations(samples.acceleration_m_s2, rows_);
  ref_heading_ = elements(samples.ref_heading_rad, rows_, "ref_heading_rad");
  ref_rate_ = elements(samples.ref_rate_rad_s, rows_, "ref_rate_rad_s");
  ref_speed_ = elements(samples.ref_speed_m_s, rows_, "ref_speed_m_s");
  columns_ = {.axis_count = static_cast<std::size_t>(rate.shape(1)),
              .temperature = temperature_ != nullptr,
              .odometer = pulses_ != nullptr,
              .still = still_ != nullptr,
              .ref_heading = ref_heading_ != nullptr,
              .ref_rate = ref_rate_ != nullptr,
              .ref_speed = ref_speed_ != nullptr,
              .acceleration = acceleration_ != nullptr};
}

bool ArrayRows::next(recording::Row& row) {
  if (row_ == rows_) return false;
  row = {.time_ns = time_ns_[row_]};
  for (std::size_t i = 0; i < columns_.axis_count; ++i) {
    row.rate_rad_s[i] = rate_[row_ * columns_.axis_count + i];
  }
  if (temperature_ != nullptr) row.temperature_degc = temperature_[row_];
  if (still_ != nullptr) row.still = still_[row_];
  if (pulses_ != nullptr) row.odometer_pulses = pulses_[row_];
  if (acceleration_ != nullptr) {
    std::copy_n(acceleration_ + row_ * recording::kMaxAxes, recording::kMaxAxes,
                row.acceleration_m_s2.begin());
  }
  if (ref_heading_ != nullptr) row.ref_heading_rad = ref_heading_[row_];
  if (ref_rate_ != nullptr) row.ref_rate_rad_s = ref_rate_[row_];
  if (ref_speed_ != nullptr) row.ref_speed_m_s = ref_speed_[row_];
  ++row_;
  return true;
}

recording::Reader Source::open() const {
  if (!samples_) return recording::Reader{input_};
  if (samples_->time_ns.size() == 0) throw recording::DataError("the recording has no sample");
  return recording::Reader{std::make_unique<ArrayRows>(*samples_), "the arrays"};
}

void add_source(py::module_& module) {
  py::class_<Source>(module, "Source")
      .def(py::init([](const std::string& path, const std::string& columns,
                       const std::string& units, const std::string& delimiter) {
             return Source{input_of(path, columns, units, delimiter)};
           }),
           py::arg("path"), py::arg("columns") = "", py::arg("units") = "",
           py::arg("delimiter") = "")
      .def_static(
          "of_arrays",
          [](Array<std::int64_t> time_ns, Array<float> rate_rad_s,
             std::optional<Array<float>> temperature_degc, std::optional<Array<bool>> still,
             std::optional<Array<std::int64_t>> odometer_pulses,
             std::optional<Array<float>> acceleration_m_s2,
             std::optional<Array<float>> ref_heading_rad,
             std::optional<Array<float>> ref_rate_rad_s,
             std::optional<Array<float>> ref_speed_m_s) {
            Samples samples{std::move(time_ns),          std::move(rate_rad_s),
                            std::move(temperature_degc), std::move(still),
                            std::move(odometer_pulses),  std::move(acceleration_m_s2),
                            std::move(ref_heading_rad),  std::move(ref_rate_rad_s),
                            std::move(ref_speed_m_s)};
            static_cast<void>(ArrayRows{samples});  // complains here rather than later
            return Source{std::move(samples)};
          },
          py::arg("time_ns"), py::arg("rate_rad_s"), py::arg("temperature_degc") = py::none(),
          py::arg("still") = py::none(), py::arg("odometer_pulses") = py::none(),
          py::arg("acceleration_m_s2") = py::none(), py::arg("ref_heading_rad") = py::none(),
          py::arg("ref_rate_rad_s") = py::none(), py::arg("ref_speed_m_s") = py::none())
      .def("read", &read);
}

}  // namespace zerorate::python
