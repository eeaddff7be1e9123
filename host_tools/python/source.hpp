/// @file
/// Recordings as Python hands them over: the path of a file, or NumPy arrays.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "host_tools/lib/recording/input.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::python {

namespace py = pybind11;

template <class T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

/// Samples of a recording, one element or row per sample. Nothing is copied where the types agree.
struct Samples {
  Array<std::int64_t> time_ns;
  Array<float> rate_rad_s;  ///< n by 3, or n by 1
  std::optional<Array<float>> temperature_degc;
  std::optional<Array<bool>> still;
  std::optional<Array<std::int64_t>> odometer_pulses;
  std::optional<Array<float>> acceleration_m_s2;  ///< n by 3
  std::optional<Array<float>> ref_heading_rad;
  std::optional<Array<float>> ref_rate_rad_s;
  std::optional<Array<float>> ref_speed_m_s;
};

/// Gives the rows of arrays; they must live as long. Needs no lock of the interpreter.
class ArrayRows : public recording::RowSource {
 public:
  /// Throws std::invalid_argument where the arrays do not agree in length.
  explicit ArrayRows(const Samples& samples);

  [[nodiscard]] const recording::Columns& columns() const override { return columns_; }
  [[nodiscard]] bool next(recording::Row& row) override;
  [[nodiscard]] std::uint64_t line() const override { return row_; }
  [[nodiscard]] std::optional<double> fraction_read() const override { return std::nullopt; }
  [[nodiscard]] std::size_t rows() const { return rows_; }

 private:
  recording::Columns columns_;
  const std::int64_t* time_ns_;
  const float* rate_;
  const float* temperature_ = nullptr;
  const bool* still_ = nullptr;
  const float* acceleration_ = nullptr;
  const std::int64_t* pulses_ = nullptr;
  const float* ref_heading_ = nullptr;
  const float* ref_rate_ = nullptr;
  const float* ref_speed_ = nullptr;
  std::size_t rows_;
  std::size_t row_ = 0;
};

/// A recording that can be read more than once.
class Source {
 public:
  explicit Source(recording::Input input) : input_(std::move(input)) {}
  explicit Source(Samples samples) : samples_(std::move(samples)) {}

  /// Throws recording::Error, std::invalid_argument.
  [[nodiscard]] recording::Reader open() const;

 private:
  recording::Input input_;
  std::optional<Samples> samples_;
};

/// Adds the class Source to the module.
void add_source(py::module_& module);

}  // namespace zerorate::python
