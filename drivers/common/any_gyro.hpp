/// @file
/// Gyro with chip and bus chosen at run time, and a driver together with its wiring.
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <utility>

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
  static constexpr std::size_t kAxes = 3;          ///< a chip with one gives its rate on all three
  static constexpr bool kHasAccelerometer = true;  ///< some have one

  AnyGyro() = default;
  AnyGyro(const AnyGyro&) = delete;
  AnyGyro& operator=(const AnyGyro&) = delete;
  virtual ~AnyGyro() = default;

  virtual core::Result<void, DriverError> start(core::Instant now) = 0;
  virtual core::Result<std::size_t, DriverError> read(core::Instant now,
                                                      std::span<GyroSample> out) = 0;
  virtual core::Result<void, DriverError> verify_next() = 0;
  [[nodiscard]] virtual core::Duration sample_period() const = 0;
  [[nodiscard]] virtual core::AngularRate lsb() const = 0;
  [[nodiscard]] virtual bool is_batched() const = 0;
};
static_assert(GyroSource<AnyGyro>);

/// Owns the wiring, which the driver refers to.
/// @tparam Wiring  e.g. a back end of hal/linux
/// @tparam Driver  a GyroSource
/// @tparam Base    the interface that is implemented: AnyGyro or one that extends it
template <class Wiring, GyroSource Driver, std::derived_from<AnyGyro> Base = AnyGyro>
class ErasedGyro : public Base {
 public:
  /// @param make_driver  makes the driver from a reference to the wiring
  /// @param wiring       arguments of the wiring's constructor
  template <class MakeDriver, class... Arguments>
  explicit ErasedGyro(MakeDriver make_driver, Arguments&&... wiring)
      : wiring_{std::forward<Arguments>(wiring)...}, driver_(make_driver(wiring_)) {}

  core::Result<void, DriverError> start(core::Instant now) final { return driver_.start(now); }
  core::Result<std::size_t, DriverError> read(core::Instant now, std::span<GyroSample> out) final {
    return driver_.read(now, out);
  }
  core::Result<void, DriverError> verify_next() final { return driver_.verify_next(); }
  [[nodiscard]] core::Duration sample_period() const final { return driver_.sample_period(); }
  [[nodiscard]] core::AngularRate lsb() const final { return driver_.lsb(); }
  [[nodiscard]] bool is_batched() const final { return driver_.is_batched(); }

 protected:
  [[nodiscard]] Wiring& wiring() { return wiring_; }

 private:
  Wiring wiring_;
  Driver driver_;
};

}  // namespace zerorate::drivers
