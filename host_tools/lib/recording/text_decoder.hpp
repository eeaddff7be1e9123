/// @file
/// Text of other encodings and line ends, made UTF-8 with LF.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace zerorate::recording {

/// Decodes a text in parts, each in place: its result is never longer.
/// UTF-16 with a byte order mark becomes UTF-8; characters beyond ASCII become '?', as no number,
/// unit or name of zerorate has any. In a text without LF in its first part, CR ends lines.
class TextDecoder {
 public:
  /// @param first_part  at least three bytes, but for shorter texts
  explicit TextDecoder(std::span<const char> first_part);

  /// @return  bytes that are left at the front of `part`
  [[nodiscard]] std::size_t decode(std::span<char> part);

 private:
  enum class Encoding : std::uint8_t { utf8, utf16_little, utf16_big };

  [[nodiscard]] std::size_t narrow(std::span<char> part);

  Encoding encoding_ = Encoding::utf8;
  std::size_t mark_ = 0;  ///< bytes of the byte order mark that are still to be skipped
  bool ends_lines_by_cr_ = false;
  bool has_half_ = false;  ///< a part ended within two bytes of UTF-16
  char half_ = '\0';
};

}  // namespace zerorate::recording
