/// @file
/// A model as C++ source, for firmware that has no file system to read it from.
#pragma once

#include <string>

#include "core/base/time.hpp"
#include "firmware/model/sensor_model.hpp"

namespace zerorate::model {

/// A header that defines the constants of namespace zerorate::exported: `kModelShape` and
/// `kNodeParams`, an app::NodeParams with exactly the modes that the model needs and the default
/// times of standstill. Every number is the shortest
/// decimal from which the compiler makes the same bits. Throws what make_full_node_model() throws.
[[nodiscard]] std::string format_cpp_header(const SensorModel& model, core::Duration sample_period,
                                            core::Duration filter_tick);

}  // namespace zerorate::model
