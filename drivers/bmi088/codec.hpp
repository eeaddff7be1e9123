/// @file
/// Meaning of the bits of the BMI088's gyro, as pure functions. Source: Bosch BST-BMI088-DS001;
/// README.md gives the source of each fact.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/bmi088/registers.hpp"

namespace zerorate::drivers::bmi088 {

/// Full scale; the values are the code of GYRO_RANGE.
enum class FullScale : std::uint8_t {
  dps_2000 = 0,
  dps_1000 = 1,
  dps_500 = 2,
  dps_250 = 3,
  dps_125 = 4,
};

/// Output data rate and the bandwidth of its filter; the values are the code of GYRO_BANDWIDTH.
enum class OutputDataRate : std::uint8_t {
  hz_2000_bandwidth_532 = 0,
  hz_2000_bandwidth_230 = 1,
  hz_1000_bandwidth_116 = 2,
  hz_400_bandwidth_47 = 3,
  hz_200_bandwidth_23 = 4,
  hz_100_bandwidth_12 = 5,
  hz_200_bandwidth_64 = 6,
  hz_100_bandwidth_32 = 7,
};

/// Full scale is 32767 LSB, where the chip clips (DS001, 5.5.2).
inline constexpr std::int16_t kFullScaleRaw = 32767;

/// The rate of one LSB: full scale by 32767 in the table of 5.5.2, by 32768 in the sensitivities of
/// table 3 (16.384 LSB/dps); the second, see README.md.
[[nodiscard]] constexpr core::AngularRate lsb(FullScale full_scale) {
  const unsigned code = static_cast<unsigned>(full_scale);
  return core::deg_per_s(2000.0F / static_cast<float>(32768U << code));
}

/// Full scale of the accelerometer; the values are the code of ACC_RANGE.
enum class AccelerationRange : std::uint8_t { g_3 = 0, g_6 = 1, g_12 = 2, g_24 = 3 };

/// The specific force of one LSB: full scale by 2^15 (DS001, 5.3.4; README.md).
[[nodiscard]] constexpr core::Acceleration acceleration_lsb(AccelerationRange range) {
  const unsigned code = static_cast<unsigned>(range);
  return core::standard_gravity(static_cast<float>(3U << code) / 32768.0F);
}

/// ACC_CONF: the accelerometer's rate next to the gyro's, with the normal filter.
[[nodiscard]] constexpr std::uint8_t encode_acc_conf(OutputDataRate rate) {
  // 100, 200, 400, 800 and 1600 Hz
  constexpr std::array<std::uint8_t, 8> kCodes{0xC, 0xC, 0xB, 0xA, 0x9, 0x8, 0x9, 0x8};
  return static_cast<std::uint8_t>(bits::kAccConfNormalFilter |
                                   kCodes[static_cast<std::size_t>(rate)]);
}

/// Frames in the accelerometer's FIFO by FIFO_LENGTH_0 and 1; 0 where it cannot hold so much, and
/// where it is empty, which is 8000h.
[[nodiscard]] constexpr std::size_t decode_acc_fifo_frames(std::uint8_t low, std::uint8_t high) {
  constexpr unsigned kCount = 0x3FFF;
  const unsigned bytes = ((high * 256U) | low) & kCount;
  return bytes > kAccFifoBytes ? 0U : bytes / kAccFifoFrameBytes;
}

/// True for the header of a frame of acceleration, whatever the levels of the interrupt pins.
[[nodiscard]] constexpr bool is_acceleration_header(std::uint8_t header) {
  return (header & 0xFCU) == 0x84;
}

/// FIFO_STATUS.
struct FifoStatus {
  std::uint8_t frames;  ///< frames that wait, at most 100
  bool is_overrun;      ///< frames were lost since the FIFO was cleared
  bool is_plausible;    ///< the FIFO can hold so much
};
[[nodiscard]] constexpr FifoStatus decode_fifo_status(std::uint8_t status) {
  const auto frames = static_cast<std::uint8_t>(status & bits::kFifoStatusFrames);
  return {frames, (status & bits::kFifoStatusOverrun) != 0, frames <= kFifoFrames};
}

/// FIFO_CONFIG_0: INT3 rises when the level exceeds it (DS001, 5.5.15).
/// @param frames  at which it is to rise
[[nodiscard]] constexpr std::uint8_t encode_watermark(std::uint8_t frames) {
  return frames == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(frames - 1);
}

/// Nominal; the chip has no trim register.
[[nodiscard]] constexpr core::Duration sample_period(OutputDataRate rate) {
  switch (rate) {
    case OutputDataRate::hz_2000_bandwidth_532:
    case OutputDataRate::hz_2000_bandwidth_230:
      return core::Duration::microseconds(500);
    case OutputDataRate::hz_1000_bandwidth_116:
      return core::Duration::milliseconds(1);
    case OutputDataRate::hz_400_bandwidth_47:
      return core::Duration::microseconds(2500);
    case OutputDataRate::hz_200_bandwidth_23:
    case OutputDataRate::hz_200_bandwidth_64:
      return core::Duration::milliseconds(5);
    case OutputDataRate::hz_100_bandwidth_12:
    case OutputDataRate::hz_100_bandwidth_32:
      break;
  }
  return core::Duration::milliseconds(10);
}

/// Time without access after a software reset.
inline constexpr core::Duration kResetTime = core::Duration::milliseconds(30);

/// Time from switching the accelerometer on to the next access, and from its activation to data.
inline constexpr core::Duration kAccPowerTime = core::Duration::milliseconds(5);
inline constexpr core::Duration kAccWakeTime = core::Duration::milliseconds(50);

/// Time after configuration until the output may be used: the start-up time of 30 ms, and ten
/// samples, which in every setting are longer than one period of the filter's corner frequency.
[[nodiscard]] constexpr core::Duration settling_time(core::Duration period) {
  return core::Duration::milliseconds(30) + period * 10;
}

}  // namespace zerorate::drivers::bmi088
