/// @file
/// A chip that froze: the same counts again and again.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "core/base/units.hpp"
#include "drivers/common/gyro_source.hpp"

namespace zerorate::drivers {

/// Counts how often a sample repeats the one before exactly, on all axes. Noise that spans some
/// counts ends a repetition soon; a chip that froze at a plausible value does not.
class Repetition {
 public:
  static constexpr std::uint32_t kEndless = std::numeric_limits<std::uint32_t>::max();

  /// @param longest samples in a row that the noise may make alike; kEndless: any number
  constexpr explicit Repetition(std::uint32_t longest) : longest_(longest) {}

  /// Takes each sample in turn. A frozen chip stays frozen until another value comes, over restarts
  /// too. Samples at full scale are equal without being frozen, and are skipped.
  [[nodiscard]] constexpr bool is_frozen_with(const GyroSample& sample) {
    if (sample.saturated_axes != 0) return false;
    if (sample.rate != newest_) {
      newest_ = sample.rate;
      alike_ = 1;
    } else if (alike_ <= longest_ && alike_ != kEndless) {
      ++alike_;
    }
    return alike_ > longest_;
  }

 private:
  std::uint32_t longest_;
  std::uint32_t alike_ = 0;
  std::array<core::AngularRate, 3> newest_{};
};

}  // namespace zerorate::drivers
