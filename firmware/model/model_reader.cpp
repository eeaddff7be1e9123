#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <system_error>
#include <vector>

#include "firmware/model/model_fields.hpp"
#include "firmware/model/model_file.hpp"
#include "firmware/model/nearest_name.hpp"

namespace zerorate::model {
namespace {

bool is_decimal_of(std::string_view text, double value) {
  double read = std::numeric_limits<double>::quiet_NaN();
  const char* const end = std::to_address(text.end());
  const auto [stop, error] = std::from_chars(text.data(), end, read);
  return error == std::errc{} && stop == end && read == value;
}

std::string shortest_decimal(double value) {
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), std::to_address(digits.end()), value);
  return {digits.data(), end};
}

/// The text that is being read, for messages and for the digits of its numbers.
class Document {
 public:
  Document(std::string_view text, std::string_view origin) : origin_(origin) {
    std::istringstream in{std::string(text)};
    for (std::string line; std::getline(in, line);) {
      lines_.push_back(line);
    }
  }

  [[noreturn]] void fail(const toml::source_position& where, const std::string& message) const {
    std::ostringstream out;
    out << origin_ << ':' << where.line << ':' << where.column << ": " << message;
    throw ModelFileError(out.str());
  }

  /// The decimal that stands at `node`. toml++ keeps the double only; its shortest decimal
  /// stands in for notations that are not plain decimals (hexadecimal integers, digit separators).
  [[nodiscard]] std::string decimal(const toml::node& node, double value) const {
    const toml::source_position begin = node.source().begin;
    if (begin.line >= 1 && begin.line <= lines_.size()) {
      const std::string_view line = lines_[begin.line - 1];
      const std::string_view rest =
          line.substr(std::min<std::size_t>(begin.column - 1, line.size()));
      const std::string_view text = rest.substr(0, rest.find_first_not_of("+-.0123456789eE"));
      if (is_decimal_of(text, value)) {
        return std::string(text);
      }
    }
    return shortest_decimal(value);
  }

 private:
  std::string origin_;
  std::vector<std::string> lines_;
};

/// A visitor of model_fields.hpp that reads one table.
class TableReader {
 public:
  /// `path` is the table's name, empty for the file's top level.
  TableReader(const Document& document, const toml::table& table, std::string_view path)
      : document_(document), table_(table), path_(path) {}

  void number(std::string_view key, double& si, FileUnit unit, const Rule& rule,
              Presence presence) {
    const toml::node* node = find(key, rule.words, presence);
    if (node != nullptr) {
      si = si_from_decimal(document_.decimal(*node, checked_number(*node, key, rule)), unit);
    }
  }
  void number(std::string_view key, int& value, FileUnit /*unit*/, const Rule& rule,
              Presence presence) {
    const toml::node* node = find(key, rule.words, presence);
    if (node != nullptr) {
      if (!node->is_integer()) {
        expected(*node, key, rule.words);
      }
      value = static_cast<int>(checked_number(*node, key, rule));
    }
  }
  void text(std::string_view key, std::string& value, Presence presence) {
    const toml::node* node = find(key, "text in quotes", presence);
    if (node != nullptr) {
      value = string(*node, key);
    }
  }
  void start(std::string_view key, core::Start& value) {
    const toml::node* node = find(key, "", Presence::optional);
    if (node == nullptr) {
      return;
    }
    const std::string name = string(*node, key);
    for (const core::Start start : {core::Start::stationary, core::Start::zero}) {
      if (name == start_name(start)) {
        value = start;
        return;
      }
    }
    expected(*node, key, R"("stationary" or "zero")");
  }

