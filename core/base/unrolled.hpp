/// @file
/// Loops over a handful of constant indices that leave no loop behind.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

namespace zerorate::core {

/// Calls body(i) for i = 0 .. N - 1, each i a constant expression (std::integral_constant). Give it
/// lambdas that are always inlined: what they index is then taken apart into registers, which the
/// compilers' own unrolling, coming later, does not achieve.
template <std::size_t N, class Body>
[[gnu::always_inline]] constexpr void unrolled(Body body) {
  [&]<std::size_t... i>(std::index_sequence<i...>) __attribute__((always_inline)) {
    (body(std::integral_constant<std::size_t, i>{}), ...);
  }
  (std::make_index_sequence<N>{});
}

}  // namespace zerorate::core
