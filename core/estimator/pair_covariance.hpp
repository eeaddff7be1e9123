/// @file
/// The covariance of states that come in pairs, in blocks of two by two.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/lanes.hpp"

namespace zerorate::core {

/// A matrix of two by two, row by row in four lanes; + - * of it are element by element.
using Block = Lanes;

/// Both rows are (x[0], x[1]).
[[gnu::always_inline]] inline Block rows(const float* x) {
  return load_pair_twice(x);
}
[[gnu::always_inline]] inline Block all(float x) {
  return Block{x, x, x, x};
}
/// Two numbers on the diagonal. -0 adds nothing to whatever there is, and compilers know it.
[[gnu::always_inline]] inline Block diagonal(float first, float second) {
  return Block{first, -0.0F, -0.0F, second};
}
[[gnu::always_inline]] inline Block transposed(Block x) {
  return picked<0, 2, 1, 3>(x);
}
[[gnu::always_inline]] inline Block rows_exchanged(Block x) {
  return picked<2, 3, 0, 1>(x);
}
/// By its upper element.
[[gnu::always_inline]] inline Block symmetric(Block x) {
  return picked<0, 1, 1, 3>(x);
}
[[gnu::always_inline]] inline float sum_of_row(Block x) {
  return x[0] + x[1];
}
[[gnu::always_inline]] inline void store_row(Block x, float* to) {
  store_pair(x, to);
}

/// The covariance of 2 M states: the blocks on and below the diagonal, row by row of blocks.
template <std::size_t M>
class PairCovariance {
 public:
  /// One element; i and j in any order.
  [[nodiscard]] constexpr float operator()(std::size_t i, std::size_t j) const {
    return i / 2 >= j / 2 ? packed_[position(i, j)] : packed_[position(j, i)];
  }
  constexpr void set(std::size_t i, std::size_t j, float value) {
    if (i / 2 >= j / 2) packed_[position(i, j)] = value;
    if (j / 2 >= i / 2) packed_[position(j, i)] = value;
  }

  /// The states of pair i with those of pair j; i and j in any order.
  [[gnu::always_inline]] [[nodiscard]] Block block(std::size_t i, std::size_t j) const {
    return i >= j ? load_lanes(&packed_[first(i, j)])
                  : transposed(load_lanes(&packed_[first(j, i)]));
  }
  /// For i >= j.
  [[gnu::always_inline]] void set_block(std::size_t i, std::size_t j, Block block) {
    store_lanes(block, &packed_[first(i, j)]);
  }

  constexpr bool operator==(const PairCovariance&) const = default;

 private:
  static constexpr std::size_t first(std::size_t pair, std::size_t other) {
    return 4 * (pair * (pair + 1) / 2 + other);
  }
  static constexpr std::size_t position(std::size_t i, std::size_t j) {
    return first(i / 2, j / 2) + 2 * (i % 2) + j % 2;
  }
  // Aligned, so that no block lies across two cache lines.
  alignas(16) std::array<float, 2 * M*(M + 1)> packed_{};
};

}  // namespace zerorate::core
