/// @file
/// Sums of the newest j measurements for every j, in fixed memory for any number of measurements.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/assert.hpp"
#include "core/base/numeric.hpp"

namespace zerorate::core {

/// An exponential histogram: the newest kExact measurements one by one, then rings of kPerLevel
/// blocks of 2, 4, 8, ... measurements. When a ring is full its two oldest blocks become one of the
/// next ring.
///
/// The suffix that ends inside a block takes its share of that block's sum. At least
/// kPerLevel - 1 blocks of every shorter length are newer, so the suffix mean is wrong by at most
/// 1 / (4 (kPerLevel - 1)) of the difference between the means of the two parts of that one block;
/// suffixes that end between blocks are exact, as are all of the newest kExact - 1.
/// @tparam Levels number of rings, 50 bytes each. They hold 12 2^(Levels + 1) measurements
///         (22: 1e8, 16: 1.6e6); older ones stay in the last block.
template <std::size_t Levels = 22>
class SuffixSums {
 public:
  static constexpr std::size_t kExact = 64;
  static constexpr std::size_t kPerLevel = 12;

  [[nodiscard]] constexpr std::uint32_t count() const { return count_; }

  /// Forgets all measurements; the numbers stay in their places, unused.
  constexpr void clear() {
    used_ = {};
    exact_used_ = 0;
    count_ = 0;
    swallowed_ = 0;
  }

  /// Cost: amortised two additions; at worst one per level.
  constexpr void push(float value) {
    ++count_;
    if (exact_used_ == kExact) {
      // The two oldest leave together as a block of two.
      push_block(0, exact_[oldest_exact_] + exact_[(oldest_exact_ + 1) % kExact]);
      oldest_exact_ = static_cast<std::uint8_t>((oldest_exact_ + 2) % kExact);
      exact_used_ = static_cast<std::uint8_t>(exact_used_ - 2);
    }
    exact_[(oldest_exact_ + exact_used_) % kExact] = value;
    ++exact_used_;
  }

  /// Sum of the newest `length` measurements, length <= count(). Cost: one addition per block.
  [[nodiscard]] constexpr float sum_of_newest(std::uint32_t length) const {
    ZERORATE_ASSERT(length <= count_);
    float sum = 0.0F;
    std::uint32_t taken = 0;
    for_each_newest_first([&](std::uint32_t size, float block_sum) {
      const std::uint32_t wanted = length - taken;
      if (wanted == 0) return false;
      if (wanted < size) {
        sum += block_sum * (static_cast<float>(wanted) / static_cast<float>(size));
        taken = length;
        return false;
      }
      sum += block_sum;
      taken += size;
      return true;
    });
    return sum;
  }

  /// Calls visit(size, sum) for each block until it returns false.
  template <class Visitor>
  constexpr void for_each_newest_first(Visitor visit) const {
    for (std::size_t i = exact_used_; i-- > 0;) {
      if (!visit(1U, exact(i))) return;
    }
    for (std::size_t level = 0; level < Levels; ++level) {
      for (std::size_t i = used_[level]; i-- > 0;) {
        if (!visit(size_of_block(level, i), block(level, i))) return;
      }
    }
  }

  /// Calls visit(size, sum) for each block.
  template <class Visitor>
  constexpr void for_each_oldest_first(Visitor visit) const {
    for (std::size_t level = Levels; level-- > 0;) {
      for (std::size_t i = 0; i < used_[level]; ++i) {
        visit(size_of_block(level, i), block(level, i));
      }
    }
    for (std::size_t i = 0; i < exact_used_; ++i) {
      visit(1U, exact(i));
    }
  }

  /// True if restored sums are valid: places in range, blocks that add up to the count, plausible
  /// numbers.
  [[nodiscard]] constexpr bool is_possible() const {
    if (oldest_exact_ >= kExact || exact_used_ > kExact) return false;
    for (std::size_t level = 0; level < Levels; ++level) {
      if (oldest_[level] >= kPerLevel || used_[level] > kPerLevel) return false;
    }
    std::uint64_t count = 0;
    bool are_numbers = true;
    for_each_newest_first([&](std::uint32_t size, float block_sum) {
      count += size;
      are_numbers &= is_plausible(block_sum);
      return true;
    });
    return are_numbers && count == count_;
  }

  /// Whether both hold the same blocks, wherever in their rings.
  constexpr bool operator==(const SuffixSums& other) const {
    if (count_ != other.count_ || swallowed_ != other.swallowed_ || used_ != other.used_ ||
        exact_used_ != other.exact_used_) {
      return false;
    }
    for (std::size_t level = 0; level < Levels; ++level) {
      for (std::size_t i = 0; i < used_[level]; ++i) {
        if (block(level, i) != other.block(level, i)) return false;
      }
    }
    for (std::size_t i = 0; i < exact_used_; ++i) {
      if (exact(i) != other.exact(i)) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] constexpr float exact(std::size_t i) const {
    return exact_[(oldest_exact_ + i) % kExact];
  }
  [[nodiscard]] constexpr float block(std::size_t level, std::size_t i) const {
    return blocks_[level][(oldest_[level] + i) % kPerLevel];
  }
  constexpr float& block(std::size_t level, std::size_t i) {
    return blocks_[level][(oldest_[level] + i) % kPerLevel];
  }
  /// Size of a block: 2^(level + 1); the oldest of the last level holds all older measurements.
  [[nodiscard]] constexpr std::uint32_t size_of_block(std::size_t level, std::size_t i) const {
    const std::uint32_t size = 2U << level;
    return level == Levels - 1 && i == 0 ? size + swallowed_ : size;
  }

  constexpr void push_block(std::size_t level, float sum) {
    // A loop, not a recursion: the target's stack use stays a constant.
    for (; used_[level] == kPerLevel && level + 1 < Levels; ++level) {
      const float merged = block(level, 0) + block(level, 1);
      drop_oldest(level);
      drop_oldest(level);
      append(level, sum);
      sum = merged;
    }
    if (used_[level] == kPerLevel) swallow_oldest(level);
    append(level, sum);
  }

  constexpr void append(std::size_t level, float sum) {
    block(level, used_[level]) = sum;
    ++used_[level];
  }

  constexpr void drop_oldest(std::size_t level) {
    oldest_[level] = static_cast<std::uint8_t>((oldest_[level] + 1) % kPerLevel);
    --used_[level];
  }

  constexpr void swallow_oldest(std::size_t last_level) {
    block(last_level, 1) += block(last_level, 0);
    swallowed_ += 2U << last_level;
    drop_oldest(last_level);
  }

  std::array<float, kExact> exact_{};
  std::array<std::array<float, kPerLevel>, Levels> blocks_{};
  std::array<std::uint8_t, Levels> oldest_{};
  std::array<std::uint8_t, Levels> used_{};
  std::uint32_t count_ = 0;
  std::uint32_t swallowed_ = 0;
  std::uint8_t oldest_exact_ = 0;
  std::uint8_t exact_used_ = 0;
};

}  // namespace zerorate::core
