/// @file
/// Which pin of the Pico does what; docs/how-to/use-a-pico.md draws it.
#pragma once

namespace zerorate::pico {

inline constexpr unsigned kUartTransmit = 0;
inline constexpr unsigned kUartReceive = 1;
inline constexpr unsigned kI2cData = 4;
inline constexpr unsigned kI2cClock = 5;
inline constexpr unsigned kOdometer = 15;
inline constexpr unsigned kSpiMiso = 16;
inline constexpr unsigned kSpiChipSelect = 17;
inline constexpr unsigned kSpiClock = 18;
inline constexpr unsigned kSpiMosi = 19;
inline constexpr unsigned kDataReady = 20;

}  // namespace zerorate::pico
