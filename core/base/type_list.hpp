/// @file
/// Types as a list, for code that is compiled once for each of them.
#pragma once

namespace zerorate::core {

/// A list of types.
template <class... Types>
struct TypeList {
  /// Calls `visit.template operator()<Type>()` for each type, in order.
  template <class Visit>
  static constexpr void for_each(Visit visit) {
    (visit.template operator()<Types>(), ...);
  }
};

}  // namespace zerorate::core
