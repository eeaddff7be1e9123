/// @file
/// A short delay line: measurements wait until it is certain that no motion followed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/assert.hpp"
#include "core/base/time.hpp"

namespace zerorate::core {

/// Places of a line beside the ticks of the hold-back: two ticks that wait to be learnt, the tick
/// being closed, and one to spare.
inline constexpr std::int64_t kPlacesOfWork = 4;
/// Places of a line that a hold-back of this length needs.
[[nodiscard]] constexpr std::int64_t places_needed(Duration hold_back, Duration tick) {
  return hold_back / tick + kPlacesOfWork;
}

/// First in, first out, at most `Capacity` items in fixed memory. The oldest items are confirmed:
/// nothing can discard them any more, and they wait to be taken. The others are held back.
/// @tparam Item has a member `Instant end`, the time of its newest sample; items arrive in order
template <class Item, std::size_t Capacity>
class HoldBackLine {
 public:
  [[nodiscard]] constexpr std::size_t size() const { return used_; }
  [[nodiscard]] constexpr std::size_t confirmed() const { return confirmed_; }
  [[nodiscard]] constexpr bool is_full() const { return used_ == Capacity; }

  constexpr void push(const Item& item) {
    ZERORATE_ASSERT(!is_full());
    place(used_) = item;
    ++used_;
  }

  /// Discards what turned out to belong to a drive: every held item that ends after `since`.
  /// @return number of discarded items
  constexpr std::size_t discard_after(Instant since) {
    std::size_t discarded = 0;
    while (used_ > confirmed_ && item(used_ - 1U).end > since) {
      --used_;
      ++discarded;
    }
    return discarded;
  }
  /// Discards the newest held items as long as is_doubted(item) is true.
  template <class IsDoubted>
  constexpr void discard_newest_while(IsDoubted is_doubted) {
    while (used_ > confirmed_ && is_doubted(item(used_ - 1U))) --used_;
  }
  /// Discards every held item.
  constexpr void discard_held() { used_ = confirmed_; }

  /// Confirms every held item that ends no later than `until`, oldest first, and calls mark(item)
  /// for it.
  template <class Mark>
  constexpr void confirm_until(Instant until, Mark mark) {
    while (confirmed_ < used_ && item(confirmed_).end <= until) {
      mark(place(confirmed_));
      ++confirmed_;
    }
  }
  /// Takes the oldest confirmed item out.
  [[nodiscard]] constexpr Item take_confirmed() {
    ZERORATE_ASSERT(confirmed_ > 0);
    const Item oldest = item(0);
    oldest_ = static_cast<std::uint16_t>((oldest_ + 1U) % Capacity);
    --used_;
    --confirmed_;
    return oldest;
  }

  /// True if memory from outside is such a line with room for another item: its places exist, and
  /// may_be(item, item before or nullptr) is true of each item.
  template <class MayBe>
  [[nodiscard]] constexpr bool is_possible(MayBe may_be) const {
    if (used_ >= Capacity || oldest_ >= Capacity || confirmed_ > used_) return false;
    for (std::size_t i = 0; i < used_; ++i) {
      if (!may_be(item(i), i > 0 ? &item(i - 1U) : nullptr)) return false;
    }
    return true;
  }

  /// True if both hold the same items, wherever in their rings.
  constexpr bool operator==(const HoldBackLine& other) const {
    if (used_ != other.used_ || confirmed_ != other.confirmed_) return false;
    for (std::size_t i = 0; i < used_; ++i) {
      if (!(item(i) == other.item(i))) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] constexpr const Item& item(std::size_t i) const {
    return items_[(oldest_ + i) % Capacity];
  }
  [[nodiscard]] constexpr Item& place(std::size_t i) { return items_[(oldest_ + i) % Capacity]; }

  std::array<Item, Capacity> items_{};
  std::uint16_t oldest_ = 0;
  std::uint16_t used_ = 0;
  std::uint16_t confirmed_ = 0;
};

}  // namespace zerorate::core
