/// @file
/// The fields of one line, separated by commas or by another character.
#pragma once

#include <cstddef>
#include <cstring>
#include <string_view>

namespace zerorate::recording {

/// Walks over the fields of a line, without spaces and tabs around them. A field in double quotes
/// may hold delimiters (RFC 4180); a doubled quote inside it stays doubled, and it ends in its
/// line. Where spaces separate, several of them count as one.
class Fields {
 public:
  explicit Fields(std::string_view line, char delimiter = ',')
      : line_(line.data()), end_(line.data() + line.size()), rest_(line_), delimiter_(delimiter) {
    while (delimiter == ' ' && end_ != line_ && is_blank(end_[-1])) --end_;
  }

  /// Moves to the next field; false after the last. A line always has at least one field.
  [[nodiscard]] bool next() {
    if (rest_ == nullptr) {
      return false;
    }
    while (rest_ != end_ && is_blank(*rest_)) {
      ++rest_;
    }
    const char* const stop = end_of_field();
    text_ = trimmed(rest_, stop);
    rest_ = stop == end_ ? nullptr : stop + 1;
    return true;
  }

  [[nodiscard]] std::string_view text() const { return text_; }
  /// First character of the field in its line, counted from 1.
  [[nodiscard]] std::size_t column() const {
    return static_cast<std::size_t>(text_.data() - line_) + 1;
  }

 private:
  [[nodiscard]] bool is_blank(char c) const {
    return c == ' ' || (c == '\t' && delimiter_ != '\t');
  }

  /// The delimiter after the field that begins at rest_, or the end of the line.
  [[nodiscard]] const char* end_of_field() const {
    const char* from = rest_;
    if (from != end_ && *from == '"') {
      // A doubled quote closes and opens again: delimiters between an even number of quotes
      // separate.
      bool quoted = false;
      for (; from != end_ && (quoted || *from != delimiter_); ++from) {
        quoted = quoted != (*from == '"');
      }
      return from;
    }
    const void* const found = std::memchr(from, delimiter_, static_cast<std::size_t>(end_ - from));
    return found != nullptr ? static_cast<const char*>(found) : end_;
  }

  [[nodiscard]] std::string_view trimmed(const char* begin, const char* end) const {
    while (end != begin && is_blank(end[-1])) {
      --end;
    }
    if (end - begin >= 2 && *begin == '"' && end[-1] == '"') {
      ++begin;
      --end;
    }
    return {begin, static_cast<std::size_t>(end - begin)};
  }

  const char* line_;
  const char* end_;
  const char* rest_;  ///< where the next field begins; null after the last
  char delimiter_;
  std::string_view text_;
};

/// The first of comma, semicolon and tab that the line has; a comma where it has none.
[[nodiscard]] inline char delimiter_in(std::string_view line) {
  for (const char candidate : {',', ';', '\t'}) {
    if (line.find(candidate) != std::string_view::npos) return candidate;
  }
  return ',';
}

}  // namespace zerorate::recording
