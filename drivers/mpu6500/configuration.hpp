/// @file
/// Settings of the MPU-6500 and its relatives, and the registers as the driver sets them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "drivers/common/configuration_table.hpp"
#include "drivers/mpu6500/codec.hpp"
#include "drivers/mpu6500/registers.hpp"

namespace zerorate::drivers::mpu6500 {

enum class Mode : std::uint8_t {
  data_ready,  ///< each read() gives the latest sample; INT pulses when there is a new one
  fifo,        ///< the chip keeps 82 samples and more; INT pulses when it had to drop some
};

/// Chosen once, for the life of the driver; a type for each part.
template <Part kPart>
struct SettingsOf {
  FullScale full_scale = FullScale::dps_250;  ///< larger: coarser LSB, 7.6 mdps at 250 deg/s
  OutputDataRate rate = OutputDataRate::hz_100;
  Mode mode = Mode::data_ready;
};
using Settings = SettingsOf<Part::mpu6500>;

/// Settings of any part.
struct Chosen {
  FullScale full_scale = FullScale::dps_250;
  OutputDataRate rate = OutputDataRate::hz_100;
  Mode mode = Mode::data_ready;
  Part part = Part::mpu6500;
};
template <Part kPart>
[[nodiscard]] constexpr Chosen chosen(const SettingsOf<kPart>& settings) {
  return {.full_scale = settings.full_scale,
          .rate = settings.rate,
          .mode = settings.mode,
          .part = kPart};
}

inline constexpr std::size_t kGyroEntries = 10;

/// Bit of USER_CTRL. Without it, or that of I2C_IF, the chip would react to I2C patterns on the
/// wires of SPI; over I2C it would switch the chip's bus off until its power is cut.
[[nodiscard]] constexpr std::uint8_t interface(const Variant& variant, bool is_spi) {
  return is_spi && !variant.is_younger ? bits::kUserCtrlI2cIfDis : std::uint8_t{0};
}

/// Table for the gyro. Where the chip does not have a register, the entry before it stands twice.
constexpr std::array<ConfigurationEntry, kGyroEntries> configuration_of_gyro(
    const Chosen& settings, const Variant& variant, bool is_spi, bool has_accelerometer) {
  namespace b = bits;
  const bool is_fifo = settings.mode == Mode::fifo;
  const unsigned fifo_en = is_fifo ? b::kUserCtrlFifoEn : 0U;
  const std::uint8_t standby = has_accelerometer ? std::uint8_t{0} : b::kPwrMgmt2AccelOff;
  const unsigned gyro = variant.is_younger ? b::kFifoEnGyroAndTemperature : b::kFifoEnGyro;
  const auto content = static_cast<std::uint8_t>(gyro | (has_accelerometer ? b::kFifoEnAccel : 0U));
  // The chip is woken first: asleep, it may not take the others. A stuck line changes ones or
  // zeros.
  const auto awake = configure(kPwrMgmt1, 0xFF, b::kPwrMgmt1Pll);
  const auto i2c = configure(kI2cIf, b::kI2cIfDis, is_spi ? b::kI2cIfDis : std::uint8_t{0});
  return {{
      awake,
      variant.is_younger ? i2c : awake,
      configure(kPwrMgmt2, b::kPwrMgmt2Standby, standby),
      configure(kConfig, b::kConfigAll, low_pass(settings.rate)),
      configure(kSmplrtDiv, 0xFF, static_cast<std::uint8_t>(settings.rate)),
      configure(kGyroConfig, b::kGyroConfigAll, static_cast<std::uint8_t>(settings.full_scale)),
      configure(kIntPinCfg, b::kIntPinCfgAll, 0),
      configure(kIntEnable, b::kIntEnableAll, is_fifo ? b::kIntFifoOflow : b::kIntDataRdy),
      configure(kFifoEn, 0xFF, is_fifo ? content : std::uint8_t{0}),
      configure(kUserCtrl, b::kUserCtrlAll,
                static_cast<std::uint8_t>(fifo_en | interface(variant, is_spi))),
  }};
}

}  // namespace zerorate::drivers::mpu6500
