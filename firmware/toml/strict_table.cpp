#include "firmware/toml/strict_table.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <limits>
#include <memory>
#include <sstream>
#include <system_error>

#include "firmware/toml/error.hpp"

namespace zerorate::toml_file {
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

std::string in_words(std::span<const std::string_view> names) {
  std::string words;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) words += i + 1 == names.size() ? " or " : ", ";
    words += '"' + std::string(names[i]) + '"';
  }
  return words;
}

}  // namespace

Document::Document(std::string_view text, std::string_view origin) : text_(text), origin_(origin) {
  if (text.size() > kLongestText) {
    fail({.line = 1, .column = 1},
         "more than " + std::to_string(kLongestText) + " bytes; expected a short TOML file");
  }
  std::istringstream in{text_};
  for (std::string line; std::getline(in, line);) lines_.push_back(line);
}

toml::table Document::parse() const {
  try {
    return toml::parse(text_, origin_);
  } catch (const toml::parse_error& error) {
    fail(error.source().begin, std::string(error.description()));
  } catch (const BrokenAssumption&) {
    fail({.line = line_that_is_not_toml(), .column = 1}, "this is not TOML");
  }
}

toml::source_index Document::line_that_is_not_toml() const {
  std::string lines;
  toml::source_index count = 0;
  for (const std::string& line : lines_) {
    lines += line + '\n';
    ++count;
    try {
      (void)toml::parse(lines, origin_);
    } catch (const toml::parse_error&) {
      continue;  // only not finished yet
    } catch (const BrokenAssumption&) {
      break;
    }
  }
  return count;
}

void Document::fail(const toml::source_position& where, const std::string& message) const {
  std::ostringstream out;
  out << origin_ << ':' << where.line << ':' << where.column << ": " << message;
  throw Error(out.str());
}

std::string Document::decimal(const toml::node& node, double value) const {
  const toml::source_position begin = node.source().begin;
  if (begin.line >= 1 && begin.line <= lines_.size()) {
    const std::string_view line = lines_[begin.line - 1];
    const std::string_view rest = line.substr(std::min<std::size_t>(begin.column - 1, line.size()));
    const std::string_view text = rest.substr(0, rest.find_first_not_of("+-.0123456789eE"));
    if (is_decimal_of(text, value)) return std::string(text);
  }
  return shortest_decimal(value);
}

const toml::node* StrictTable::find(std::string_view key, std::string_view words,
                                    Presence presence) {
  if (std::ranges::find(known_, key) == known_.end()) known_.push_back(key);
  const toml::node* node = table_->get(key);
  if (node == nullptr && presence == Presence::required) {
    reject_unknown_like(key);
    document_->fail(table_->source().begin, "missing \"" + std::string(key) + "\"" + place() +
                                                "; expected " + std::string(words));
  }
  return node;
}

std::optional<double> StrictTable::number(std::string_view key, const Rule& rule,
                                          Presence presence) {
  const toml::node* const node = find(key, rule.words, presence);
  if (node == nullptr) return std::nullopt;
  return checked_number(*node, key, rule);
}

std::optional<std::int64_t> StrictTable::integer(std::string_view key, const Rule& rule,
                                                 Presence presence) {
  const toml::node* const node = find(key, rule.words, presence);
  if (node == nullptr) return std::nullopt;
  if (!node->is_integer()) expected(*node, key, rule.words);
  (void)checked_number(*node, key, rule);
  return node->as_integer()->get();
}

std::vector<const toml::node*> StrictTable::numbers(std::string_view key, std::size_t count,
                                                    const Rule& rule) {
  std::vector<const toml::node*> numbers;
  const toml::node* const node = find(key, rule.words, Presence::optional);
  if (node == nullptr) return numbers;
  const toml::array* const array = node->as_array();
  if (array == nullptr || array->size() != count) {
    expected(*node, key, rule.words);
  }
  for (const toml::node& element : *array) {
    (void)checked_number(element, key, rule);
    numbers.push_back(&element);
  }
  return numbers;
}

std::optional<std::string> StrictTable::text(std::string_view key, Presence presence) {
  const toml::node* const node = find(key, "text in quotes", presence);
  if (node == nullptr) return std::nullopt;
  if (!node->is_string()) expected(*node, key, "text in quotes");
  return node->as_string()->get();
}

