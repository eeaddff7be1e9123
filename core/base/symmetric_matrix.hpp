/// @file
/// A symmetric matrix, stored once.
#pragma once

#include <array>
#include <cstddef>

namespace zerorate::core {

/// N by N numbers, of which those on and below the diagonal are stored, row by row.
template <std::size_t N>
class SymmetricMatrix {
 public:
  /// One element; i and j in any order.
  [[nodiscard]] constexpr float operator()(std::size_t i, std::size_t j) const {
    return packed_[position(i, j)];
  }
  constexpr float& operator()(std::size_t i, std::size_t j) { return packed_[position(i, j)]; }

  constexpr bool operator==(const SymmetricMatrix&) const = default;

 private:
  static constexpr std::size_t position(std::size_t i, std::size_t j) {
    return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
  }
  std::array<float, N*(N + 1) / 2> packed_{};
};

}  // namespace zerorate::core
