/// @file
/// A data-ready pin on an input that keeps every edge.
#pragma once

#include <array>
#include <optional>

#include "core/base/time.hpp"
#include "hal/contract/data_ready.hpp"
#include "hal/contract/pulse_input.hpp"

namespace zerorate::hal::linux_os {

/// A DataReady over a PulseInput, which must outlive it. An input that fails gives no edge: the
/// loop then reads the sensor by the clock.
template <PulseInput Input>
class LatestEdge {
 public:
  explicit LatestEdge(Input& input) : input_(&input) {}

  std::optional<core::Instant> take_edge() {
    std::optional<core::Instant> latest;
    std::array<core::Instant, 16> stamps{};
    for (;;) {
      const auto batch = input_->read_pulses(stamps);
      if (!batch || batch->count == 0) return latest;
      latest = stamps[batch->count - 1];
      if (batch->count < stamps.size()) return latest;
    }
  }

 private:
  Input* input_;
};

}  // namespace zerorate::hal::linux_os
