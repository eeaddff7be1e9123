/// @file
/// A gyro whose chip and bus are chosen at run time.
#pragma once

#include <cstddef>
#include <span>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/gyro_source.hpp"

namespace zerorate::drivers {

/// A GyroSource behind a table of functions, for programs with an operating system: their loop is
/// compiled once, and not for every chip on every bus. One indirect call a sample costs nothing
/// beside a system call. Flashed images name their driver instead (docs/adr/0003).
class AnyGyro {
 public:
  static constexpr std::size_t kAxes = 3;  ///< a chip with one gives its rate on all three

  AnyGyro() = default;
  AnyGyro(const AnyGyro&) = delete;
  AnyGyro& operator=(const AnyGyro&) = delete;
  virtual ~AnyGyro() = default;

  virtual core::Result<void, DriverError> start(core::Instant now) = 0;
  virtual core::Result<std::size_t, DriverError> read(core::Instant now,
                                                      std::span<GyroSample> out) = 0;
  virtual core::Result<void, DriverError> verify_next() = 0;
  [[nodiscard]] virtual core::Duration sample_period() const = 0;
  [[nodiscard]] virtual bool is_batched() const = 0;
};
static_assert(GyroSource<AnyGyro>);

}  // namespace zerorate::drivers
