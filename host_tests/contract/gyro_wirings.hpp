/// @file
/// What the gyro suites run over.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <type_traits>

#include "host_tests/support/simulated_gyros.hpp"

namespace zerorate::contract {

using support::Adxrs453;
using support::Bmi088;
using support::Icm42688;
using support::Lsm6dso;
using support::OverFrames;
using support::OverI2c;
using support::OverSpi;

using GyrosWithFifo = ::testing::Types<OverSpi<Lsm6dso>, OverI2c<Lsm6dso>, OverSpi<Icm42688>,
                                       OverI2c<Icm42688>, OverSpi<Bmi088>, OverI2c<Bmi088>>;
using AllGyros =
    ::testing::Types<OverSpi<Lsm6dso>, OverI2c<Lsm6dso>, OverSpi<Icm42688>, OverI2c<Icm42688>,
                     OverSpi<Bmi088>, OverI2c<Bmi088>, OverFrames<Adxrs453>>;

/// A wiring's name in the test's name.
struct WiringName {
  template <class Wiring>
  static std::string GetName(int) {
    const std::string gyro = Wiring::Gyro::kName;
    const bool is_i2c = std::is_same_v<Wiring, OverI2c<typename Wiring::Gyro>>;
    return gyro + (is_i2c ? "OverI2c" : "OverSpi");
  }
};

}  // namespace zerorate::contract
