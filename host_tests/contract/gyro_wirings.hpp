/// @file
/// Wirings that the gyro suites run over.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <type_traits>

#include "host_tests/support/simulated_accelerometers.hpp"
#include "host_tests/support/simulated_gyros.hpp"

namespace zerorate::contract {

using support::OverI2c;

/// Lists of types as googletest takes them, one after the other.
template <class... Lists>
struct AsTestTypes;
template <class... Types>
struct AsTestTypes<core::TypeList<Types...>> {
  using Joined = ::testing::Types<Types...>;
};
template <class... First, class... Second, class... Others>
struct AsTestTypes<core::TypeList<First...>, core::TypeList<Second...>, Others...>
    : AsTestTypes<core::TypeList<First..., Second...>, Others...> {};

using GyrosWithFifo =
    AsTestTypes<support::WiringsWithFifo, support::WiringsWithAcceleration>::Joined;
using AllGyros =
    AsTestTypes<support::WiringsWithFifo, support::WiringsWithAcceleration,
                support::WiringsWithAccelerationAlone, support::WiringsWithoutFifo>::Joined;
using GyrosWithAcceleration =
    AsTestTypes<support::WiringsWithAcceleration, support::WiringsWithAccelerationAlone>::Joined;

/// A wiring's name in the test's name.
struct WiringName {
  template <class Wiring>
  static std::string GetName(int) {
    const std::string gyro = Wiring::Gyro::kName;
    using Gyro = typename Wiring::Gyro;
    const bool is_i2c = std::is_same_v<Wiring, OverI2c<Gyro>> ||
                        std::is_same_v<Wiring, support::OverI2cTwice<Gyro>>;
    return gyro + (is_i2c ? "OverI2c" : "OverSpi");
  }
};

}  // namespace zerorate::contract
