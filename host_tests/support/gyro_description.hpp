/// @file
/// Parts of the description of a gyro in the contract suite.
#pragma once

#include <cstdint>

namespace zerorate::support {

/// Settings of a full scale, the rate of its LSB, and how far the test goes.
template <class Settings>
struct Range {
  Settings settings;
  float lsb_dps;
  float span_dps;
};

/// Bits of a register that the driver configures.
struct ConfiguredBits {
  std::uint8_t address;
  std::uint8_t bits;
};

}  // namespace zerorate::support
