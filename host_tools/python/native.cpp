/// The module `zerorate._native`: what the package `zerorate` computes, by the libraries of the
/// command line. Results cross as the JSON of the command line, so that there is one set of
/// figures.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "firmware/model/catalogue.hpp"
#include "firmware/model/model_file.hpp"
#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/diagnose/presentation/presentation.hpp"
#include "host_tools/lib/diagnose/truncation_cause.hpp"
#include "host_tools/lib/identify/allan_deviation.hpp"
#include "host_tools/lib/identify/characterization_report.hpp"
#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/identify/rest_check.hpp"
#include "host_tools/python/evaluation.hpp"
#include "host_tools/python/node.hpp"
#include "host_tools/python/source.hpp"

namespace zerorate::python {
namespace {

/// JSON, models as TOML by axis, and what speaks against rest.
using Outcome =
    std::tuple<std::string, std::map<std::string, std::string>, std::vector<std::string>>;

Outcome characterize(const Source& source, const std::string& name, const std::string& axis,
                     std::optional<double> order, const std::string& still_from,
                     const std::string& accept) {
  recording::Reader reader = source.open();
  auto axes = identify::axes_called(axis, reader.columns().axis_count);
  const identify::RestSamples samples =
      identify::read_rest(reader, identify::rest_source(still_from));
  const identify::AcceptedDoubts accepted{accept};
  std::vector<std::string> doubts = identify::require_rest(samples, accepted, axes);
  std::ranges::move(diagnose::remarks_on_truncation(samples, accepted), std::back_inserter(doubts));
  identify::Characterization result =
      identify::characterize(samples, {.recording = name, .axes = axes, .order = order});
  if (still_from == "gyro") identify::require_noise_of_rest(result);
  result.doubts = doubts;
  std::map<std::string, std::string> models;
  for (const auto& one : result.axes) models[one.axis] = model::format_model(one.model);
  return {identify::to_json(result), std::move(models), std::move(doubts)};
}

/// Curves of the Allan deviation of each axis: tau, recording, and low, middle and high of the base
/// and of the extended model, a row each.
using Curves = std::map<std::string, std::vector<std::array<double, 8>>>;

std::tuple<Outcome, Curves> diagnose_recording(const Source& source, const std::string& name,
                                               const std::string& axis,
                                               const std::optional<std::string>& model,
                                               double holdout, const std::string& still_from,
                                               const std::string& accept) {
  recording::Reader reader = source.open();
  auto axes = identify::axes_called(axis, reader.columns().axis_count);
  const core::StandstillSource rest = identify::rest_source(still_from);
  identify::RestSamples samples = identify::read_rest(reader, rest);
  if (rest == core::StandstillSource::odometer && reader.columns().odometer) {
    const identify::MotionAtRest motion = identify::find_motion(samples);
    if (motion.is_usual()) identify::leave_out_motion(samples, motion);
  }
  const identify::AcceptedDoubts accepted{accept};
  std::vector<std::string> doubts = identify::require_rest(samples, accepted, axes);
  std::vector<diagnose::Record> records = diagnose::records_of(samples, axes, accepted);
  if (!(holdout > 0.0 && holdout < 1.0)) {
    throw std::invalid_argument("holdout: expected a share above 0 and below 1");
  }
  diagnose::DiagnoseOptions options{.recording = name, .holdout = holdout};
  if (model) options.base_model = model_of(*model);
  options.on_left_out = [&](const std::string& which, const std::string& reason) {
    doubts.push_back("axis " + which + " was not diagnosed: " + reason);
  };
  const auto diagnoses = diagnose::diagnose(std::move(records), options);
  std::map<std::string, std::string> models;
  Curves curves;
  for (const diagnose::Diagnosis& one : diagnoses) {
    models[one.axis] = model::format_model(one.extended_model);
    for (const diagnose::CurvePoint& point : one.allan) {
      curves[one.axis].push_back({point.x, point.measured, point.base_lo, point.base, point.base_hi,
                                  point.extended_lo, point.extended, point.extended_hi});
    }
  }
  return {Outcome{diagnose::to_json(diagnoses, doubts), std::move(models), std::move(doubts)},
          std::move(curves)};
}

/// tau, Allan deviation, its 95 % interval and its equivalent degrees of freedom.
py::tuple allan_deviation(const Array<double>& rate, double sample_period_s,
                          double points_per_decade) {
  if (rate.ndim() != 1) throw std::invalid_argument("expected the rates of one axis");
  if (!(sample_period_s > 0.0 && sample_period_s <= 1e6)) {
    throw std::invalid_argument("sample_period_s: expected seconds, above 0 and at most 1e6");
  }
  if (!(points_per_decade >= 1.0 && points_per_decade <= 1000.0)) {
    throw std::invalid_argument("points_per_decade: expected a number from 1 to 1000");
  }
  const std::span<const double> values{rate.data(), static_cast<std::size_t>(rate.size())};
  std::vector<identify::AllanPoint> points;
  {
    const py::gil_scoped_release release;
    points = identify::allan_deviation(values, sample_period_s,
                                       {.points_per_decade = points_per_decade});
  }
  const auto column = [&](double identify::AllanPoint::*member) {
    py::array_t<double> array(static_cast<py::ssize_t>(points.size()));
    std::ranges::transform(points, array.mutable_data(), member);
    return array;
  };
  return py::make_tuple(column(&identify::AllanPoint::tau_s), column(&identify::AllanPoint::adev),
                        column(&identify::AllanPoint::lo), column(&identify::AllanPoint::hi),
                        column(&identify::AllanPoint::edf));
}

std::vector<std::string> model_names() {
  std::vector<std::string> names;
  for (const auto& entry : model::catalogue()) names.emplace_back(entry.name);
  return names;
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(std::move(thrown));
  } catch (const std::system_error& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  }
}

}  // namespace
}  // namespace zerorate::python

PYBIND11_MODULE(_native, module) {
  namespace python = zerorate::python;
  namespace py = pybind11;
  py::register_exception_translator(&python::translate);
  py::register_exception<zerorate::recording::DataError>(module, "RecordingError",
                                                         PyExc_ValueError);
  py::register_exception<zerorate::model::ModelFileError>(module, "ModelError", PyExc_ValueError);
  python::add_source(module);
  python::add_node(module);
  using Unlocked = py::call_guard<py::gil_scoped_release>;
  module.attr("__version__") = ZERORATE_VERSION;
  module.def("characterize", &python::characterize, Unlocked());
  module.def("diagnose", &python::diagnose_recording, Unlocked());
  module.def("evaluate", &python::evaluate_recording, Unlocked());
  module.def("allan_deviation", &python::allan_deviation);
  module.def("model_names", &python::model_names);
  module.def("model_text", [](const std::string& name) {
    return zerorate::model::format_model(python::model_of(name));
  });
}
