/// @file
/// The sensor models that come with the project: data-sheet figures, each with its source.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "firmware/model/sensor_model.hpp"

namespace zerorate::model {

struct CatalogueEntry {
  std::string_view name;  ///< name on the command line, e.g. "adis16405"
  std::string_view toml;  ///< the file catalogue/NAME.toml, linked into the program
};

/// All entries, by name.
[[nodiscard]] std::span<const CatalogueEntry> catalogue();

/// The model called `name`. Throws std::invalid_argument, with the nearest name, where there is
/// none.
[[nodiscard]] SensorModel find_model(std::string_view name);

/// A file if there is one of that name, else an entry of the catalogue. Throws
/// model::ModelFileError, std::system_error, std::invalid_argument.
[[nodiscard]] SensorModel load_model(const std::string& name);

}  // namespace zerorate::model
