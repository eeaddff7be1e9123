/// @file
/// Stamps of several time lines whose rows take turns in one file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace zerorate::recording {

/// Looks at stamps in the order of the file, in blocks of 240 rows. Rows take turns in a block
/// where a tenth of its steps run backwards and
///
/// - a tenth of them lead to a stamp that was there up to eight rows before: two bursts are written
///   in turn, and each has one stamp; or
/// - every second or third stamp advances, and each step backwards has its place in the turn. Pairs
///   in the wrong order are excepted: they are even when sorted, and none moves further than a
///   turn.
///
/// Memory: one block. Cost: a sorted block each 240 rows, where steps run backwards.
class StampsInTurn {
 public:
  void add(std::int64_t stamp_ns);

  /// True where stamps of four rows or more, in the mean, run backwards in more than one of eight:
  /// a counter that begins again while a burst is read, and nobody knows how often.
  [[nodiscard]] bool run_back_between_bursts() const {
    constexpr std::uint64_t kFewest = 10;
    constexpr std::uint64_t kRowsOfBurst = 4;
    constexpr std::uint64_t kOneOf = 8;
    return back_ >= kFewest && back_ * kOneOf > stamps_ && rows_ > kRowsOfBurst * stamps_;
  }

  /// True if rows took turns in four blocks and in more than one block of fifty.
  [[nodiscard]] bool are_there() const {
    constexpr std::uint64_t kFewest = 4;
    constexpr std::uint64_t kOneOf = 50;
    return in_turn_ >= kFewest && in_turn_ * kOneOf > blocks_;
  }

 private:
  std::array<std::int64_t, 240> block_{};
  std::size_t size_ = 0;
  std::int64_t newest_ns_ = 0;
  std::uint64_t rows_ = 0;
  std::uint64_t stamps_ = 0;  ///< rows with another stamp than the one before
  std::uint64_t back_ = 0;    ///< stamps before the one of the row ahead
  std::uint64_t blocks_ = 0;
  std::uint64_t in_turn_ = 0;  ///< blocks in which rows take turns
};

}  // namespace zerorate::recording
