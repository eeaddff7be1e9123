/// @file
/// Edges of pins, stamped in the interrupt.
///
/// One processor, one interrupt handler that writes, one main loop that reads: loads and stores of
/// words are enough, and where an interrupt could tear two of them, interrupts wait.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "hal/contract/data_ready.hpp"
#include "hal/contract/pulse_input.hpp"
#include "hal/cortex_m/interrupts.hpp"
#include "hal/cortex_m/timer.hpp"

namespace zerorate::hal::cortex_m {

/// A DataReady: the latest edge.
template <MicrosecondCounter Counter>
class LatestEdge {
 public:
  /// For the handler.
  void on_edge(std::uint64_t microseconds) {
    microseconds_ = microseconds;
    is_new_.store(true, std::memory_order_release);
  }

  [[nodiscard]] bool has_edge() const { return is_new_.load(std::memory_order_acquire); }
  std::optional<core::Instant> take_edge() {
    const InterruptLock lock;
    if (!has_edge()) return std::nullopt;
    is_new_.store(false, std::memory_order_relaxed);
    return CounterClock<Counter>::instant(microseconds_);
  }

 private:
  std::uint64_t microseconds_ = 0;
  std::atomic<bool> is_new_{false};
};

/// A PulseInput: every edge, in a queue that is read at least once an hour.
/// @tparam Capacity power of two; at 500 Hz 32 stamps last 64 ms
template <MicrosecondCounter Counter, std::size_t Capacity>
class EdgeQueue {
  static_assert((Capacity & (Capacity - 1)) == 0, "indices wrap at a power of two");

 public:
  /// For the handler.
  void on_edge(std::uint64_t microseconds) {
    const std::uint32_t written = written_.load(std::memory_order_relaxed);
    if (written - taken_.load(std::memory_order_acquire) == Capacity) {
      lost_.store(lost_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      return;
    }
    microseconds_[written % Capacity] = static_cast<std::uint32_t>(microseconds);
    written_.store(written + 1, std::memory_order_release);
  }

  [[nodiscard]] bool is_empty() const {
    return written_.load(std::memory_order_acquire) == taken_.load(std::memory_order_relaxed);
  }

  core::Result<PulseBatch, BusError> read_pulses(std::span<core::Instant> stamps) {
    const std::uint32_t lost = lost_.load(std::memory_order_relaxed);
    PulseBatch batch{.lost = lost - lost_reported_};
    lost_reported_ = lost;
    std::uint32_t taken = taken_.load(std::memory_order_relaxed);
    const std::uint32_t written = written_.load(std::memory_order_acquire);
    // Half of a stamp is kept; the other half follows from the time since.
    const std::uint64_t now = Counter::microseconds();
    for (; taken != written && batch.count < stamps.size(); ++taken) {
      const auto age = static_cast<std::uint32_t>(now) - microseconds_[taken % Capacity];
      stamps[batch.count++] = CounterClock<Counter>::instant(now - age);
    }
    taken_.store(taken, std::memory_order_release);
    return batch;
  }

 private:
  std::array<std::uint32_t, Capacity> microseconds_{};
  std::atomic<std::uint32_t> written_{0};
  std::atomic<std::uint32_t> taken_{0};
  std::atomic<std::uint32_t> lost_{0};
  std::uint32_t lost_reported_ = 0;
};

}  // namespace zerorate::hal::cortex_m
