/// @file
/// Reasons why a driver failed.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/base/result.hpp"
#include "hal/contract/bus_error.hpp"

namespace zerorate::drivers {

enum class DriverErrorCode : std::uint8_t {
  bus_failed,          ///< the transaction failed; see DriverError::bus
  wrong_identity,      ///< another chip, none, or a stuck data line
  not_ready,           ///< the chip needs time: call again later; or it was not started
  configuration_lost,  ///< a register does not hold what was written to it
  fifo_overrun,        ///< samples were lost in the chip; the next read continues after the gap
  corrupt_data,    ///< bits that the datasheet fixes are wrong: the transfer is not to be trusted
  sensor_fault,    ///< the chip's own supervision found its data invalid
  frozen,          ///< an axis no longer measures; DriverError::reg has bit i for axis i
  no_config_file,  ///< the chip needs a file that was not given, or whose size cannot be right
  no_new_samples,  ///< the chip answers, but has measured nothing for long
};

/// For logs and tables.
[[nodiscard]] constexpr std::string_view name(DriverErrorCode code) {
  switch (code) {
    case DriverErrorCode::bus_failed:
      return "bus failed";
    case DriverErrorCode::wrong_identity:
      return "wrong identity";
    case DriverErrorCode::not_ready:
      return "not ready";
    case DriverErrorCode::configuration_lost:
      return "configuration lost";
    case DriverErrorCode::fifo_overrun:
      return "FIFO overrun";
    case DriverErrorCode::corrupt_data:
      return "corrupt data";
    case DriverErrorCode::sensor_fault:
      return "the chip reports a fault";
    case DriverErrorCode::no_config_file:
      return "no config file";
    case DriverErrorCode::no_new_samples:
      return "no new samples";
    case DriverErrorCode::frozen:
      return "frozen";
  }
  return "unknown";
}

/// Fits in a register and is returned by value.
struct DriverError {
  DriverErrorCode code = DriverErrorCode::bus_failed;
  hal::BusError bus = {};  ///< only meaningful if code is bus_failed
  std::uint8_t reg = 0;    ///< register of the step that failed; axes where code is frozen

  constexpr bool operator==(const DriverError&) const = default;
};
static_assert(sizeof(DriverError) <= 4);

/// The error of a transaction on the given register.
[[nodiscard]] constexpr core::Unexpected<DriverError> bus_failed(hal::BusError error,
                                                                 std::uint8_t reg) {
  return core::Unexpected{DriverError{DriverErrorCode::bus_failed, error, reg}};
}

/// An error that the chip's answer shows, not the bus.
[[nodiscard]] constexpr core::Unexpected<DriverError> refused(DriverErrorCode code,
                                                              std::uint8_t reg) {
  return core::Unexpected{DriverError{code, {}, reg}};
}

}  // namespace zerorate::drivers
