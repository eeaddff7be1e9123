/// @file
/// A short delay line: measurements wait until it is certain that no motion followed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/assert.hpp"
#include "core/base/time.hpp"

namespace zerorate::core {

/// First in, first out, at most `Capacity` items in fixed memory.
/// @tparam Item has a member `Instant end`, the time of its newest sample; items arrive in order
template <class Item, std::size_t Capacity>
class HoldBackLine {
 public:
  [[nodiscard]] constexpr std::size_t size() const { return used_; }
  [[nodiscard]] constexpr bool is_full() const { return used_ == Capacity; }

  constexpr void push(const Item& item) {
    ZERORATE_ASSERT(!is_full());
    items_[(oldest_ + used_) % Capacity] = item;
    ++used_;
  }

  /// Forgets what turned out to belong to a drive: every item that ends after `since`.
  /// @return how many
  constexpr std::size_t discard_after(Instant since) {
    std::size_t discarded = 0;
    while (used_ > 0 && item(used_ - 1U).end > since) {
      --used_;
      ++discarded;
    }
    return discarded;
  }

  /// Forgets the newest items as long as `is_doubted` says so.
  template <class IsDoubted>
  constexpr void discard_newest_while(IsDoubted is_doubted) {
    while (used_ > 0 && is_doubted(item(used_ - 1U))) --used_;
  }

  constexpr void clear() { used_ = 0; }

  /// Calls take(item), oldest first, for every item that ends no later than `until`.
  template <class Take>
  constexpr void release_until(Instant until, Take take) {
    while (used_ > 0 && item(0).end <= until) {
      take(item(0));
      oldest_ = static_cast<std::uint16_t>((oldest_ + 1U) % Capacity);
      --used_;
    }
  }

  /// Whether memory from outside may be such a line with room for another item: its places are
  /// there, and may_be(item, item before or nullptr) is true of each item.
  template <class MayBe>
  [[nodiscard]] constexpr bool is_possible(MayBe may_be) const {
    if (used_ >= Capacity || oldest_ >= Capacity) return false;
    for (std::size_t i = 0; i < used_; ++i) {
      if (!may_be(item(i), i > 0 ? &item(i - 1U) : nullptr)) return false;
    }
    return true;
  }

  /// Whether both hold the same items, wherever in their rings.
  constexpr bool operator==(const HoldBackLine& other) const {
    if (used_ != other.used_) return false;
    for (std::size_t i = 0; i < used_; ++i) {
      if (!(item(i) == other.item(i))) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] constexpr const Item& item(std::size_t i) const {
    return items_[(oldest_ + i) % Capacity];
  }

  std::array<Item, Capacity> items_{};
  std::uint16_t oldest_ = 0;
  std::uint16_t used_ = 0;
};

}  // namespace zerorate::core
