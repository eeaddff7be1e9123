/// @file
/// An interrupt pin of a simulated chip.
#pragma once

#include <optional>

#include "core/base/time.hpp"
#include "hal/contract/data_ready.hpp"

namespace zerorate::hal::sim {

/// A DataReady whose level is driven by a chip; rising edges are active.
class DataReadyPin {
 public:
  /// The chip's side.
  void drive(bool level, core::Instant now) {
    if (level && !level_) edge_ = now;
    level_ = level;
  }

  [[nodiscard]] bool level() const { return level_; }
  [[nodiscard]] std::optional<core::Instant> take_edge() {
    const auto edge = edge_;
    edge_.reset();
    return edge;
  }

 private:
  bool level_ = false;
  std::optional<core::Instant> edge_;
};
static_assert(DataReady<DataReadyPin>);

}  // namespace zerorate::hal::sim
