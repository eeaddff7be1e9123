/// @file
/// Lists of types, arrays of equal values, and loops that the compiler writes out.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace zerorate::core {

/// A list of types.
template <class... Types>
struct TypeList {
  static constexpr std::size_t kSize = sizeof...(Types);

  /// Calls `visit.template operator()<Type>()` for each type, in order.
  template <class Visit>
  static constexpr void for_each(Visit visit) {
    (visit.template operator()<Types>(), ...);
  }
};

/// Lists one after the other, as one.
template <class First, class... Others>
struct Join {
  using Type = First;
};
template <class... First, class... Second, class... Others>
struct Join<TypeList<First...>, TypeList<Second...>, Others...>
    : Join<TypeList<First..., Second...>, Others...> {};
template <class... Lists>
using Joined = typename Join<Lists...>::Type;

/// Array of N copies of a value, whose type needs no default constructor.
template <std::size_t N, class Value>
[[nodiscard]] constexpr std::array<Value, N> filled_array(const Value& value) {
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<Value, N>{(static_cast<void>(I), value)...};
  }
  (std::make_index_sequence<N>{});
}

}  // namespace zerorate::core

/// ZERORATE_UNROLLED for (...): asks the compiler to unroll the loop completely, which nested loops
/// over a triangle need before their indices become constants. Clang does so of its own accord;
/// where floating point is software it is half the code again for a twentieth of the time.
#if defined(__GNUC__) && !defined(__clang__) && !defined(__ARM_ARCH_6M__)
#define ZERORATE_UNROLLED _Pragma("GCC unroll 16")
#else
#define ZERORATE_UNROLLED
#endif