  template <class Part>
  void table(std::string_view key, Part& part, Presence presence) {
    const toml::node* node = find(key, "a table", presence);
    if (node == nullptr) {
      return;
    }
    if (!node->is_table()) {
      expected(*node, key, "a table, [" + std::string(key) + "]");
    }
    read(*node->as_table(), key, part);
  }
  template <class Part>
  void table(std::string_view key, std::optional<Part>& part) {
    if (find(key, "", Presence::optional) != nullptr) {
      table(key, part.emplace(), Presence::required);
    }
  }
  /// [[key]] as often as there are parts; [key] where there is one.
  template <class Part>
  void tables(std::string_view key, std::vector<Part>& parts) {
    const toml::node* node = find(key, "", Presence::optional);
    if (node == nullptr) {
      return;
    }
    if (node->is_table()) {
      read(*node->as_table(), key, parts.emplace_back());
      return;
    }
    if (!node->is_array_of_tables()) {
      expected(*node, key, "tables, [[" + std::string(key) + "]]");
    }
    for (const toml::node& element : *node->as_array()) {
      read(*element.as_table(), key, parts.emplace_back());
    }
  }

  /// Fails at the first name that nothing has asked for.
  void reject_unknown() const {
    for (const auto& [key, node] : table_) {
      if (std::ranges::find(known_, key.str()) == known_.end()) {
        document_.fail(key.source().begin,
                       "unknown " + std::string(node.is_table() ? "table" : "key") + " \"" +
                           std::string(key.str()) + "\"" + place() + suggestion(key.str(), known_));
      }
    }
  }

 private:
  template <class Part>
  void read(const toml::table& table, std::string_view key, Part& part) const {
    TableReader inside(document_, table, key);
    visit_fields(inside, part);
    inside.reject_unknown();
  }

  const toml::node* find(std::string_view key, std::string_view words, Presence presence) {
    if (std::ranges::find(known_, key) == known_.end()) {
      known_.push_back(key);
    }
    const toml::node* node = table_.get(key);
    if (node == nullptr && presence == Presence::required) {
      reject_unknown_like(key);
      document_.fail(table_.source().begin, "missing \"" + std::string(key) + "\"" + place() +
                                                "; expected " + std::string(words));
    }
    return node;
  }

  /// A misspelt required key is reported where it stands, not as missing.
  void reject_unknown_like(std::string_view key) const {
    for (const auto& [name, node] : table_) {
      const std::string hint = suggestion(name.str(), std::array{key});
      if (!hint.empty() && std::ranges::find(known_, name.str()) == known_.end()) {
        document_.fail(name.source().begin,
                       "unknown key \"" + std::string(name.str()) + "\"" + place() + hint);
      }
    }
  }

  [[nodiscard]] double checked_number(const toml::node& node, std::string_view key,
                                      const Rule& rule) const {
    const std::optional<double> value = node.value<double>();
    if (!node.is_number() || !value || !rule.holds(*value)) {
      expected(node, key, rule.words);
    }
    return *value;
  }

  [[nodiscard]] std::string string(const toml::node& node, std::string_view key) const {
    if (!node.is_string()) {
      expected(node, key, "text in quotes");
    }
    return node.as_string()->get();
  }

  [[noreturn]] void expected(const toml::node& node, std::string_view key,
                             std::string_view words) const {
    document_.fail(node.source().begin,
                   "\"" + std::string(key) + "\"" + place() + ": expected " + std::string(words));
  }

  [[nodiscard]] std::string place() const { return path_.empty() ? "" : " in [" + path_ + "]"; }

  const Document& document_;
  const toml::table& table_;
  std::string path_;
  std::vector<std::string_view> known_;
};

}  // namespace

SensorModel parse_model(std::string_view toml, std::string_view origin) {
  const Document document(toml, origin);
  toml::table table;
  try {
    table = toml::parse(toml, origin);
  } catch (const toml::parse_error& error) {
    document.fail(error.source().begin, std::string(error.description()));
  }
  TableReader reader(document, table, "");
  std::string schema;
  reader.text("schema", schema, Presence::required);
  if (schema != kModelSchema) {
    document.fail(table.get("schema")->source().begin,
                  "\"schema\": expected \"" + std::string(kModelSchema) + "\"");
  }
  SensorModel model;
  visit_fields(reader, model);
  reader.reject_unknown();
  return model;
}

SensorModel read_model(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(in), {});
  if (!in) {
    throw std::system_error(errno, std::generic_category(), file.string());
  }
  return parse_model(text, file.string());
}

}  // namespace zerorate::model
