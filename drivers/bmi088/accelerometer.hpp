/// @file
/// The accelerometer die of Bosch's BMI088, which has a bus address or a chip select, a clock and a
/// FIFO of its own.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "drivers/bmi088/codec.hpp"
#include "drivers/bmi088/registers.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/configuration_table.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/gyro_source.hpp"
#include "drivers/common/register_access.hpp"
#include "hal/contract/spi_device.hpp"

namespace zerorate::drivers::bmi088 {

/// Registers over SPI as the accelerometer has them (DS001, 6.1.2).
template <hal::SpiDevice Device>
using AccelerometerSpi = SpiRegistersWithDummy<Device>;

/// Buses of the two dies.
template <class GyroBus, class AccelerometerBus>
struct Buses {
  using Gyro = GyroBus;
  using Accelerometer = AccelerometerBus;
  Gyro gyro;
  Accelerometer accelerometer;
};

/// Register of an error that means the accelerometer's identity: both dies have theirs at 00h.
inline constexpr std::uint8_t kAccIdentityInErrors = 0x80;

/// Part of the driver: Bmi088 calls its steps and keeps the time between them.
template <RegisterBus Bus>
class AccelerometerDie {
 public:
  constexpr AccelerometerDie(Bus bus, OutputDataRate rate, AccelerationRange range)
      : bus_(bus),
        scale_{.lsb = acceleration_lsb(range)},
        configuration_{{{
            // A stuck line changes the ones or the zeros of the first register.
            configure(kAccConf, 0xFF, encode_acc_conf(rate)),
            configure(kAccRange, bits::kAccRangeRange, static_cast<std::uint8_t>(range)),
            configure(kAccFifoConfig0, bits::kAccFifoConfig0Mode, 0),
            configure(kAccFifoConfig1, bits::kAccFifoConfig1Sources, bits::kAccFifoConfig1AccEn),
            configure(kAccPwrConf, 0xFF, bits::kAccPwrConfActive),
            configure(kAccPwrCtrl, 0xFF, bits::kAccPwrCtrlOn),
        }}} {}

  core::Result<void, DriverError> reset() {
    const auto known = check_identity();
    return known ? write_register(bus_, kAccSoftreset, bits::kAccSoftresetCommand) : known;
  }
  /// After kResetTime.
  core::Result<void, DriverError> power_up() {
    const auto known = check_identity();
    return known ? write_register(bus_, kAccPwrCtrl, bits::kAccPwrCtrlOn) : known;
  }
  /// After kAccPowerTime.
  core::Result<void, DriverError> wake() {
    return write_register(bus_, kAccPwrConf, bits::kAccPwrConfActive);
  }
  /// After kAccWakeTime.
  core::Result<void, DriverError> finish() {
    const auto done = configuration_.apply(bus_);
    return done ? flush() : done;
  }
  /// Empties the FIFO.
  core::Result<void, DriverError> flush() {
    waiting_ = 0;
    buffered_ = 0;
    is_lost_ = false;
    return write_register(bus_, kAccSoftreset, bits::kAccFifoFlushCommand);
  }
  /// The table of the gyro, then that of this die, one entry a call.
  template <std::size_t N, RegisterBus GyroBus>
  core::Result<void, DriverError> verify_next(ConfigurationTable<N>& gyro, GyroBus& gyro_bus) {
    const auto held = verified_ < N ? gyro.verify_next(gyro_bus) : configuration_.verify_next(bus_);
    if (held) verified_ = (verified_ + 1) % (N + kEntries);
    return held;
  }

  /// The dies are not synchronised. Where the accelerometer was faster, its oldest frames are
  /// dropped; where it was slower, they are spread over the gyro's.
  /// @param gyro_frames  that wait
  core::Result<void, DriverError> begin_reading(std::size_t gyro_frames) {
    if (is_lost_) {
      if (const auto done = flush(); !done) return done;
    }
    std::array<std::uint8_t, 2> length{};
    if (const auto done = read_registers(bus_, kAccFifoLength0, length); !done) return done;
    waiting_ = decode_acc_fifo_frames(length[0], length[1]);
    available_ = waiting_ + buffered_;
    for (; available_ > gyro_frames; --available_) (void)take();
    gyro_frames_ = gyro_frames;
    seen_ = 0;
    return {};
  }

  /// For every frame of the gyro, in their order: gives the sample its acceleration, if there is
  /// one.
  void add_to(GyroSample& sample) {
    const std::size_t before = seen_ * available_ / gyro_frames_;
    ++seen_;
    if (seen_ * available_ / gyro_frames_ == before) return;
    const Frame frame = take();
    if (!is_acceleration_header(frame[0])) {
      is_lost_ = true;  // the place in the FIFO is unknown
      return;
    }
    set_acceleration(sample,
                     {decode_int16(frame[1], frame[2]), decode_int16(frame[3], frame[4]),
                      decode_int16(frame[5], frame[6])},
                     scale_);
  }

 private:
  static constexpr std::size_t kEntries = 6;
  static constexpr std::size_t kBurstFrames = 16;
  using Frame = std::array<std::uint8_t, kAccFifoFrameBytes>;

  /// The oldest frame; one without a header where there is none, or no longer a known place.
  Frame take() {
    Frame frame{};
    if (is_lost_ || (buffered_ == 0 && !fill())) return frame;
    const auto oldest = std::span{buffer_}.subspan(first_ * frame.size(), frame.size());
    std::ranges::copy(oldest, frame.begin());
    ++first_;
    --buffered_;
    return frame;
  }

  bool fill() {
    const std::size_t frames = std::min(waiting_, kBurstFrames);
    const auto used = std::span{buffer_}.first(frames * kAccFifoFrameBytes);
    if (frames == 0 || !read_registers(bus_, kAccFifoData, used)) return false;
    waiting_ -= frames;
    buffered_ = frames;
    first_ = 0;
    return true;
  }

  /// The first reading after power-on or a reset switches the die to SPI, and gives nothing.
  core::Result<void, DriverError> check_identity() {
    if (const auto dummy = read_register(bus_, kAccChipId); !dummy) {
      return core::Unexpected{dummy.error()};
    }
    const auto identity = read_register(bus_, kAccChipId);
    if (!identity) return core::Unexpected{identity.error()};
    if (*identity == kAccChipId.reset) return {};
    return refused(DriverErrorCode::wrong_identity, kAccIdentityInErrors);
  }

  Bus bus_;
  AccelerationScale scale_;
  ConfigurationTable<kEntries> configuration_;
  std::array<std::uint8_t, kBurstFrames * kAccFifoFrameBytes> buffer_{};
  std::size_t first_ = 0;        ///< frame of the buffer
  std::size_t buffered_ = 0;     ///< frames that were read and not taken
  std::size_t waiting_ = 0;      ///< frames in the chip
  std::size_t available_ = 0;    ///< for this reading
  std::size_t gyro_frames_ = 1;  ///< frames of the gyro in this reading
  std::size_t seen_ = 0;         ///< frames of the gyro until now
  std::size_t verified_ = 0;     ///< entries of both tables
  bool is_lost_ = false;
};

template <class Bus>
struct MaybeDie {
  using Type = NoMember;
};
template <RegisterBus Bus>
struct MaybeDie<Bus> {
  using Type = AccelerometerDie<Bus>;
};
/// The die on this bus; nothing where there is none.
template <class Bus>
using DieOn = typename MaybeDie<Bus>::Type;

}  // namespace zerorate::drivers::bmi088
