#include "host_tools/lib/recording/text_decoder.hpp"

#include <algorithm>
#include <string_view>

namespace zerorate::recording {

TextDecoder::TextDecoder(std::span<const char> first_part) {
  const std::string_view text{first_part.data(), first_part.size()};
  if (text.starts_with("\xFF\xFE")) {
    encoding_ = Encoding::utf16_little;
    mark_ = 2;
  } else if (text.starts_with("\xFE\xFF")) {
    encoding_ = Encoding::utf16_big;
    mark_ = 2;
  } else if (text.starts_with("\xEF\xBB\xBF")) {
    mark_ = 3;
  }
  ends_lines_by_cr_ =
      text.find('\n') == std::string_view::npos && text.find('\r') != std::string_view::npos;
}

std::size_t TextDecoder::decode(std::span<char> part) {
  std::copy(part.begin() + static_cast<std::ptrdiff_t>(mark_), part.end(), part.begin());
  part = part.first(part.size() - mark_);
  mark_ = 0;
  if (encoding_ != Encoding::utf8) part = part.first(narrow(part));
  if (ends_lines_by_cr_) std::ranges::replace(part, '\r', '\n');
  return part.size();
}

/// Keeps the low byte of each pair whose high byte is zero.
std::size_t TextDecoder::narrow(std::span<char> part) {
  std::size_t kept = 0;
  for (const char byte : part) {
    if (!has_half_) {
      half_ = byte;
      has_half_ = true;
      continue;
    }
    has_half_ = false;
    const bool is_little = encoding_ == Encoding::utf16_little;
    const char high = is_little ? byte : half_;
    const char low = is_little ? half_ : byte;
    part[kept++] = high == '\0' && static_cast<unsigned char>(low) < 0x80 ? low : '?';
  }
  return kept;
}

}  // namespace zerorate::recording
