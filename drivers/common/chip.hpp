/// @file
/// Description of a chip, for programs that choose a gyro by its name or use every known gyro.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/time.hpp"
#include "drivers/common/register_access.hpp"
#include "hal/contract/spi_device.hpp"

namespace zerorate::drivers {

/// A value that a chip can be set to, in the unit of its data sheet, and its code in the driver.
template <class Code>
struct Choice {
  double value;
  Code code;
};

/// Code of a setting that the chip does not have.
struct Fixed {};

/// A line of the table of chips (drivers/chips/chips.hpp):
/// - `kName`           as in configurations, model files and options
/// - `Driver<Bus>`     its driver, a GyroSource
/// - `Settings`        of the driver, with sensible defaults
/// - `kRates`          Choices of the output data rate [Hz], as the data sheet names them
/// - `kFullScales`     Choices of the range [deg/s]
/// - `settings(rate, full_scale, is_fifo)`  Settings, from two codes
/// - `kCounts`         counts at full scale; one is the LSB
/// - `kHasDataReady`   whether the chip signals each sample with an edge
/// - `kHasFifo`        whether is_fifo may be true
/// - `kHasThermometer` whether samples can carry a temperature
/// - `kAxes`           of the gyro: 3 or 1
/// - `kSpiMode`, `kHighestSpi_hz`
/// - `kSpiPause`       only where the chip needs one: time without selection between two
/// transactions
/// - `Spi<Device>`     only where it is not SpiRegisters: link of the driver on SPI
template <class Chip>
concept ChipEntry = requires {
  { Chip::kName } -> std::convertible_to<std::string_view>;
  { Chip::kCounts } -> std::convertible_to<double>;
  { Chip::kHasDataReady } -> std::convertible_to<bool>;
  { Chip::kHasFifo } -> std::convertible_to<bool>;
  { Chip::kHasThermometer } -> std::convertible_to<bool>;
  { Chip::kAxes } -> std::convertible_to<std::size_t>;
  { Chip::kSpiMode } -> std::convertible_to<std::uint8_t>;
  { Chip::kHighestSpi_hz } -> std::convertible_to<std::uint32_t>;
  {
    Chip::settings(Chip::kRates[0].code, Chip::kFullScales[0].code, false)
    } -> std::same_as<typename Chip::Settings>;
};

/// A chip with an accelerometer, which samples can carry:
/// - `DriverWithAcceleration<Bus>`  a GyroSource, made of a bus, Settings and the code of a range
/// - `kAccelerationRanges`          Choices of the range [g]
/// - `kUsualAccelerationRange_g`    one of them
template <class Chip>
concept AccelerometerChipEntry = ChipEntry<Chip> && requires {
  Chip::kAccelerationRanges[0].code;
  { Chip::kUsualAccelerationRange_g } -> std::convertible_to<double>;
};

/// A chip whose accelerometer answers apart: `kAccelerometerAddresses` on I2C,
/// `AccelerometerSpi<Device>`, and `buses(gyro, accelerometer)`, over which the driver goes.
template <class Chip>
concept TwoDieChipEntry = AccelerometerChipEntry<Chip> && requires {
  Chip::kAccelerometerAddresses[0];
};

/// A chip with 8-bit registers, on SPI and I2C: `kAddresses` and `kIdentity`, the register that
/// identifies the chip by its reset value. Where the driver takes relatives too, which give other
/// values, `is_identity(value)`.
template <class Chip>
concept RegisterChipEntry = ChipEntry<Chip> && requires {
  Chip::kAddresses[0];
  Chip::kIdentity.reset;
};

/// Link of a driver on SPI: the chip's own `Spi<Device>`, or SpiRegisters.
template <class Chip, hal::SpiDevice Device>
struct SpiLinkOf {
  using Type = SpiRegisters<Device>;
};
template <class Chip, hal::SpiDevice Device>
requires requires {
  typename Chip::template Spi<Device>;
}
struct SpiLinkOf<Chip, Device> {
  using Type = typename Chip::template Spi<Device>;
};
template <class Chip, hal::SpiDevice Device>
using SpiLink = typename SpiLinkOf<Chip, Device>::Type;

/// Pause between two transactions on SPI.
template <ChipEntry Chip>
inline constexpr core::Duration kSpiPauseOf = [] {
  if constexpr (requires { Chip::kSpiPause; }) {
    return Chip::kSpiPause;
  } else {
    return core::Duration{};
  }
}();

/// A chip that needs a file of its maker's at each start: Settings have `config_file`, its bytes,
/// which must outlive the driver, and `takes_config_file(bytes)` whether one can be of this size.
template <class Chip>
concept ConfigFileChipEntry = ChipEntry<Chip> && requires(typename Chip::Settings settings) {
  settings.config_file;
  { Chip::takes_config_file(std::size_t{}) } -> std::same_as<bool>;
};

/// True if the driver accepts a chip with this answer.
template <RegisterChipEntry Chip>
[[nodiscard]] constexpr bool takes_identity(std::uint8_t value) {
  if constexpr (requires { Chip::is_identity(value); }) {
    return Chip::is_identity(value);
  } else {
    return value == Chip::kIdentity.reset;
  }
}

/// A chip of 32-bit frames, on SPI: `kAskIdentity`, a frame, and `is_identity(reply)`.
template <class Chip>
concept FrameChipEntry = ChipEntry<Chip> &&
    std::same_as<decltype(Chip::kAskIdentity), const std::uint32_t> &&
    requires(std::uint32_t reply) {
  { Chip::is_identity(reply) } -> std::same_as<bool>;
};

/// A chip of 16-bit words, on SPI: as FrameChipEntry, with words.
template <class Chip>
concept WordChipEntry = ChipEntry<Chip> &&
    std::same_as<decltype(Chip::kAskIdentity), const std::uint16_t> &&
    requires(std::uint16_t reply) {
  { Chip::is_identity(reply) } -> std::same_as<bool>;
};

/// A chip whose reply to a question comes with the next one: frames or words.
template <class Chip>
concept LateChipEntry = FrameChipEntry<Chip> || WordChipEntry<Chip>;

/// Identity of such a chip. The same question twice asks once more, for nothing.
template <LateChipEntry Chip, class Bus>
[[nodiscard]] auto ask_identity(Bus& bus) {
  auto reply = bus.exchange(Chip::kAskIdentity);
  if (reply) reply = bus.exchange(Chip::kAskIdentity);
  return reply;
}

}  // namespace zerorate::drivers
