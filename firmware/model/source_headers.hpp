/// @file
/// A model as C or C++ source, for firmware that has no file system to read it from.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/base/time.hpp"
#include "core/noise/temperature_drift.hpp"
#include "firmware/model/hypotheses.hpp"
#include "firmware/model/sensor_model.hpp"

namespace zerorate::model {

/// The modes that a node behind the C interface has room for.
inline constexpr core::ModelShape kCApiShape{
    .decaying = 7,
    .rotating = 1,
    .temperature_weights = core::TemperatureDrift::kWeights,
    .hypotheses = kMostHypotheses};

/// A header that defines `static const zerorate_model NAME`. Every number is the shortest decimal
/// from which the compiler makes the same bits.
/// Throws what make_node_model() throws, and std::invalid_argument where `name` is no identifier.
[[nodiscard]] std::string format_c_header(const SensorModel& model, core::Duration sample_period,
                                          core::Duration filter_tick, std::string_view name);

/// A header that defines the constants of namespace zerorate::exported: `kModelShape` and
/// `kNodeParams`, an app::NodeParams with exactly the modes that the model needs and the default
/// times of standstill. Every number is the shortest
/// decimal from which the compiler makes the same bits. Throws what make_full_node_model() throws.
[[nodiscard]] std::string format_cpp_header(const SensorModel& model, core::Duration sample_period,
                                            core::Duration filter_tick);

}  // namespace zerorate::model
