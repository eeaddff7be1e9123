/// @file
/// Settings of the ICM-42688-P and its relatives, and the registers as the driver sets them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/assert.hpp"
#include "drivers/common/configuration_table.hpp"
#include "drivers/common/packet_gyro.hpp"
#include "drivers/icm42688/codec.hpp"
#include "drivers/icm42688/registers.hpp"

namespace zerorate::drivers::icm42688 {

enum class Mode : std::uint8_t {
  data_ready,  ///< each read() gives the latest sample; INT1 pulses when there is a new one
  fifo,        ///< the chip keeps up to 256 samples; INT1 pulses from the watermark on
};

/// Chosen once, for the life of the driver; a type for each part.
template <Part kPart>
struct SettingsOf {
  FullScale full_scale = FullScale::dps_250;  ///< larger: coarser LSB, 7.6 mdps at 250 deg/s
  OutputDataRate rate = OutputDataRate::hz_100;
  Mode mode = Mode::data_ready;
  std::uint8_t fifo_watermark = 8;  ///< samples that raise INT1; larger: fewer, longer bursts
};
using Settings = SettingsOf<Part::icm42688>;

/// Settings of any part.
struct Chosen {
  FullScale full_scale = FullScale::dps_250;
  OutputDataRate rate = OutputDataRate::hz_100;
  Mode mode = Mode::data_ready;
  std::uint8_t fifo_watermark = 0;
  Part part = Part::icm42688;
};
template <Part kPart>
[[nodiscard]] constexpr Chosen chosen(const SettingsOf<kPart>& settings) {
  return {.full_scale = settings.full_scale,
          .rate = settings.rate,
          .mode = settings.mode,
          .fifo_watermark = settings.fifo_watermark,
          .part = kPart};
}

/// Table for the gyro.
template <bool kHasAccelerometer>
constexpr std::array<ConfigurationEntry, 13> configuration_of_gyro(const Chosen& settings) {
  namespace b = bits;
  const bool is_fifo = settings.mode == Mode::fifo;
  constexpr unsigned kPacketBytes = kHasAccelerometer ? kLongPacketBytes : kShortPacketBytes;
  const unsigned watermark_bytes = settings.fifo_watermark * kPacketBytes;
  if constexpr (kHasAccelerometer) ZERORATE_ASSERT(watermark_bytes <= kFifoBytes);
  constexpr unsigned kSensors =
      b::kFifoConfig1GyroEn | (kHasAccelerometer ? b::kFifoConfig1AccelEn : 0U);
  constexpr std::uint8_t kFilters = b::kGyroUiFiltBw | (kHasAccelerometer ? b::kAccelUiFiltBw : 0U);
  constexpr std::uint8_t kPower =
      b::kPwrMgmt0GyroLowNoise | (kHasAccelerometer ? b::kPwrMgmt0AccelLowNoise : 0U);
  const std::uint8_t packet =
      is_fifo ? b::kFifoConfig1WmGtTh | b::kFifoConfig1TempEn | kSensors : std::uint8_t{0};
  return {{
      configure(kRegBankSel, b::kRegBankSelBank, 0),
      // Count in bytes, not held at the last value, big-endian. A stuck line changes the ones or
      // the zeros of this register.
      configure(kIntfConfig0, b::kIntfConfig0Data,
                b::kIntfConfig0FifoCountBigEndian | b::kIntfConfig0SensorDataBigEndian),
      // Adaptive full-scale off: with it, chips were seen to stall for 1 to 2 ms above 100 deg/s.
      configure(kIntfConfig1, b::kIntfConfig1Afsr, b::kIntfConfig1AfsrOff),
      configure(kIntConfig, b::kIntConfigInt1,
                b::kIntConfigInt1PushPull | b::kIntConfigInt1ActiveHigh),
      // The register's description: "For proper INT1 and INT2 pin operation".
      configure(kIntConfig1, b::kIntConfig1AsyncReset, 0),
      configure(kIntSource0, b::kIntSource0All,
                is_fifo ? b::kIntSource0FifoThs : b::kIntSource0UiDrdy),
      // Half the output rate: what is above it would fold into the white noise.
      configure(kGyroAccelConfig0, kFilters, 0),
      configure(kFifoConfig1, b::kFifoConfig1All, packet),
      configure(kFifoConfig2, 0xFF, static_cast<std::uint8_t>(watermark_bytes & 0xFFU)),
      configure(kFifoConfig3, b::kFifoConfig3Wm, static_cast<std::uint8_t>(watermark_bytes >> 8U)),
      configure(kFifoConfig, b::kFifoConfigMode, is_fifo ? b::kFifoModeStream : std::uint8_t{0}),
      configure(kGyroConfig0, b::kGyroConfig0All,
                encode_gyro_config0(settings.rate, settings.full_scale)),
      // Last: for 200 us after it no register may be written. Temperature on.
      configure(kPwrMgmt0, b::kPwrMgmt0All, kPower),
  }};
}

/// Table for the gyro, and for the accelerometer at the gyro's rate.
template <bool kHasAccelerometer>
constexpr auto configuration(const Chosen& settings, AccelerationRange range) {
  if constexpr (kHasAccelerometer) {
    return joined(configuration_of_gyro<true>(settings),
                  std::array{configure(kAccelConfig0, bits::kAccelConfig0All,
                                       encode_accel_config0(settings.rate, range))});
  } else {
    return configuration_of_gyro<false>(settings);
  }
}

}  // namespace zerorate::drivers::icm42688
