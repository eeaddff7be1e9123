// The three functions that the compiler calls for copies and fills even in freestanding code
// (GCC manual, section 2.1). Word by word where the addresses are those of words, as of most
// structures; the flash has no room for more.

#include <cstddef>
#include <cstdint>

// Pointers and sizes are what their interface is made of.
// NOLINTBEGIN(cppcoreguidelines-pro-bounds-pointer-arithmetic)
namespace {

using Word [[gnu::may_alias]] = std::uint32_t;

/// Words of a block; none unless its address, or the bits of two of them, are those of a word.
std::size_t words_of(std::uintptr_t addresses, std::size_t size) {
  return addresses % sizeof(Word) == 0 ? size / sizeof(Word) : 0;
}

}  // namespace

extern "C" {

void* memset(void* target, int value, std::size_t size) {
  const auto byte = static_cast<unsigned char>(value);
  auto* bytes = static_cast<unsigned char*>(target);
  auto* words = static_cast<Word*>(target);
  const std::size_t count = words_of(reinterpret_cast<std::uintptr_t>(target), size);
  for (std::size_t i = 0; i < count; ++i) words[i] = byte * 0x01010101U;
  for (std::size_t i = count * sizeof(Word); i < size; ++i) bytes[i] = byte;
  return target;
}

void* memcpy(void* __restrict target, const void* __restrict source, std::size_t size) {
  auto* to = static_cast<unsigned char*>(target);
  const auto* from = static_cast<const unsigned char*>(source);
  auto* to_words = static_cast<Word*>(target);
  const auto* from_words = static_cast<const Word*>(source);
  const std::size_t count = words_of(
      reinterpret_cast<std::uintptr_t>(target) | reinterpret_cast<std::uintptr_t>(source), size);
  for (std::size_t i = 0; i < count; ++i) to_words[i] = from_words[i];
  for (std::size_t i = count * sizeof(Word); i < size; ++i) to[i] = from[i];
  return target;
}

void* memmove(void* target, const void* source, std::size_t size) {
  auto* to = static_cast<unsigned char*>(target);
  const auto* from = static_cast<const unsigned char*>(source);
  // Unrelated pointers have no order of their own, their addresses have.
  if (reinterpret_cast<std::uintptr_t>(to) < reinterpret_cast<std::uintptr_t>(from)) {
    for (std::size_t i = 0; i < size; ++i) to[i] = from[i];
  } else {
    for (std::size_t i = size; i > 0; --i) to[i - 1] = from[i - 1];
  }
  return target;
}

}  // extern "C"
// NOLINTEND(cppcoreguidelines-pro-bounds-pointer-arithmetic)
