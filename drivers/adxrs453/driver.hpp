/// @file
/// Driver of Analog Devices' ADXRS453, a single-axis gyro for cars, over its SPI of 32-bit frames.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "drivers/adxrs453/codec.hpp"
#include "drivers/adxrs453/registers.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/frame_bus.hpp"
#include "drivers/common/gyro_source.hpp"

namespace zerorate::drivers {

namespace adxrs453 {

/// Chosen once, for the life of the driver. The chip has nothing to configure.
struct Settings {
  /// How often read() asks the chip. Longer than 6 ms folds noise of its 77.5 Hz bandwidth.
  core::Duration sample_period = core::Duration::milliseconds(5);
};

}  // namespace adxrs453

/// A GyroSource with one axis; its rate is given on all three. Bus is SpiFrames<...>, SPI mode 0,
/// up to 8.08 MHz.
///
/// The chip measures all the time and does not signal new samples: the driver takes one a sample
/// period. Every reply is checked for both parities, for the kind of its frame and for the chip's
/// own faults.
///
/// Not thread-safe, not for interrupts. No stack to speak of.
template <FrameBus Bus>
class Adxrs453 {
 public:
  static constexpr std::size_t kAxes = 1;

  constexpr explicit Adxrs453(Bus bus, adxrs453::Settings settings = {})
      : bus_(bus), settings_(settings) {}

  /// not_ready for 250 ms from the first call: 100 ms after power-on (assumed to be the first
  /// call), and 50 ms after each step of the chip's start-up check, which asserts all faults and
  /// takes them back. Then identity, serial number and fault register. sensor_fault if the check
  /// does not succeed. After any error a call begins anew.
  core::Result<void, DriverError> start(core::Instant now) {
    if (stage_ == Stage::off || stage_ == Stage::running) return wait(Stage::powering, now);
    const core::Duration needed =
        stage_ == Stage::powering ? adxrs453::kPowerOnTime : adxrs453::kCheckTime;
    if (now - stage_began_ < needed) return refuse_for_now();
    const Stage stage = stage_;
    stage_ = Stage::off;
    switch (stage) {
      case Stage::powering:
        return begin_check(now);
      case Stage::asserting:
        return ask_for_faults(now);
      case Stage::asserted:
        return see_faults(now);
      case Stage::released:
      case Stage::off:
      case Stage::running:
        break;
    }
    return finish_start(now);
  }

