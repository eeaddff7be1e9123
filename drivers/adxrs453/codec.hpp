/// @file
/// Meaning of the ADXRS453's frames, as pure functions. Source: Analog Devices, ADXRS453 rev. B;
/// README.md gives the source of each fact.
#pragma once

#include <bit>
#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/adxrs453/registers.hpp"

namespace zerorate::drivers::adxrs453 {

/// 80 LSB are one degree a second.
inline constexpr core::AngularRate kLsb = core::deg_per_s(1.0F / 80.0F);
/// 300 deg/s, the range of the specified accuracy; the chip counts on to 400.
inline constexpr std::int16_t kFullScaleRaw = 300 * 80;

/// ST1 and ST0 of a reply.
enum class Status : std::uint8_t {
  invalid = 0,    ///< the chip marks its own data as invalid
  valid = 1,      ///< sensor data
  self_test = 2,  ///< data while the self-test is asserted
  register_access = 3,
};

/// Sets the parity bit so that the number of ones is odd.
[[nodiscard]] constexpr std::uint32_t with_odd_parity(std::uint32_t command) {
  return std::popcount(command) % 2 == 1 ? command : command | kParity;
}

/// Asks for sensor data.
/// @param sequence 0 to 7, comes back in the reply; its bits are sent in the order 1, 0, 2
[[nodiscard]] constexpr std::uint32_t encode_sensor_data(std::uint8_t sequence) {
  const auto low_bits = static_cast<std::uint32_t>(sequence & 3U) << 30U;
  const auto high_bit = static_cast<std::uint32_t>((sequence >> 2U) & 1U) << 28U;
  return with_odd_parity(kSensorData | low_bits | high_bit);
}

/// Asks for sensor data and has the chip assert all its faults, to see that it can.
inline constexpr std::uint32_t kCheckCommand = with_odd_parity(kSensorData | kCheck);
static_assert(kCheckCommand == 0x2000'0003);

/// Asks for a register and the one after it.
[[nodiscard]] constexpr std::uint32_t encode_read(std::uint8_t address) {
  return with_odd_parity(kRead | (static_cast<std::uint32_t>(address) << kAddressShift));
}

/// P0 makes the upper half odd, P1 the whole.
[[nodiscard]] constexpr bool has_good_parity(std::uint32_t reply) {
  return std::popcount(reply >> 16U) % 2 == 1 && std::popcount(reply) % 2 == 1;
}

/// True for the output of a line without a chip.
[[nodiscard]] constexpr bool is_stuck(std::uint32_t reply) {
  return reply == 0 || reply == 0xFFFF'FFFF;
}

/// A reply to a command for sensor data.
struct SensorReply {
  std::uint8_t sequence;
  Status status;
  std::int16_t rate_raw;
  std::uint8_t faults;  ///< kFaults
};
[[nodiscard]] constexpr SensorReply decode_sensor_reply(std::uint32_t reply) {
  return {static_cast<std::uint8_t>(reply >> kSequenceShift),
          static_cast<Status>((reply >> kStatusShift) & 3U),
          static_cast<std::int16_t>(static_cast<std::uint16_t>((reply >> kRateShift) & 0xFFFFU)),
          static_cast<std::uint8_t>(reply & kFaults)};
}

/// True of the reply to a read; false of sensor data and of the chip's report of a bad command.
[[nodiscard]] constexpr bool is_read_reply(std::uint32_t reply) {
  return (reply & kReadReplyMask) == kReadReply;
}
[[nodiscard]] constexpr std::uint16_t decode_read_data(std::uint32_t reply) {
  return static_cast<std::uint16_t>((reply >> kReadDataShift) & 0xFFFFU);
}

/// TEM1 and TEM0: ten bits at the top, 5 LSB a degree, 0 at 45 degC.
[[nodiscard]] constexpr core::Temperature decode_temperature(std::uint16_t tem) {
  const int counts = static_cast<std::int16_t>(tem) >> 6;
  return core::Temperature::from_degc(45.0F + 0.2F * static_cast<float>(counts));
}

/// From power-on to the first command, and between the commands of the start-up sequence.
inline constexpr core::Duration kPowerOnTime = core::Duration::milliseconds(100);
inline constexpr core::Duration kCheckTime = core::Duration::milliseconds(50);

}  // namespace zerorate::drivers::adxrs453
