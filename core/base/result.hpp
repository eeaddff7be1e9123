/// @file
/// A value or the reason why there is none, for code that may not throw.
///
/// The member names are those of std::expected (C++23), which g++ 12 does not have in C++20.
#pragma once

#include <type_traits>
#include <utility>

#include "core/base/assert.hpp"

namespace zerorate::core {

/// Marks a value as an error on its way into a Result: `return Unexpected{BusError::timeout};`
template <class E>
class Unexpected {
 public:
  constexpr explicit Unexpected(E error) : error_(error) {}
  [[nodiscard]] constexpr const E& error() const { return error_; }

 private:
  E error_;
};

/// Either a T or an E. Reading the side that is not there is a programmer error (ZERORATE_ASSERT).
/// Both must be trivially destructible: a Result costs the larger of the two and one flag.
template <class T, class E>
class [[nodiscard]] Result {
  static_assert(std::is_trivially_destructible_v<T> && std::is_trivially_destructible_v<E>);

 public:
  using value_type = T;
  using error_type = E;

  // Implicit on purpose, as in std::expected: `return value;` and `return Unexpected{error};`.
  // NOLINTNEXTLINE(google-explicit-constructor)
  constexpr Result(T value) : value_(std::move(value)), has_value_(true) {}
  // NOLINTNEXTLINE(google-explicit-constructor)
  constexpr Result(Unexpected<E> unexpected) : error_(unexpected.error()), has_value_(false) {}

  [[nodiscard]] constexpr bool has_value() const { return has_value_; }
  constexpr explicit operator bool() const { return has_value_; }

  [[nodiscard]] constexpr const T& value() const {
    ZERORATE_ASSERT(has_value_);
    return value_;
  }
  [[nodiscard]] constexpr T& value() {
    ZERORATE_ASSERT(has_value_);
    return value_;
  }
  [[nodiscard]] constexpr const E& error() const {
    ZERORATE_ASSERT(!has_value_);
    return error_;
  }
  constexpr const T& operator*() const { return value(); }
  constexpr T& operator*() { return value(); }
  constexpr const T* operator->() const { return &value(); }
  constexpr T* operator->() { return &value(); }

  [[nodiscard]] constexpr T value_or(T fallback) const { return has_value_ ? value_ : fallback; }

 private:
  union {
    T value_;
    E error_;
  };
  bool has_value_;
};

/// Success without a value, or an E.
template <class E>
class [[nodiscard]] Result<void, E> {
  static_assert(std::is_trivially_destructible_v<E>);

 public:
  using value_type = void;
  using error_type = E;

  constexpr Result() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): as above
  constexpr Result(Unexpected<E> unexpected) : error_(unexpected.error()), has_value_(false) {}

  [[nodiscard]] constexpr bool has_value() const { return has_value_; }
  constexpr explicit operator bool() const { return has_value_; }
  [[nodiscard]] constexpr const E& error() const {
    ZERORATE_ASSERT(!has_value_);
    return error_;
  }

 private:
  E error_{};
  bool has_value_ = true;
};

}  // namespace zerorate::core
