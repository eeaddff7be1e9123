/// @file
/// A driver and what it is wired to, as an AnyGyro.
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <utility>

#include "drivers/common/any_gyro.hpp"

namespace zerorate::drivers {

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
  [[nodiscard]] bool is_batched() const final { return driver_.is_batched(); }

 protected:
  [[nodiscard]] Wiring& wiring() { return wiring_; }

 private:
  Wiring wiring_;
  Driver driver_;
};

}  // namespace zerorate::drivers
