#include "firmware/model/catalogue.hpp"

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/model/model_file.hpp"
#include "firmware/toml/error.hpp"

namespace zerorate::model {

SensorModel find_model(std::string_view name) {
  std::vector<std::string_view> names;
  for (const CatalogueEntry& entry : catalogue()) {
    if (entry.name == name) {
      return parse_model(entry.toml, "catalogue/" + std::string(name) + ".toml");
    }
    names.push_back(entry.name);
  }
  throw std::invalid_argument("no sensor model \"" + std::string(name) + "\" in the catalogue" +
                              toml_file::suggestion(name, names));
}

SensorModel load_model(const std::string& name) {
  const bool is_file = std::filesystem::exists(name) || name.ends_with(".toml");
  return is_file ? read_model(name) : find_model(name);
}

}  // namespace zerorate::model
