#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/model_fields.hpp"
#include "firmware/model/model_file.hpp"
#include "firmware/toml/strict_table.hpp"
#include "firmware/toml/toml.hpp"

namespace zerorate::model {
namespace {

/// A visitor of model_fields.hpp that reads one table.
class TableReader {
 public:
  explicit TableReader(toml_file::StrictTable& table) : table_(table) {}

  void number(std::string_view key, double& si, FileUnit unit, const Rule& rule,
              Presence presence) {
    const toml::node* const node = table_.find(key, rule.words, presence);
    if (node == nullptr) return;
    const double value = table_.checked_number(*node, key, rule);
    si = si_from_decimal(table_.document().decimal(*node, value), unit);
  }
  void number(std::string_view key, int& value, FileUnit /*unit*/, const Rule& rule,
              Presence presence) {
    if (const auto read = table_.integer(key, rule, presence)) value = static_cast<int>(*read);
  }
  void text(std::string_view key, std::string& value, Presence presence) {
    if (const auto read = table_.text(key, presence)) value = *read;
  }
  void start(std::string_view key, core::Start& value) {
    constexpr std::array kStarts{core::Start::stationary, core::Start::zero};
    static constexpr std::array kNames{start_name(kStarts[0]), start_name(kStarts[1])};
    if (const auto read = table_.choice(key, kNames, Presence::optional)) value = kStarts[*read];
  }

  template <class Part>
  void table(std::string_view key, Part& part, Presence presence) {
    if (auto found = table_.table(key, presence)) read(*found, part);
  }
  template <class Part>
  void table(std::string_view key, std::optional<Part>& part) {
    if (table_.find(key, "", Presence::optional) != nullptr) {
      table(key, part.emplace(), Presence::required);
    }
  }
  template <class Part>
  void tables(std::string_view key, std::vector<Part>& parts) {
    auto tables = table_.tables(key);
    for (toml_file::StrictTable& table : tables) read(table, parts.emplace_back());
  }

 private:
  template <class Part>
  static void read(toml_file::StrictTable& table, Part& part) {
    TableReader inside(table);
    visit_fields(inside, part);
    table.reject_unknown();
  }

  toml_file::StrictTable& table_;
};

}  // namespace

SensorModel parse_model(std::string_view toml, std::string_view origin) {
  const toml_file::Document document(toml, origin);
  const toml::table parsed = document.parse();
  toml_file::StrictTable table(document, parsed, "");
  if (*table.text("schema", Presence::required) != kModelSchema) {
    table.fail_at("schema", "expected \"" + std::string(kModelSchema) + "\"");
  }
  SensorModel model;
  TableReader reader(table);
  visit_fields(reader, model);
  table.reject_unknown();
  return model;
}

SensorModel read_model(const std::filesystem::path& file) {
  return parse_model(toml_file::read_text(file.string()), file.string());
}

}  // namespace zerorate::model