  /// Three transactions if a sample is due, none if not. A sample is due once a period; periods
  /// that were missed are gone. Errors: not_ready before start() succeeded; corrupt_data;
  /// sensor_fault.
  core::Result<std::size_t, DriverError> read(core::Instant now, std::span<GyroSample> out) {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, adxrs453::kRate1);
    }
    if (out.empty() || now < due_) return std::size_t{0};
    due_ = due_ + settings_.sample_period;
    if (due_ <= now) due_ = now + settings_.sample_period;
    return read_sample(now, out[0]);
  }

  /// Two transactions. Looks at the part's identity, its serial number and its fault register in
  /// turn: configuration_lost: another chip answers; sensor_fault: the chip failed.
  core::Result<void, DriverError> verify_next() {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, adxrs453::kPid1);
    }
    const Watched& watched = watched_[next_];
    const auto value = read_register(watched.address);
    if (!value) return core::Unexpected{value.error()};
    if ((*value & watched.mask) != watched.expected) {
      const bool is_fault = watched.address == adxrs453::kFault1;
      return refused(is_fault ? DriverErrorCode::sensor_fault : DriverErrorCode::configuration_lost,
                     watched.address);
    }
    next_ = (next_ + 1) % watched_.size();
    return {};
  }

  [[nodiscard]] constexpr core::Duration sample_period() const { return settings_.sample_period; }
  [[nodiscard]] constexpr core::AngularRate lsb() const { return adxrs453::kLsb; }
  [[nodiscard]] constexpr bool is_batched() const { return false; }

 private:
  /// powering: the supply may just have come; asserting: CHK was sent; asserted: the replies show
  /// faults; released: they must be gone.
  enum class Stage : std::uint8_t { off, powering, asserting, asserted, released, running };

  /// Bits of a register pair that must not change.
  struct Watched {
    std::uint8_t address;
    std::uint16_t mask;
    std::uint16_t expected;
  };

  static constexpr core::Unexpected<DriverError> refuse_for_now() {
    return refused(DriverErrorCode::not_ready, adxrs453::kPid1);
  }

  core::Result<void, DriverError> wait(Stage stage, core::Instant now) {
    stage_ = stage;
    stage_began_ = now;
    return refuse_for_now();
  }

  core::Result<void, DriverError> begin_check(core::Instant now) {
    if (const auto sent = send(adxrs453::kCheckCommand, adxrs453::kRate1); !sent) {
      return core::Unexpected{sent.error()};
    }
    return wait(Stage::asserting, now);
  }

  core::Result<void, DriverError> ask_for_faults(core::Instant now) {
    if (const auto sent = send(adxrs453::encode_sensor_data(0), adxrs453::kRate1); !sent) {
      return core::Unexpected{sent.error()};
    }
    return wait(Stage::asserted, now);
  }

  /// The replies to the last two commands.
  core::Result<void, DriverError> see_faults(core::Instant now) {
    for (int reply = 0; reply < 2; ++reply) {
      const auto got = send(adxrs453::encode_sensor_data(0), adxrs453::kRate1);
      if (!got) return core::Unexpected{got.error()};
      if (adxrs453::is_stuck(*got)) {
        return refused(DriverErrorCode::wrong_identity, adxrs453::kPid1);
      }
      if (!adxrs453::has_good_parity(*got)) {
        return refused(DriverErrorCode::corrupt_data, adxrs453::kRate1);
      }
      const adxrs453::SensorReply check = adxrs453::decode_sensor_reply(*got);
      if (check.status != adxrs453::Status::self_test || check.faults != adxrs453::kFaults) {
        return refused(DriverErrorCode::sensor_fault, adxrs453::kRate1);
      }
    }
    return wait(Stage::released, now);
  }

  core::Result<void, DriverError> finish_start(core::Instant now) {
    constexpr unsigned kHighByte = 8;
    const auto identity = read_register(adxrs453::kPid1);
    if (!identity) return core::Unexpected{identity.error()};
    if ((*identity >> kHighByte) != adxrs453::kPartId) {
      return refused(DriverErrorCode::wrong_identity, adxrs453::kPid1);
    }
    const auto faults = read_register(adxrs453::kFault1);
    if (!faults) return core::Unexpected{faults.error()};
    if ((*faults & adxrs453::kAllFaults) != 0) {
      return refused(DriverErrorCode::sensor_fault, adxrs453::kFault1);
    }
    const auto serial_high = read_register(adxrs453::kSn3);
    if (!serial_high) return core::Unexpected{serial_high.error()};
    const auto serial_low = read_register(adxrs453::kSn1);
    if (!serial_low) return core::Unexpected{serial_low.error()};
    constexpr std::uint16_t kAllBits = 0xFFFF;
    watched_ = {{{adxrs453::kPid1, kAllBits, *identity},
                 {adxrs453::kFault1, adxrs453::kAllFaults, 0},
                 {adxrs453::kSn3, kAllBits, *serial_high},
                 {adxrs453::kSn1, kAllBits, *serial_low}}};
    next_ = 0;
    due_ = now;
    stage_ = Stage::running;
    return {};
  }

  /// Sends a command; the reply is that to the command before.
  core::Result<std::uint32_t, DriverError> send(std::uint32_t command, std::uint8_t about) {
    const auto reply = bus_.exchange(command);
    if (!reply) return bus_failed(reply.error(), about);
    return *reply;
  }

  /// The command is sent twice: the second time only to fetch the reply to the first.
  core::Result<std::uint16_t, DriverError> read_register(std::uint8_t address) {
    const std::uint32_t command = adxrs453::encode_read(address);
    if (const auto sent = send(command, address); !sent) return core::Unexpected{sent.error()};
    return fetch_register(command, address);
  }

  core::Result<std::uint16_t, DriverError> fetch_register(std::uint32_t next_command,
                                                          std::uint8_t address) {
    const auto reply = send(next_command, address);
    if (!reply) return core::Unexpected{reply.error()};
    if (!adxrs453::has_good_parity(*reply) || !adxrs453::is_read_reply(*reply)) {
      return refused(DriverErrorCode::corrupt_data, address);
    }
    return adxrs453::decode_read_data(*reply);
  }

  core::Result<std::size_t, DriverError> read_sample(core::Instant now, GyroSample& out) {
    constexpr std::uint8_t kSequences = 8;
    sequence_ = static_cast<std::uint8_t>((sequence_ + 1) % kSequences);
    const std::uint32_t temperature = adxrs453::encode_read(adxrs453::kTem1);
    if (const auto sent = send(adxrs453::encode_sensor_data(sequence_), adxrs453::kRate1); !sent) {
      return core::Unexpected{sent.error()};
    }
    const auto reply = send(temperature, adxrs453::kRate1);
    if (!reply) return core::Unexpected{reply.error()};
    const auto raw = check_sensor_reply(*reply);
    if (!raw) return core::Unexpected{raw.error()};
    const auto tem = fetch_register(temperature, adxrs453::kTem1);
    if (!tem) return core::Unexpected{tem.error()};
    out.time = now;
    out.temperature = adxrs453::decode_temperature(*tem);
    out.has_temperature = true;
    set_rates(out, {*raw, *raw, *raw}, adxrs453::kLsb, adxrs453::kFullScaleRaw);
    return std::size_t{1};
  }

  [[nodiscard]] core::Result<std::int16_t, DriverError> check_sensor_reply(
      std::uint32_t reply) const {
    const adxrs453::SensorReply sensor = adxrs453::decode_sensor_reply(reply);
    const bool is_sensor_data = sensor.status != adxrs453::Status::register_access;
    if (!adxrs453::has_good_parity(reply) || !is_sensor_data || sensor.sequence != sequence_) {
      return refused(DriverErrorCode::corrupt_data, adxrs453::kRate1);
    }
    if (sensor.status != adxrs453::Status::valid || sensor.faults != 0) {
      return refused(DriverErrorCode::sensor_fault, adxrs453::kRate1);
    }
    return sensor.rate_raw;
  }

  Bus bus_;
  adxrs453::Settings settings_;
  core::Instant stage_began_;
  core::Instant due_;
  std::array<Watched, 4> watched_{};
  std::size_t next_ = 0;
  std::uint8_t sequence_ = 0;
  Stage stage_ = Stage::off;
};

}  // namespace zerorate::drivers
