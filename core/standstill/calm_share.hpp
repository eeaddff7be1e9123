/// @file
/// Calm part of the newest stop, and of the stops before it.
#pragma once

#include <cstdint>

#include "core/base/numeric.hpp"

namespace zerorate::core {

/// Counts of judged windows, stop by stop.
class CalmShare {
 public:
  static constexpr std::uint8_t kNoPercent = 0xFF;

  constexpr bool operator==(const CalmShare&) const = default;
  /// True if restored counts are valid.
  [[nodiscard]] static bool is_possible(const CalmShare& share) {
    return share.calm_ <= share.all_ && share.all_ <= kMostWindows &&
           share.stops_with_motion_ <= kMostStops && is_bool(share.stop_is_over_);
  }

  constexpr void count_window(bool is_calm) {
    if (stop_is_over_) calm_ = all_ = 0;
    stop_is_over_ = false;
    if (all_ == kMostWindows) {
      calm_ /= 2U;
      all_ /= 2U;
    }
    ++all_;
    if (is_calm) ++calm_;
  }
  constexpr void end_stop() {
    if (!stop_is_over_ && all_ > 0) {
      const bool has_motion = calm_ < all_;
      if (has_motion && stops_with_motion_ < kMostStops) ++stops_with_motion_;
      if (!has_motion && stops_with_motion_ > 0) --stops_with_motion_;
    }
    stop_is_over_ = true;
  }

  /// Share of the newest stop that was calm, rounded down; of a long stop that of its last two
  /// minutes or so. kNoPercent before anything was judged.
  [[nodiscard]] constexpr std::uint8_t percent() const {
    if (all_ == 0) return kNoPercent;
    return static_cast<std::uint8_t>(std::uint32_t{calm_} * 100U / all_);
  }
  /// True if most of the newest stops contain motion: the odometer does not report slow rolling.
  [[nodiscard]] constexpr bool has_dead_band() const {
    return stops_with_motion_ >= kStopsOfDeadBand;
  }

 private:
  static constexpr std::uint16_t kMostWindows = 256;
  static constexpr std::uint8_t kStopsOfDeadBand = 3;
  static constexpr std::uint8_t kMostStops = 8;

  std::uint16_t calm_ = 0;
  std::uint16_t all_ = 0;
  std::uint8_t stops_with_motion_ = 0;  ///< counted up by stops with motion, down by stops without
  bool stop_is_over_ = false;
};

}  // namespace zerorate::core
