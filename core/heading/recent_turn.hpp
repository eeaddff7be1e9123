/// @file
/// Turn of an axis over the newest two seconds, for what is stamped earlier than it arrives.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"

namespace zerorate::core {

/// A ring of short pieces of the turn. Within a piece the rate counts as constant: a rate that
/// changes by 20 deg/s within a second makes an error of 0.04 deg.
///
/// Fixed memory; cost of a sample: 3 floating-point operations.
class RecentTurn {
 public:
  static constexpr std::size_t kPieces = 16;
  static constexpr float kPieceLength_s = 0.125F;

  struct Piece {
    float turn_rad = 0.0F;
    float length_s = 0.0F;

    constexpr bool operator==(const Piece&) const = default;
  };
  struct State {
    std::array<Piece, kPieces> pieces{};
    std::uint8_t newest = 0;

    constexpr bool operator==(const State&) const = default;
  };

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// Whether memory from outside may be such a state.
  [[nodiscard]] static bool is_possible(const State& state) {
    for (const Piece& piece : state.pieces) {
      if (!are_plausible(std::array{piece.turn_rad}) || !is_plausible_variance(piece.length_s)) {
        return false;
      }
    }
    return state.newest < kPieces;
  }

  constexpr void add(float turn_rad, float length_s) {
    Piece& piece = state_.pieces[state_.newest];
    piece.turn_rad += turn_rad;
    piece.length_s += length_s;
    if (piece.length_s < kPieceLength_s) return;
    state_.newest = static_cast<std::uint8_t>((state_.newest + 1U) % kPieces);
    state_.pieces[state_.newest] = {};
  }

  /// Turn from a time that lies back until the newest sample.
  /// @return no number where the time lies further back than the pieces reach
  [[nodiscard]] constexpr float since(Duration age) const {
    float left_s = age.in_seconds();
    float turn_rad = 0.0F;
    for (std::size_t k = 0; k < kPieces; ++k) {
      const Piece& piece = state_.pieces[(state_.newest + kPieces - k) % kPieces];
      if (!(left_s > 0.0F)) return turn_rad;
      if (left_s < piece.length_s) return turn_rad + piece.turn_rad * (left_s / piece.length_s);
      turn_rad += piece.turn_rad;
      left_s -= piece.length_s;
    }
    return left_s > 0.0F ? kUnknown : turn_rad;
  }

 private:
  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

  State state_{};
};

}  // namespace zerorate::core
