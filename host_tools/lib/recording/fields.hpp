/// @file
/// The comma-separated fields of one line.
#pragma once

#include <cstddef>
#include <cstring>
#include <string_view>

namespace zerorate::recording {

/// Walks over the fields of a line, without spaces and tabs around them. A field in double quotes
/// may hold commas (RFC 4180); a doubled quote inside it stays doubled, and it ends in its line.
class Fields {
 public:
  explicit Fields(std::string_view line)
      : line_(line.data()), end_(line.data() + line.size()), rest_(line_) {}

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
  static bool is_blank(char c) { return c == ' ' || c == '\t'; }

  /// The comma after the field that begins at rest_, or the end of the line.
  [[nodiscard]] const char* end_of_field() const {
    const char* from = rest_;
    if (from != end_ && *from == '"') {
      // A doubled quote closes and opens again: commas between an even number of quotes separate.
      bool quoted = false;
      for (; from != end_ && (quoted || *from != ','); ++from) {
        quoted = quoted != (*from == '"');
      }
      return from;
    }
    const void* const comma = std::memchr(from, ',', static_cast<std::size_t>(end_ - from));
    return comma != nullptr ? static_cast<const char*>(comma) : end_;
  }

  static std::string_view trimmed(const char* begin, const char* end) {
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
  std::string_view text_;
};

}  // namespace zerorate::recording
