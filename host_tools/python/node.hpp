/// @file
/// The firmware's node for Python.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>

#include "core/standstill/standstill.hpp"
#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/evaluate/replay.hpp"

namespace zerorate::python {

/// Options of a node as a user gives them; the defaults are those of `zerorate replay`.
struct NodeOptions {
  std::string model = "adis16405";
  std::string still_from = "odometer";
  bool learns_noise = true;
  std::optional<double> filter_rate_hz;
  double settle_s = 1.0;
  double hold_back_s = 0.5;
};

/// A model as TOML text (of more than one line), the name of a file or of the catalogue.
[[nodiscard]] model::SensorModel model_of(const std::string& text);

/// Throws std::invalid_argument, model::ModelFileError.
[[nodiscard]] evaluate::ReplayOptions to_replay_options(const NodeOptions& options);

/// Adds the classes NodeOptions and Node to the module.
void add_node(pybind11::module_& module);

}  // namespace zerorate::python
