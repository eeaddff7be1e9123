/// @file
/// Settings of the ICM-45686, and the registers as the driver sets them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/assert.hpp"
#include "drivers/common/configuration_table.hpp"
#include "drivers/common/packet_gyro.hpp"
#include "drivers/icm45686/codec.hpp"
#include "drivers/icm45686/registers.hpp"

namespace zerorate::drivers::icm45686 {

enum class Mode : std::uint8_t {
  data_ready,  ///< each read() gives the latest sample; INT1 pulses when there is a new one
  fifo,        ///< the chip keeps up to 255 samples; INT1 pulses from the watermark on
};

/// Chosen once, for the life of the driver.
struct Settings {
  FullScale full_scale = FullScale::dps_250;  ///< larger: coarser LSB, 7.6 mdps at 250 deg/s
  OutputDataRate rate = OutputDataRate::hz_100;
  Mode mode = Mode::data_ready;
  std::uint8_t fifo_watermark = 8;  ///< samples that raise INT1; larger: fewer, longer bursts
};

inline constexpr std::size_t kAsleepEntries = 10;
inline constexpr std::size_t kAwakeEntries = 4;

/// Registers that are set before the sensors run. The gyro is switched on by the last entry, and
/// the rate, the range and the watermark's low byte come before what goes with them.
template <bool kHasAccelerometer>
constexpr std::array<ConfigurationEntry, kAsleepEntries> configuration_asleep(
    const Settings& settings) {
  namespace b = bits;
  const bool is_fifo = settings.mode == Mode::fifo;
  if constexpr (kHasAccelerometer) {
    ZERORATE_ASSERT(settings.fifo_watermark < kFifoBytes / kLongPacketBytes);
  }
  constexpr std::uint8_t kPower =
      b::kPwrMgmt0GyroLowNoise | (kHasAccelerometer ? b::kPwrMgmt0AccelLowNoise : 0U);
  // INT1_STATUS0 shows what is enabled here.
  const std::uint8_t interrupts = is_fifo ? b::kInt1FifoThs | b::kInt1FifoFull : b::kInt1Drdy;
  return {{
      configure(kDriveConfig0, b::kDriveConfig0SpiSlew, b::kDriveConfig0SpiSlew10ns),
      configure(kInt1Config2, b::kInt1Config2All, b::kInt1Config2ActiveHigh),
      configure(kInt1Config0, 0xFF, interrupts),
      // Its one shows a line that is stuck.
      configure(kFifoConfig2, b::kFifoConfig2WmGtTh, b::kFifoConfig2WmGtTh),
      configure(kFifoConfig1Low, 0xFF, is_fifo ? settings.fifo_watermark : std::uint8_t{0}),
      // Takes both bytes over.
      configure(kFifoConfig1High, 0xFF, 0),
      // Packets of both sensors have the time in them, which nobody reads.
      configure(kFifoConfig4, b::kFifoConfig4Content,
                is_fifo && kHasAccelerometer ? b::kFifoConfig4TmstEn : std::uint8_t{0}),
      configure(kGyroConfig0, 0xFF, encode_gyro_config0(settings.rate, settings.full_scale)),
      configure(kSregCtrl, b::kSregCtrlBigEndian, 0),
      configure(kPwrMgmt0, b::kPwrMgmt0Modes, kPower),
  }};
}

/// Registers that are set while they run: the filters have no clock before. The FIFO is opened
/// last.
template <bool kHasAccelerometer>
constexpr std::array<ConfigurationEntry, kAwakeEntries> configuration_awake(
    const Settings& settings) {
  namespace b = bits;
  const bool is_fifo = settings.mode == Mode::fifo;
  constexpr std::uint8_t kContent = b::kFifoConfig3IfEn | b::kFifoConfig3GyroEn |
                                    (kHasAccelerometer ? b::kFifoConfig3AccelEn : 0U);
  constexpr std::uint8_t kTime = kHasAccelerometer ? b::kSmcControl0TmstEn : 0U;
  const std::uint8_t mode = is_fifo ? b::kFifoModeStopOnFull : std::uint8_t{0};
  return {{
      // A quarter of the output rate: what is above half of it would fold into the white noise.
      configure(kGyroUiLpf, b::kUiLpf, b::kUiLpfQuarter),
      configure(kSmcControl0, b::kSmcControl0TmstEn | b::kSmcControl0TempDis,
                is_fifo ? kTime : std::uint8_t{0}),
      configure(kFifoConfig0, 0xFF, static_cast<std::uint8_t>(mode | b::kFifoDepth2k)),
      configure(kFifoConfig3, b::kFifoConfig3All, is_fifo ? kContent : std::uint8_t{0}),
  }};
}

/// All of it, with the accelerometer at the gyro's rate where it is read.
template <bool kHasAccelerometer>
constexpr auto configuration(const Settings& settings, AccelerationRange range) {
  const auto asleep = configuration_asleep<kHasAccelerometer>(settings);
  const auto awake = configuration_awake<kHasAccelerometer>(settings);
  if constexpr (kHasAccelerometer) {
    const std::array rate{configure(kAccelConfig0, bits::kAccelConfig0All,
                                    encode_accel_config0(settings.rate, range))};
    const std::array filter{configure(kAccelUiLpf, bits::kUiLpf, bits::kUiLpfQuarter)};
    return followed_by(joined(asleep, rate), joined(awake, filter));
  } else {
    return followed_by(asleep, awake);
  }
}

}  // namespace zerorate::drivers::icm45686
