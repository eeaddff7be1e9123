/// @file
/// Sensor models as TOML files, schema `zerorate.model/2`; see docs/reference/model-format.md.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "firmware/model/sensor_model.hpp"
#include "firmware/toml/error.hpp"

namespace zerorate::model {

inline constexpr std::string_view kModelSchema = "zerorate.model/2";
/// Schema before it, which is read too: its `bias_instability_dph` is the floor of the Allan
/// deviation, 0.664 B.
inline constexpr std::string_view kFirstModelSchema = "zerorate.model/1";

/// A model file that cannot be read; what() is `file:line:column: what was expected`.
using ModelFileError = toml_file::Error;

/// Reads a model from TOML text. `origin` is the file's name in messages. Strict: an unknown key
/// or table, a wrong type, a missing key and an impossible value are ModelFileErrors, the first
/// with the nearest known name.
[[nodiscard]] SensorModel parse_model(std::string_view toml, std::string_view origin);

/// Reads a model file. Throws ModelFileError; std::system_error where it cannot be opened.
[[nodiscard]] SensorModel read_model(const std::filesystem::path& file);

/// The model as TOML text, each number as the shortest decimal from which parse_model gives the
/// same bits. Throws std::invalid_argument for a model that no file can hold (see validate()).
[[nodiscard]] std::string format_model(const SensorModel& model);

}  // namespace zerorate::model
