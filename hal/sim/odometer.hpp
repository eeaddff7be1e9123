/// @file
/// A wheel sensor whose pulses are given one by one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>

#include "core/base/assert.hpp"
#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "hal/contract/pulse_input.hpp"

namespace zerorate::hal::sim {

/// A PulseInput with the bounded queue of a real one.
class SimulatedOdometer {
 public:
  /// @param queue_size stamps that are kept between two reads; more are counted as lost
  explicit SimulatedOdometer(std::size_t queue_size = 64) : queue_size_(queue_size) {}

  /// One pulse; stamps may not decrease.
  void pulse(core::Instant time) {
    ZERORATE_ASSERT(!latest_ || time >= *latest_);
    latest_ = time;
    if (queue_.size() < queue_size_) {
      queue_.push_back(time);
    } else {
      ++lost_;
    }
  }

  core::Result<PulseBatch, BusError> read_pulses(std::span<core::Instant> stamps) {
    PulseBatch batch{std::min(stamps.size(), queue_.size()), lost_};
    std::copy_n(queue_.begin(), batch.count, stamps.begin());
    queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(batch.count));
    lost_ = 0;
    return batch;
  }

 private:
  std::size_t queue_size_;
  std::deque<core::Instant> queue_;
  std::optional<core::Instant> latest_;
  std::uint32_t lost_ = 0;
};
static_assert(PulseInput<SimulatedOdometer>);

}  // namespace zerorate::hal::sim
