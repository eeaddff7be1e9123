/// @file
/// TOML files that a person wrote, read so that no mistake passes: an unknown name, a wrong type, a
/// missing key or an impossible value is an error with file, line, column and what was expected.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/toml/error.hpp"
#include "firmware/toml/toml.hpp"

namespace zerorate::toml_file {

enum class Presence : std::uint8_t { required, optional };

/// Rule for a number, in code and in words ("a positive number").
struct Rule {
  bool (*holds)(double);
  std::string_view words;
};

/// A file's text, for messages and for the digits of its numbers.
class Document {
 public:
  /// The parser goes one call deeper with each dot of a name: this keeps it on its stack.
  static constexpr std::size_t kLongestText = 32'768;

  /// @param origin  the file's name in messages
  /// Throws Error where the text is longer than kLongestText.
  Document(std::string_view text, std::string_view origin);

  /// Throws Error where the text is not TOML.
  [[nodiscard]] toml::table parse() const;
  [[noreturn]] void fail(const toml::source_position& where, const std::string& message) const;
  /// The decimal that stands at `node`. toml++ keeps the double only; its shortest decimal
  /// stands in for notations that are not plain decimals (hexadecimal integers, digit separators).
  [[nodiscard]] std::string decimal(const toml::node& node, double value) const;

 private:
  /// The first line up to which the text breaks an assumption of the parser.
  [[nodiscard]] toml::source_index line_that_is_not_toml() const;

  std::string text_;
  std::string origin_;
  std::vector<std::string> lines_;
};

/// One table of a document, which remembers what was asked of it.
class StrictTable {
 public:
  /// `path` is the table's name, empty for the file's top level.
  StrictTable(const Document& document, const toml::table& table, std::string_view path)
      : document_(&document), table_(&table), path_(path) {}

  /// The value of a key as it stands there; nullptr where it is absent and need not be there.
  [[nodiscard]] const toml::node* find(std::string_view key, std::string_view words,
                                       Presence presence);
  [[nodiscard]] std::optional<double> number(std::string_view key, const Rule& rule,
                                             Presence presence);
  [[nodiscard]] std::optional<std::int64_t> integer(std::string_view key, const Rule& rule,
                                                    Presence presence);
  /// The numbers of an array of so many, each by the rule; none where the key is absent.
  [[nodiscard]] std::vector<const toml::node*> numbers(std::string_view key, std::size_t count,
                                                       const Rule& rule);
  [[nodiscard]] std::optional<std::string> text(std::string_view key, Presence presence);
  [[nodiscard]] std::optional<bool> boolean(std::string_view key, Presence presence);
  /// Index of the name that stands at the key.
  [[nodiscard]] std::optional<std::size_t> choice(std::string_view key,
                                                  std::span<const std::string_view> names,
                                                  Presence presence);
  [[nodiscard]] std::optional<StrictTable> table(std::string_view key, Presence presence);
  /// [[key]] as often as it stands there; [key] where there is one.
  [[nodiscard]] std::vector<StrictTable> tables(std::string_view key);

  /// Fails at the names that nothing has asked for, with the nearest that something has; one a
  /// line.
  void reject_unknown() const;
  /// Fails at the value of a key, or at the table where it is absent.
  [[noreturn]] void fail_at(std::string_view key, const std::string& message) const;

  /// The node's value as a number that satisfies the rule; fails where it is none.
  [[nodiscard]] double checked_number(const toml::node& node, std::string_view key,
                                      const Rule& rule) const;
  [[nodiscard]] const Document& document() const { return *document_; }

 private:
  void reject_unknown_like(std::string_view key) const;
  [[noreturn]] void expected(const toml::node& node, std::string_view key,
                             std::string_view words) const;
  [[nodiscard]] std::string place() const;

  const Document* document_;
  const toml::table* table_;
  std::string path_;
  std::vector<std::string_view> known_;
};

/// Reads the text of a file, of one that is longer than Document takes only so much that Document
/// refuses it. Throws std::system_error where the file cannot be read.
[[nodiscard]] std::string read_text(const std::string& file);

}  // namespace zerorate::toml_file
