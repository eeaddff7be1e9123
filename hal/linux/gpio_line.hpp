/// @file
/// An input line of a GPIO chip whose edges the kernel stamps, through libgpiod, and a data-ready
/// pin on such an input.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "hal/contract/data_ready.hpp"
#include "hal/contract/pulse_input.hpp"

namespace zerorate::hal::linux_os {

enum class Edge : std::uint8_t { rising, falling, both };
/// Resistor inside the chip; as_is leaves what the boot or the device tree has set.
enum class LineBias : std::uint8_t { as_is, disabled, pull_up, pull_down };

struct LineSettings {
  std::string chip;  ///< its label or name, or its node as "/dev/gpiochip0"
  std::string line;  ///< its name, or its number on the chip in decimal
  Edge edge = Edge::rising;
  LineBias bias = LineBias::as_is;
  core::Duration debounce{};  ///< edges so soon after the one before are not handed on
};

/// Leaves out edges that follow another one too closely. The first edge counts, at its own time.
class Debounce {
 public:
  explicit Debounce(core::Duration shortest) : shortest_(shortest) {}

  /// Leaves bounces out of a batch.
  void drop_bounces(std::span<core::Instant> stamps, PulseBatch& batch) {
    std::size_t kept = 0;
    for (const core::Instant edge : stamps.first(batch.count)) {
      const bool is_bounce = newest_ && edge - *newest_ < shortest_;
      newest_ = edge;
      if (!is_bounce) stamps[kept++] = edge;
    }
    batch.count = kept;
  }

 private:
  core::Duration shortest_;
  std::optional<core::Instant> newest_;  ///< edge, bounces too
};

/// A PulseInput: each edge is a pulse, stamped by the kernel (CLOCK_MONOTONIC) in the interrupt.
///
/// Built against libgpiod 2 or 1.6, whichever CMake found; this header knows neither. With 2, edges
/// that the kernel dropped show as a gap in the line's sequence numbers and are counted. The
/// interface that 1.6 uses has no such numbers: there a kernel queue (16 edges) found full counts
/// as one lost edge: their number is unknown.
///
/// The line is requested at the first use, and again at the first use after the chip was gone.
/// No heap once the line is requested.
class GpioLine {
 public:
  explicit GpioLine(LineSettings settings);
  GpioLine(const GpioLine&) = delete;
  GpioLine& operator=(const GpioLine&) = delete;
  ~GpioLine();

  /// not_present: no such chip or line, or not for us; timeout: another process holds the line.
  core::Result<void, BusError> open();
  core::Result<PulseBatch, BusError> read_pulses(std::span<core::Instant> stamps);
  /// Becomes readable when there is an edge, for poll(); -1 while the line is not open.
  [[nodiscard]] int descriptor() const;

 private:
  struct Request;  // line of libgpiod
  LineSettings settings_;
  Debounce debounce_{settings_.debounce};
  std::unique_ptr<Request> request_;
};
static_assert(PulseInput<GpioLine>);

/// A DataReady over a PulseInput, which must outlive it. An input that fails gives no edge: the
/// loop then reads the sensor by the clock.
template <PulseInput Input>
class LatestEdge {
 public:
  explicit LatestEdge(Input& input) : input_(&input) {}

  std::optional<core::Instant> take_edge() {
    std::optional<core::Instant> latest;
    std::array<core::Instant, 16> stamps{};
    // The kernel keeps no more edges of a line; one that floats has always one more.
    constexpr int kMostBatches = 64;
    for (int i = 0; i < kMostBatches; ++i) {
      const auto batch = input_->read_pulses(stamps);
      if (!batch || batch->count == 0) return latest;
      latest = stamps[batch->count - 1];
      if (batch->count < stamps.size()) return latest;
    }
    return latest;
  }

 private:
  Input* input_;
};

}  // namespace zerorate::hal::linux_os
