#include "hal/linux/iio_element.hpp"

#include <charconv>

#include "hal/linux/sysfs.hpp"

namespace zerorate::hal::linux_os {
namespace {

unsigned number_at(std::string_view& text) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return 0;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

bool take(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

}  // namespace

IioElement parse_iio_type(std::string_view type, const std::string& path) {
  std::string_view rest = type;
  IioElement element;
  element.is_big_endian = rest.starts_with("be:");
  bool is_right = take(rest, "be:") || take(rest, "le:");
  element.is_signed = rest.starts_with('s');
  is_right = is_right && (take(rest, "s") || take(rest, "u"));
  element.bits = number_at(rest);
  is_right = is_right && take(rest, "/");
  const unsigned storage = number_at(rest);
  element.bytes = storage / 8;
  if (take(rest, ">>")) element.shift = number_at(rest);
  const bool is_storage = storage == 8 || storage == 16 || storage == 32 || storage == 64;
  if (!is_right || !rest.empty() || !is_storage || element.bits == 0 ||
      element.bits + element.shift > storage) {
    throw KernelFileError(path, "\"" + std::string{type} + "\" is no layout that is understood",
                          "expected is one as \"le:s16/16>>0\"");
  }
  return element;
}

std::int64_t IioElement::decode(std::span<const std::uint8_t> scan) const {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < bytes; ++i) {
    const unsigned significance = is_big_endian ? bytes - 1 - i : i;
    value |= std::uint64_t{scan[offset + i]} << (8 * significance);
  }
  const unsigned unused = 64 - bits;
  value = (value >> shift) << unused;
  if (is_signed) return static_cast<std::int64_t>(value) >> unused;
  return static_cast<std::int64_t>(value >> unused);
}

}  // namespace zerorate::hal::linux_os
