/// @file
/// Settings of the ICM-20948, and the registers as the driver sets them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "drivers/common/configuration_table.hpp"
#include "drivers/icm20948/codec.hpp"
#include "drivers/icm20948/registers.hpp"

namespace zerorate::drivers::icm20948 {

enum class Mode : std::uint8_t {
  data_ready,  ///< each read() gives the latest sample; INT1 pulses when there is a new one
  fifo,        ///< the chip keeps 82 samples; INT1 pulses when it had to drop some
};

/// Chosen once, for the life of the driver.
struct Settings {
  FullScale full_scale = FullScale::dps_250;  ///< larger: coarser LSB, 7.6 mdps at 250 deg/s
  OutputDataRate rate = OutputDataRate::hz_125;
  Mode mode = Mode::data_ready;
};

inline constexpr std::size_t kGyroEntries = 15;
inline constexpr std::size_t kAccelerometerEntries = 4;

/// Table for the gyro.
/// @param is_spi  without it the chip would react to I2C patterns on the wires of SPI
constexpr std::array<ConfigurationEntry, kGyroEntries> configuration_of_gyro(
    const Settings& settings, bool is_spi, bool has_accelerometer) {
  namespace b = bits;
  const bool is_fifo = settings.mode == Mode::fifo;
  const auto gyro = static_cast<std::uint8_t>(encode_filter(settings.rate) |
                                              static_cast<unsigned>(settings.full_scale));
  const unsigned content = b::kFifoEn2Gyro | (has_accelerometer ? b::kFifoEn2Accel : 0U);
  const unsigned fifo_en = is_fifo ? b::kUserCtrlFifoEn : 0U;
  const unsigned interface = is_spi ? b::kUserCtrlI2cIfDis : 0U;
  return {{
      // A stuck line changes the ones or the zeros of this register.
      configure(kPwrMgmt1, 0xFF, b::kPwrMgmt1AutoClock),
      configure(kLpConfig, b::kLpConfigCycles, 0),
      configure(kPwrMgmt2, b::kPwrMgmt2Standby, has_accelerometer ? 0 : b::kPwrMgmt2AccelOff),
      configure(kGyroSmplrtDiv, 0xFF, static_cast<std::uint8_t>(settings.rate)),
      configure(kGyroConfig1, b::kGyroConfig1All, gyro),
      configure(kGyroConfig2, b::kGyroConfig2SelfTest, 0),
      configure(kIntPinCfg, b::kIntPinCfgAll, 0),
      configure(kIntEnable, b::kIntEnableAll, 0),
      configure(kIntEnable1, b::kRawDataRdy, is_fifo ? 0 : b::kRawDataRdy),
      configure(kIntEnable2, b::kFifos, is_fifo ? b::kFifos : 0),
      configure(kIntEnable3, b::kFifos, 0),
      configure(kFifoEn1, b::kFifoEn1All, 0),
      configure(kFifoMode, b::kFifos, 0),
      configure(kFifoEn2, b::kFifos, is_fifo ? static_cast<std::uint8_t>(content) : 0),
      configure(kUserCtrl, b::kUserCtrlAll, static_cast<std::uint8_t>(fifo_en | interface)),
  }};
}

/// Those of the accelerometer, at the rate of the gyro and at the same instants.
constexpr std::array<ConfigurationEntry, kAccelerometerEntries> configuration_of_accelerometer(
    const Settings& settings, AccelerationRange range) {
  const auto config =
      static_cast<std::uint8_t>(encode_filter(settings.rate) | static_cast<unsigned>(range));
  return {{
      configure(kOdrAlignEn, bits::kOdrAlignEn, bits::kOdrAlignEn),
      configure(kAccelSmplrtDiv1, bits::kAccelSmplrtDiv1All, 0),
      configure(kAccelSmplrtDiv2, 0xFF, static_cast<std::uint8_t>(settings.rate)),
      configure(kAccelConfig, bits::kAccelConfigAll, config),
  }};
}

}  // namespace zerorate::drivers::icm20948