std::optional<bool> StrictTable::boolean(std::string_view key, Presence presence) {
  const toml::node* const node = find(key, "true or false", presence);
  if (node == nullptr) return std::nullopt;
  if (!node->is_boolean()) expected(*node, key, "true or false");
  return node->as_boolean()->get();
}

std::optional<std::size_t> StrictTable::choice(std::string_view key,
                                               std::span<const std::string_view> names,
                                               Presence presence) {
  const toml::node* const node = find(key, in_words(names), presence);
  if (node == nullptr) return std::nullopt;
  if (node->is_string()) {
    const auto found = std::ranges::find(names, std::string_view{node->as_string()->get()});
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  }
  expected(*node, key, in_words(names));
}

std::optional<StrictTable> StrictTable::table(std::string_view key, Presence presence) {
  const toml::node* const node = find(key, "a table", presence);
  if (node == nullptr) return std::nullopt;
  if (!node->is_table()) expected(*node, key, "a table, [" + std::string(key) + "]");
  return StrictTable(*document_, *node->as_table(), key);
}

std::vector<StrictTable> StrictTable::tables(std::string_view key) {
  const toml::node* const node = find(key, "tables", Presence::optional);
  std::vector<StrictTable> tables;
  if (node == nullptr) return tables;
  if (node->is_table()) {
    tables.emplace_back(*document_, *node->as_table(), key);
    return tables;
  }
  if (!node->is_array_of_tables()) expected(*node, key, "tables, [[" + std::string(key) + "]]");
  for (const toml::node& element : *node->as_array()) {
    tables.emplace_back(*document_, *element.as_table(), key);
  }
  return tables;
}

void StrictTable::reject_unknown() const {
  ErrorList errors;
  for (const auto& [key, node] : *table_) {
    if (std::ranges::find(known_, key.str()) != known_.end()) continue;
    const std::string words = "unknown " + std::string(node.is_table() ? "table" : "key") + " \"" +
                              std::string(key.str()) + "\"" + place() +
                              suggestion(key.str(), known_);
    const toml::source_position where = key.source().begin;
    errors.attempt([&] { document_->fail(where, words); });
  }
  errors.raise();
}

void StrictTable::fail_at(std::string_view key, const std::string& message) const {
  const toml::node* const node = table_->get(key);
  document_->fail(node == nullptr ? table_->source().begin : node->source().begin,
                  "\"" + std::string(key) + "\"" + place() + ": " + message);
}

double StrictTable::checked_number(const toml::node& node, std::string_view key,
                                   const Rule& rule) const {
  const std::optional<double> value = node.value<double>();
  if (!node.is_number() || !value || !rule.holds(*value)) expected(node, key, rule.words);
  return *value;
}

/// A misspelt required key is reported where it stands, not as missing.
void StrictTable::reject_unknown_like(std::string_view key) const {
  for (const auto& [name, node] : *table_) {
    const std::string hint = suggestion(name.str(), std::array{key});
    if (!hint.empty() && std::ranges::find(known_, name.str()) == known_.end()) {
      document_->fail(name.source().begin,
                      "unknown key \"" + std::string(name.str()) + "\"" + place() + hint);
    }
  }
}

void StrictTable::expected(const toml::node& node, std::string_view key,
                           std::string_view words) const {
  document_->fail(node.source().begin,
                  "\"" + std::string(key) + "\"" + place() + ": expected " + std::string(words));
}

std::string StrictTable::place() const {
  return path_.empty() ? "" : " in [" + path_ + "]";
}

std::string read_text(const std::string& file) {
  constexpr int kLongest_ms = 1000;
  const auto fail = [&](int error) {
    throw std::system_error(error, std::generic_category(), file);
  };
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) fail(errno);
  std::string text;
  int error = 0;
  for (;;) {
    // A pipe to which nobody writes must not hold up a program that runs.
    pollfd ready{.fd = descriptor, .events = POLLIN, .revents = 0};
    std::array<char, 4096> piece{};
    const bool is_ready = poll(&ready, 1, kLongest_ms) == 1;
    const ssize_t size = is_ready ? ::read(descriptor, piece.data(), piece.size()) : -1;
    if (size < 0) error = is_ready ? errno : ETIMEDOUT;
    if (size <= 0 || text.size() > Document::kLongestText) break;
    text.append(piece.data(), static_cast<std::size_t>(size));
  }
  (void)::close(descriptor);
  if (error != 0) fail(error);
  text.resize(std::min(text.size(), Document::kLongestText + 1));
  return text;
}

}  // namespace zerorate::toml_file
