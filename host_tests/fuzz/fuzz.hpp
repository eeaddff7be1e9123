/// @file
/// Common ground of the fuzzers: the input, and how a broken promise ends the run.
#pragma once

#include <fuzzer/FuzzedDataProvider.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string_view>

/// Called by libFuzzer with each input.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace zerorate::fuzz {

/// Ends the run, which libFuzzer reports together with the input, unless it holds.
inline void promise(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

/// A whole input as text.
[[nodiscard]] inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  const std::span<const char> text{reinterpret_cast<const char*>(data), size};  // NOLINT
  return {text.data(), text.size()};
}

}  // namespace zerorate::fuzz
