/// @file
/// All of the outside that the measuring side of the node touches, behind one table of functions.
#pragma once

#include <optional>
#include <span>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "drivers/common/any_gyro.hpp"
#include "firmware/boards/linux/chips/gyro.hpp"
#include "firmware/boards/linux/datagram_gyro.hpp"
#include "firmware/boards/linux/reference_source.hpp"
#include "hal/contract/data_ready.hpp"
#include "hal/contract/monotonic_clock.hpp"
#include "hal/contract/pulse_input.hpp"

namespace zerorate::linux_node {

/// Reasons of the newest faults, beyond the errors of the contract.
struct HardwareReasons {
  GyroReason gyro;
  int odometer_error_number = 0;  ///< errno of the kernel; 0: none
};

/// A gyro, and a PulseInput, a DataReady and a MonotonicClock at once. The product binds it to
/// hal/linux; tests bind it to simulated chips.
class Hardware {
 public:
  Hardware() = default;
  Hardware(const Hardware&) = delete;
  Hardware& operator=(const Hardware&) = delete;
  virtual ~Hardware() = default;

  [[nodiscard]] virtual drivers::AnyGyro& gyro() = 0;
  virtual core::Result<hal::PulseBatch, hal::BusError> read_pulses(
      std::span<core::Instant> stamps) = 0;
  virtual std::optional<core::Instant> take_edge() = 0;
  /// The next reference of the heading that waits.
  [[nodiscard]] virtual std::optional<Reference> next_reference() { return std::nullopt; }
  /// Errno for which no reference can come; 0: none.
  [[nodiscard]] virtual int reference_error_number() const { return 0; }
  /// Messages of a gyro by message that gave no sample.
  [[nodiscard]] virtual SampleCounters sample_counters() const { return {}; }
  /// For the log, after an error of the gyro or the odometer. May ask the chip.
  virtual HardwareReasons reasons(drivers::DriverErrorCode /*code*/) { return {}; }
  [[nodiscard]] virtual core::Instant now() const = 0;
  /// Time for which the machine has slept since it was started, which now() does not count.
  [[nodiscard]] virtual core::Duration slept() const { return {}; }

  /// Sleeps until there may be something to do: an edge, a wake(), or the time for a poll.
  virtual void wait() = 0;
  /// Ends a wait(), from any thread.
  virtual void wake() = 0;
};
static_assert(hal::PulseInput<Hardware>);
static_assert(hal::DataReady<Hardware>);
static_assert(hal::MonotonicClock<Hardware>);

}  // namespace zerorate::linux_node
