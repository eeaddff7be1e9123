#include "firmware/model/model_file.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/model_fields.hpp"
#include "firmware/model/sensor_model.hpp"
#include "firmware/toml/strict_table.hpp"
#include "firmware/toml/toml.hpp"

namespace zerorate::model {
namespace {

/// A visitor of model_fields.hpp that reads one table.
class TableReader {
 public:
  TableReader(toml_file::StrictTable& table, bool is_first_schema)
      : table_(table), is_first_schema_(is_first_schema) {}

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
  /// A number of each axis; zeros where the key is absent.
  void axes(std::string_view key, std::array<double, 3>& si, FileUnit unit, const Rule& rule) {
    const auto nodes = table_.numbers(key, si.size(), rule);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const double value = table_.checked_number(*nodes[i], key, rule);
      si.at(i) = si_from_decimal(table_.document().decimal(*nodes[i], value), unit);
    }
  }
  /// B itself, or the floor of the Allan deviation that data sheets state.
  void bias_instability(double& si, const Rule& rule) {
    constexpr std::string_view kItself = "bias_instability_dph";
    constexpr std::string_view kFloor = "allan_floor_dph";
    const FileUnit unit =
        is_first_schema_ ? FileUnit::degree_per_hour_floor : FileUnit::degree_per_hour;
    if (is_first_schema_ || table_.find(kFloor, rule.words, Presence::optional) == nullptr) {
      return number(kItself, si, unit, rule, Presence::required);
    }
    if (table_.find(kItself, rule.words, Presence::optional) != nullptr) {
      table_.fail_at(kFloor, "expected this or \"bias_instability_dph\", not both");
    }
    number(kFloor, si, FileUnit::degree_per_hour_floor, rule, Presence::required);
  }
  void text(std::string_view key, std::string& value, Presence presence) {
    if (const auto read = table_.text(key, presence)) value = *read;
  }
  /// One of the values of an enumeration, whose names stand in its order.
  template <class Enumeration>
  void name(std::string_view key, Enumeration& value, std::span<const std::string_view> names) {
    if (const auto read = table_.choice(key, names, Presence::optional)) {
      value = static_cast<Enumeration>(*read);
    }
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
  void read(toml_file::StrictTable& table, Part& part) {
    TableReader inside(table, is_first_schema_);
    visit_fields(inside, part);
    table.reject_unknown();
  }

  toml_file::StrictTable& table_;
  bool is_first_schema_;
};

}  // namespace

SensorModel parse_model(std::string_view toml, std::string_view origin) {
  const toml_file::Document document(toml, origin);
  const toml::table parsed = document.parse();
  toml_file::StrictTable table(document, parsed, "");
  const std::string schema = *table.text("schema", Presence::required);
  const bool is_first_schema = schema == kFirstModelSchema;
  if (!is_first_schema && schema != kModelSchema) {
    table.fail_at("schema", "expected \"" + std::string(kModelSchema) + "\"");
  }
  SensorModel model;
  TableReader reader(table, is_first_schema);
  visit_fields(reader, model);
  table.reject_unknown();
  return model;
}

SensorModel read_model(const std::filesystem::path& file) {
  return parse_model(toml_file::read_text(file.string()), file.string());
}

namespace {

/// `text` in double quotes, escaped.
std::string toml_string(std::string_view text) {
  std::ostringstream out;
  const toml::value<std::string> value(text);
  out << toml::toml_formatter(value, toml::format_flags::allow_unicode_strings);
  return out.str();
}

/// A visitor of model_fields.hpp that writes `key = value` lines.
class Writer {
 public:
  void number(std::string_view key, double si, FileUnit unit, const Rule& /*rule*/,
              Presence /*presence*/) {
    line(key, decimal_from_si(si, unit));
  }
  /// Nothing where all are zero, which is the default.
  void axes(std::string_view key, const std::array<double, 3>& si, FileUnit unit,
            const Rule& /*rule*/) {
    if (si == std::array<double, 3>{}) return;
    line(key, "[" + decimal_from_si(si[0], unit) + ", " + decimal_from_si(si[1], unit) + ", " +
                  decimal_from_si(si[2], unit) + "]");
  }
  void bias_instability(double si, const Rule& rule) {
    number("bias_instability_dph", si, FileUnit::degree_per_hour, rule, Presence::required);
  }
  void text(std::string_view key, const std::string& value, Presence presence) {
    if (presence == Presence::required || !value.empty()) {
      line(key, toml_string(value));
    }
  }
  template <class Enumeration>
  void name(std::string_view key, Enumeration value, std::span<const std::string_view> names) {
    line(key, toml_string(names[static_cast<std::size_t>(value)]));
  }

  template <class Part>
  void table(std::string_view key, const Part& part, Presence /*presence*/) {
    text_ += "\n[" + std::string(key) + "]\n";
    visit_fields(*this, part);
  }
  template <class Part>
  void table(std::string_view key, const std::optional<Part>& part) {
    if (part) {
      table(key, *part, Presence::required);
    }
  }
  template <class Part>
  void tables(std::string_view key, const std::vector<Part>& parts) {
    for (const Part& part : parts) {
      text_ += "\n[[" + std::string(key) + "]]\n";
      visit_fields(*this, part);
    }
  }

  void line(std::string_view key, std::string_view value) {
    text_.append(key).append(" = ").append(value).append("\n");
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace

std::string format_model(const SensorModel& model) {
  validate(model);
  Writer writer;
  writer.line("schema", toml_string(kModelSchema));
  visit_fields(writer, model);
  return writer.text();
}

}  // namespace zerorate::model
