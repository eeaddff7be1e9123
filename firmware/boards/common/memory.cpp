// The three functions that the compiler calls for copies and fills even in freestanding code
// (GCC manual, section 2.1). Byte by byte: what is copied here is small, and the flash is too.

#include <cstddef>
#include <cstdint>

// Pointers and sizes are what their interface is made of.
// NOLINTBEGIN(cppcoreguidelines-pro-bounds-pointer-arithmetic)
extern "C" {

void* memset(void* target, int value, std::size_t size) {
  auto* bytes = static_cast<unsigned char*>(target);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<unsigned char>(value);
  return target;
}

void* memcpy(void* __restrict target, const void* __restrict source, std::size_t size) {
  auto* to = static_cast<unsigned char*>(target);
  const auto* from = static_cast<const unsigned char*>(source);
  for (std::size_t i = 0; i < size; ++i) to[i] = from[i];
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
