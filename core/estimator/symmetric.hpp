/// @file
/// A symmetric matrix that stores each pair once, so that it cannot lose its symmetry.
#pragma once

#include <array>
#include <cstddef>

namespace zerorate::core {

/// n x n, the lower triangle row by row.
template <std::size_t N>
class Symmetric {
 public:
  constexpr float& operator()(std::size_t i, std::size_t j) { return packed_[index(i, j)]; }
  constexpr float operator()(std::size_t i, std::size_t j) const { return packed_[index(i, j)]; }

 private:
  static constexpr std::size_t index(std::size_t i, std::size_t j) {
    return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
  }
  std::array<float, N*(N + 1) / 2> packed_{};
};

}  // namespace zerorate::core
