/// @file
/// Times at which a chip took the samples that are later read from its FIFO in batches.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"

namespace zerorate::drivers {

/// Counts the chip's samples, and corrects the stamps by the time of each reading.
///
/// The chip samples evenly; the reader comes when it has time. Stamping the newest sample with the
/// time of the reading would carry the reader's jitter into the data. Here the stamps go on one
/// period apart from batch to batch, and move only when they would be impossible: the newest sample
/// cannot be younger than the reading, nor more than one period older, or there would be a further
/// one. So the stamps are even, never run backwards, and are less than one period off, however far
/// the chip's oscillator is from its nominal rate. The first batch begins at the latest possible
/// time; readings that come close after a sample pull the stamps to where they belong.
class SampleClock {
 public:
  /// Forgets what came before; no stamp will be earlier than `now`.
  constexpr void restart(core::Instant now, core::Duration period) {
    latest_ = now;
    period_ = period;
    is_locked_ = false;
  }

  /// Call after a loss of unknown length: the next batch begins a new count.
  constexpr void lose_count() { is_locked_ = false; }

  /// Fixes the stamps of the samples that wait in the FIFO.
  /// @param now of the reading of its level; may not decrease
  /// @param waiting samples, at least one
  constexpr void begin_batch(core::Instant now, std::size_t waiting) {
    waiting_ = static_cast<std::int64_t>(waiting);
    newest_ = is_locked_ ? std::clamp(latest_ + period_ * waiting_, now - period_, now) : now;
    const core::Duration even = (newest_ - latest_) / waiting_;
    step_ = is_locked_ ? even : std::min(period_, even);
    step_ = std::max(step_, core::Duration{});
    is_locked_ = true;
  }

  /// Stamp of the oldest sample of the batch that was not taken yet. Samples that are not taken
  /// stay in the FIFO for the next batch.
  constexpr core::Instant next() {
    latest_ = newest_ - step_ * --waiting_;
    return latest_;
  }

 private:
  core::Duration period_;
  core::Duration step_;
  core::Instant latest_;  ///< the last stamp given
  core::Instant newest_;  ///< time of the newest sample in the FIFO
  std::int64_t waiting_ = 0;
  bool is_locked_ = false;
};

}  // namespace zerorate::drivers
