/// @file
/// The frames of firmware/wire/can_frames.hpp and can_protected.hpp as rows of a DBC file.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/wire/health_bits.hpp"

namespace zerorate::linux_node::dbc {

/// Signal in Intel order. Signals follow each other without gaps; those without a name are spare.
struct Signal {
  std::string_view name;
  unsigned bits;
  bool is_signed = false;
  std::string_view factor = "1";
  std::string_view unit;
  std::string_view lowest = "0";
  std::string_view highest = "1";
  bool can_be_absent = false;  ///< has a content for "not available"
  std::string_view comment;
  std::string_view values;  ///< names of its contents
};

struct Frame {
  std::string_view name;
  std::uint16_t offset;  ///< distance of its identifier from the sink's
  std::uint32_t cycle;   ///< messages of the sink from one frame to the next
  std::string_view comment;
  std::span<const Signal> signals;
  bool is_fd = false;
  bool is_protected = false;
};

/// Signals of several parts, one after the other.
template <std::size_t... Sizes>
constexpr auto joined(const std::array<Signal, Sizes>&... parts) {
  std::array<Signal, (Sizes + ...)> all{};
  auto end = all.begin();
  ((end = std::copy(parts.begin(), parts.end(), end)), ...);
  return all;
}

constexpr Signal flag(std::string_view name, std::string_view comment = "") {
  return {.name = name, .bits = 1, .comment = comment};
}
constexpr Signal spare(unsigned bits) {
  return {.name = "", .bits = bits};
}
constexpr Signal kCounter{
    .name = "Counter",
    .bits = 4,
    .highest = "15",
    .comment = "Counts this frame modulo 16; the axes and the status of one sample have the same."};
constexpr Signal kMotion{.name = "Motion",
                         .bits = 2,
                         .highest = "2",
                         .values = "0 \"moving\" 1 \"settling\" 2 \"still\""};

constexpr Signal rate_32(std::string_view name) {
  return {.name = name,
          .bits = 32,
          .is_signed = true,
          .factor = "1E-06",
          .unit = "deg/s",
          .lowest = "-2147",
          .highest = "2147",
          .can_be_absent = true,
          .comment = "Measured rate less bias."};
}
constexpr Signal bias_28(std::string_view name) {
  return {.name = name,
          .bits = 28,
          .is_signed = true,
          .factor = "1E-06",
          .unit = "deg/s",
          .lowest = "-134",
          .highest = "134",
          .can_be_absent = true};
}
constexpr Signal sigma_16(std::string_view name) {
  return {.name = name,
          .bits = 16,
          .factor = "1E-05",
          .unit = "deg/s",
          .highest = "0.65533",
          .can_be_absent = true,
          .comment = "Standard deviation of the bias."};
}
constexpr Signal turn_28(std::string_view name) {
  return {.name = name,
          .bits = 28,
          .is_signed = true,
          .factor = "0.001",
          .unit = "deg",
          .lowest = "-134217",
          .highest = "134217",
          .can_be_absent = true};
}
constexpr Signal turn_sigma(std::string_view name) {
  return {.name = name,
          .bits = 16,
          .factor = "0.001",
          .unit = "deg",
          .highest = "65.533",
          .can_be_absent = true,
          .comment = "Standard deviation, where it is known and not larger."};
}
constexpr Signal turn_time(std::string_view name) {
  return {.name = name,
          .bits = 16,
          .unit = "s",
          .highest = "65535",
          .comment = "Time since departure; 65535 for longer."};
}
constexpr Signal up_16(std::string_view name) {
  return {.name = name,
          .bits = 16,
          .is_signed = true,
          .factor = "0.0001",
          .lowest = "-1",
          .highest = "1"};
}
constexpr Signal acceleration_15(std::string_view name) {
  return {.name = name,
          .bits = 15,
          .is_signed = true,
          .factor = "0.01",
          .unit = "m/s^2",
          .lowest = "-163.82",
          .highest = "163.82",
          .can_be_absent = true};
}
constexpr Signal share_16(std::string_view name) {
  return {.name = name,
          .bits = 16,
          .is_signed = true,
          .factor = "0.0001",
          .unit = "deg/s",
          .lowest = "-3.2766",
          .highest = "3.2766",
          .can_be_absent = true};
}
constexpr Signal rate_28(std::string_view name) {
  return {.name = name,
          .bits = 28,
          .is_signed = true,
          .factor = "2E-05",
          .unit = "deg/s",
          .lowest = "-2684",
          .highest = "2684",
          .can_be_absent = true,
          .comment = "Measured rate less bias."};
}

constexpr Signal kOdometerDisagreement =
    flag("OdometerDisagreement", "Gyro and odometer cannot both be right: nothing is learnt.");
constexpr Signal kTemperatureMissing =
    flag("TemperatureMissing", "The sensor model follows the temperature, and there is none.");
constexpr Signal kDeadBand =
    flag("OdometerDeadBand", "The odometer is silent while the vehicle rolls slowly.");
constexpr Signal kSampleRateOff =
    flag("SampleRateOff", "Samples come at another rate than the nominal one: some are lost.");
constexpr Signal kReferenceDisagreement =
    flag("ReferenceDisagreement", "References of the heading and the gyro cannot both be right.");
constexpr Signal kAccelerationMissing =
    flag("AccelerationMissing", "The sensor model follows the acceleration, and there is none.");
/// The first eight flags of the health, in their order.
constexpr std::array kFirstFlags{
    flag("Calibrated", "A bias has been measured; without it rates are not corrected."),
    flag("SampleRefused"),
    flag("TimeRefused"),
    flag("Saturated", "An axis is at full scale: its rate is a lower bound."),
    flag("ModelInconsistent", "Innovations larger or smaller than the sensor model allows."),
    flag("OdometerFault", "The odometer input failed or dropped pulses."),
    flag("SensorFault", "The gyro gives no samples: rates are not available."),
    flag("MeasurementRejected", "The newest measurement at standstill was taken for a knock.")};

/// All flags, in the order of wire::kHealthBits.
constexpr auto kHealth =
    joined(kFirstFlags, std::array{kTemperatureMissing, kOdometerDisagreement, kDeadBand,
                                   kSampleRateOff, kReferenceDisagreement, kAccelerationMissing});
static_assert(kHealth.size() == wire::kHealthBits.size());

constexpr auto kStatus =
    joined(std::array{kMotion, kCounter, kTemperatureMissing, kOdometerDisagreement}, kFirstFlags,
           std::array{sigma_16("SigmaX"), sigma_16("SigmaY"), sigma_16("SigmaZ")});
constexpr std::array kX{rate_32("RateX"), bias_28("BiasX"), kCounter};
constexpr std::array kY{rate_32("RateY"), bias_28("BiasY"), kCounter};
constexpr std::array kZ{rate_32("RateZ"), bias_28("BiasZ"), kCounter};
constexpr std::array kInputs{
    Signal{.name = "Temperature",
           .bits = 16,
           .is_signed = true,
           .factor = "0.01",
           .unit = "degC",
           .lowest = "-327.66",
           .highest = "327.66",
           .can_be_absent = true},
    Signal{.name = "OdometerPulses",
           .bits = 32,
           .highest = "4294967295",
           .comment = "Pulses since the start of the node, modulo 2^32; valid where HasOdometer "
                      "is 1."},
    flag("HasOdometer"),
    kDeadBand,
    kSampleRateOff,
    kReferenceDisagreement,
    kAccelerationMissing,
    Signal{.name = "CalmPercent",
           .bits = 7,
           .unit = "%",
           .highest = "100",
           .can_be_absent = true,
           .comment = "Share of the newest stop that was calm."},
    kCounter};
constexpr std::array kTurnX{turn_28("TurnX"), turn_sigma("TurnSigmaX"), turn_time("TurnTimeX"),
                            kCounter};
constexpr std::array kTurnY{turn_28("TurnY"), turn_sigma("TurnSigmaY"), turn_time("TurnTimeY"),
                            kCounter};
constexpr std::array kTurnZ{turn_28("TurnZ"), turn_sigma("TurnSigmaZ"), turn_time("TurnTimeZ"),
                            kCounter};
constexpr std::array kTurnVertical{turn_28("TurnVertical"), turn_sigma("TurnSigmaVertical"),
                                   turn_time("TurnTimeVertical"), kCounter};
constexpr std::array kVertical{
    Signal{.name = "RateVertical",
           .bits = 28,
           .is_signed = true,
           .factor = "1E-05",
           .unit = "deg/s",
           .lowest = "-1342",
           .highest = "1342",
           .can_be_absent = true,
           .comment = "Counter-clockwise seen from above."},
    Signal{.name = "Heading",
           .bits = 16,
           .is_signed = true,
           .factor = "0.01",
           .unit = "deg",
           .lowest = "-180",
           .highest = "180",
           .can_be_absent = true,
           .comment = "By references and gyro; not available before the first reference."},
    turn_sigma("HeadingSigma"), kCounter};
constexpr std::array kUp{up_16("UpX"), up_16("UpY"), up_16("UpZ"), spare(12), kCounter};
constexpr std::array kAcceleration{
    acceleration_15("AccelerationX"), acceleration_15("AccelerationY"),
    acceleration_15("AccelerationZ"),
    Signal{.name = "Vibration",
           .bits = 15,
           .factor = "0.001",
           .unit = "m/s^2",
           .highest = "32.765",
           .can_be_absent = true,
           .comment = "Root mean square within the newest tick, over the three axes together."},
    kCounter};
constexpr std::array kExplainedX{share_16("ByTemperatureX"), share_16("ByAccelerationX"),
                                 share_16("ByVibrationX"), spare(12), kCounter};
constexpr std::array kExplainedY{share_16("ByTemperatureY"), share_16("ByAccelerationY"),
                                 share_16("ByVibrationY"), spare(12), kCounter};
constexpr std::array kExplainedZ{share_16("ByTemperatureZ"), share_16("ByAccelerationZ"),
                                 share_16("ByVibrationZ"), spare(12), kCounter};

constexpr Signal kCrc{.name = "Crc",
                      .bits = 8,
                      .highest = "255",
                      .comment = "E2E profile 11: CRC-8 0x1D over DataID and bytes 1 and up."};
constexpr Signal kE2eCounter{.name = "Counter",
                             .bits = 4,
                             .highest = "14",
                             .comment = "E2E profile 11: 0 to 14, one more for each frame."};
constexpr Signal kNibble{.name = "DataIdNibble",
                         .bits = 4,
                         .highest = "15",
                         .comment = "E2E profile 11: bits 8 to 11 of the DataID in 11C, 0 in 11A."};
constexpr Signal kYawRate{
    .name = "YawRate",
    .bits = 24,
    .is_signed = true,
    .factor = "0.0001",
    .unit = "deg/s",
    .lowest = "-838",
    .highest = "838",
    .can_be_absent = true,
    .comment = "Corrected rate about the vertical, counter-clockwise seen from above."};
constexpr Signal kYawRateValid =
    flag("YawRateValid", "1: YawRate is there, corrected, and no lower bound.");
constexpr Signal kSigmaClass{
    .name = "SigmaClass",
    .bits = 4,
    .highest = "15",
    .comment =
        "Class k: the standard deviation of the yaw rate's bias is at most 0.0001 deg/s "
        "times 2^k; 15: larger or not known."};
constexpr auto kYaw = joined(
    std::array{kCrc, kE2eCounter, kNibble, kYawRate, kYawRateValid, kMotion, spare(1), kSigmaClass},
    kHealth, std::array{spare(2)});
constexpr auto kFd = joined(
    std::array{kCrc, kE2eCounter, kNibble}, kHealth,
    std::array{kMotion,
               flag("RatesValid", "1: the three rates are there, corrected, and no lower bounds."),
               kYawRateValid, spare(2), rate_28("RateX"), rate_28("RateY"), rate_28("RateZ"),
               sigma_16("SigmaX"), sigma_16("SigmaY"), sigma_16("SigmaZ"), kYawRate});

}  // namespace zerorate::linux_node::dbc
