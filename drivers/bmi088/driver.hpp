/// @file
/// Driver of the gyro, and on demand of the accelerometer, in Bosch's BMI088, over SPI or I2C.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "drivers/bmi088/accelerometer.hpp"
#include "drivers/bmi088/codec.hpp"
#include "drivers/bmi088/registers.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/configuration_table.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/fifo_drain.hpp"
#include "drivers/common/gyro_source.hpp"
#include "drivers/common/register_access.hpp"
#include "drivers/common/sample_clock.hpp"

namespace zerorate::drivers {

namespace bmi088 {

/// Samples come through the FIFO in both modes: the chip's data-ready flag falls by itself after
/// 0.3 ms (DS001, 5.5.3), so polling it would miss samples.
enum class Mode : std::uint8_t {
  data_ready,  ///< INT3 rises at each sample, whose edge stamps it
  fifo,        ///< INT3 rises at the watermark
};

/// Chosen once, for the life of the driver.
struct Settings {
  FullScale full_scale = FullScale::dps_250;  ///< larger: coarser LSB, 7.6 mdps at 250 deg/s
  OutputDataRate rate = OutputDataRate::hz_100_bandwidth_32;
  Mode mode = Mode::data_ready;
  std::uint8_t fifo_watermark = 8;  ///< samples that raise INT3, at most 99
};

}  // namespace bmi088

/// A GyroSource without a thermometer: the chip's own belongs to its accelerometer. Bus is
/// SpiRegisters<...> or I2cRegisters<...>. SPI mode 0 or 3, up to 10 MHz.
///
/// Not thread-safe, not for interrupts. Cortex-M0+: about 0.5 KiB of stack in read(), without the
/// back end's.
/// @tparam AccelerometerBus  where samples carry the acceleration: the bus of its die, which
///         measures at the rate next to the gyro's, by a clock of its own
template <RegisterBus Bus, class AccelerometerBus = NoMember>
class Bmi088 {
 public:
  static constexpr bool kHasAccelerometer = RegisterBus<AccelerometerBus>;

  static constexpr std::size_t kAxes = 3;

  constexpr explicit Bmi088(Bus bus,
                            bmi088::Settings settings = {}) requires(!RegisterBus<AccelerometerBus>)
      : bus_(bus),
        settings_(settings),
        lsb_(bmi088::lsb(settings.full_scale)),
        configuration_(configuration(settings)) {}
  constexpr explicit Bmi088(
      const bmi088::Buses<Bus, AccelerometerBus>& buses, bmi088::Settings settings = {},
      bmi088::AccelerationRange range = bmi088::AccelerationRange::g_6) requires
      RegisterBus<AccelerometerBus> : bus_(buses.gyro),
                                      settings_(settings),
                                      lsb_(bmi088::lsb(settings.full_scale)),
                                      configuration_(configuration(settings)),
                                      accelerometer_(buses.accelerometer, settings.rate, range) {}

  /// First call: identity, then software reset, then always not_ready. Later calls: not_ready until
  /// 30 ms have passed, then identity, configuration (27 transactions) and success; with the
  /// accelerometer, 55 ms later. When it runs, or after any other error, a call begins anew.
  core::Result<void, DriverError> start(core::Instant now) {
    if constexpr (kHasAccelerometer) {
      return start_both(now);
    } else {
      const bool is_reset_pending = stage_ == Stage::resetting;
      if (is_reset_pending && now - reset_at_ < bmi088::kResetTime) {
        return refused(DriverErrorCode::not_ready, bmi088::kGyroSoftreset.address);
      }
      stage_ = Stage::off;
      if (const auto known = check_identity(); !known) return known;
      return is_reset_pending ? finish_start(now) : begin_reset(now);
    }
  }

  /// One transaction if there is no sample; else three, and one more for every 16 samples
  /// beyond 16. Samples of the first 30 ms and more after power-up are dropped (README). Errors:
  /// not_ready before start() succeeded; fifo_overrun once for each gap, with all that was in the
  /// FIFO; corrupt_data.
  core::Result<std::size_t, DriverError> read(core::Instant now, std::span<GyroSample> out) {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, bmi088::kGyroLpm1.address);
    }
    if (out.empty()) return std::size_t{0};
    const auto frames = read_fifo_level();
    if (!frames) return core::Unexpected{frames.error()};
    if (*frames == 0) return std::size_t{0};
    if constexpr (kHasAccelerometer) {
      if (const auto begun = accelerometer_.begin_reading(*frames); !begun) {
        return core::Unexpected{begun.error()};
      }
    }
    if (!is_batched()) sample_clock_.lose_count();  // each sample has an edge: nothing to count on
    sample_clock_.begin_batch(now, *frames);
    const auto count = unless_stuck(drain(*frames, out));
    // The place in the FIFO is unknown after a burst that broke off: begin at a frame's start.
    if (!count) static_cast<void>(clear_fifo());
    return count;
  }

  /// One transaction. Does not stop the driver: whether to start again is the application's choice.
  core::Result<void, DriverError> verify_next() {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, bmi088::kGyroLpm1.address);
    }
    if constexpr (kHasAccelerometer) {
      return accelerometer_.verify_next(configuration_, bus_);
    } else {
      return configuration_.verify_next(bus_);
    }
  }

  /// Nominal: the chip has no trim register.
  [[nodiscard]] constexpr core::Duration sample_period() const {
    return bmi088::sample_period(settings_.rate);
  }
  [[nodiscard]] constexpr core::AngularRate lsb() const { return lsb_; }
  [[nodiscard]] constexpr bool is_batched() const { return settings_.mode == bmi088::Mode::fifo; }

 private:
  enum class Stage : std::uint8_t { off, resetting, powering, waking, running };
  static constexpr std::size_t kEntries = 9;
  static constexpr std::size_t kFrameBytes = bmi088::kFifoFrameBytes;

  static constexpr ConfigurationTable<kEntries> configuration(const bmi088::Settings& settings) {
    using namespace bmi088;
    namespace b = bmi088::bits;
    const bool is_fifo = settings.mode == Mode::fifo;
    return ConfigurationTable<kEntries>{{{
        // A stuck line changes the ones or the zeros of the first two registers.
        configure(kFifoWmEnable, b::kFifoWmEnableBoth, is_fifo ? b::kFifoWmOn : b::kFifoWmOff),
        configure(kGyroLpm1, b::kGyroLpm1Suspend, 0),
        configure(kGyroRange, b::kGyroRangeRange, static_cast<std::uint8_t>(settings.full_scale)),
        configure(kGyroBandwidth, b::kGyroBandwidthBw, static_cast<std::uint8_t>(settings.rate)),
        configure(kInt3Int4IoConf, b::kIoConfInt3, b::kIoConfInt3ActiveHigh),
        configure(kInt3Int4IoMap, b::kIoMapAll, is_fifo ? b::kIoMapInt3Fifo : b::kIoMapInt3Data),
        configure(kGyroIntCtrl, b::kIntCtrlBoth, is_fifo ? b::kIntCtrlFifoEn : b::kIntCtrlDataEn),
        configure(kFifoConfig0, 0xFF, encode_watermark(settings.fifo_watermark)),
        // Last: writing it clears the FIFO. It stops when it is full, because a chip in stream mode
        // that overran was seen to shift its axes by one (README).
        configure(kFifoConfig1, b::kFifoConfig1Mode, b::kFifoModeStopOnFull),
    }}};
  }

  core::Result<void, DriverError> check_identity() {
    const auto identity = read_register(bus_, bmi088::kGyroChipId);
    if (!identity) return core::Unexpected{identity.error()};
    if (*identity != bmi088::kGyroChipId.reset) {
      return refused(DriverErrorCode::wrong_identity, bmi088::kGyroChipId.address);
    }
    return {};
  }

  /// Steps of the accelerometer's start, with the gyro's in the first and the last.
  core::Result<void, DriverError> start_both(core::Instant now) {
    const Stage stage = stage_;
    if (is_waiting(now)) return refused(DriverErrorCode::not_ready, bmi088::kAccPwrCtrl.address);
    stage_ = Stage::off;
    if (stage == Stage::resetting)
      return next_stage(accelerometer_.power_up(), now, Stage::powering);
    if (stage == Stage::powering) return next_stage(accelerometer_.wake(), now, Stage::waking);
    auto done = check_identity();
    if (done && stage == Stage::waking) done = accelerometer_.finish();
    if (done && stage == Stage::waking) return finish_start(now);
    if (done) done = accelerometer_.reset();
    return done ? begin_reset(now) : done;
  }

  [[nodiscard]] bool is_waiting(core::Instant now) const {
    const core::Duration passed = now - reset_at_;
    return (stage_ == Stage::resetting && passed < bmi088::kResetTime) ||
           (stage_ == Stage::powering && passed < bmi088::kAccPowerTime) ||
           (stage_ == Stage::waking && passed < bmi088::kAccWakeTime);
  }

  core::Result<void, DriverError> next_stage(const core::Result<void, DriverError>& done,
                                             core::Instant now, Stage stage) {
    if (!done) return done;
    reset_at_ = now;
    stage_ = stage;
    return refused(DriverErrorCode::not_ready, bmi088::kAccPwrCtrl.address);
  }

  core::Result<void, DriverError> begin_reset(core::Instant now) {
    constexpr std::uint8_t kReset = bmi088::bits::kSoftresetCommand;
    if (const auto done = write_register(bus_, bmi088::kGyroSoftreset, kReset); !done) return done;
    reset_at_ = now;
    stage_ = Stage::resetting;
    return refused(DriverErrorCode::not_ready, bmi088::kGyroSoftreset.address);
  }

  core::Result<void, DriverError> finish_start(core::Instant now) {
    if (const auto done = configuration_.apply(bus_); !done) return done;
    settled_at_ = now + bmi088::settling_time(sample_period());
    sample_clock_.restart(now, sample_period());
    blank_frames_.restart();
    stage_ = Stage::running;
    return {};
  }

  core::Result<void, DriverError> clear_fifo() {
    sample_clock_.lose_count();
    if constexpr (kHasAccelerometer) {
      if (const auto done = accelerometer_.flush(); !done) return done;
    }
    return write_register(bus_, bmi088::kFifoConfig1, bmi088::bits::kFifoModeStopOnFull);
  }

  core::Result<std::uint8_t, DriverError> read_fifo_level() {
    const auto byte = read_register(bus_, bmi088::kFifoStatus);
    if (!byte) return core::Unexpected{byte.error()};
    const bmi088::FifoStatus status = bmi088::decode_fifo_status(*byte);
    if (!status.is_plausible) {
      return refused(DriverErrorCode::corrupt_data, bmi088::kFifoStatus.address);
    }
    if (status.is_overrun) {
      // The flag falls only when the FIFO is cleared. The time at which the FIFO stopped is
      // unknown, and so are the times of its samples.
      if (const auto done = clear_fifo(); !done) return core::Unexpected{done.error()};
      return refused(DriverErrorCode::fifo_overrun, bmi088::kFifoStatus.address);
    }
    return status.frames;
  }

  core::Result<std::size_t, DriverError> drain(std::size_t frames, std::span<GyroSample> out) {
    blank_frames_.begin_reading();
    const auto decode = [&](std::span<const std::uint8_t, kFrameBytes> bytes, GyroSample& sample) {
      const core::Instant time = sample_clock_.next();
      const std::array raw{decode_int16(bytes[0], bytes[1]), decode_int16(bytes[2], bytes[3]),
                           decode_int16(bytes[4], bytes[5])};
      [[maybe_unused]] GyroSample with_acceleration{.time = time};
      if constexpr (kHasAccelerometer) accelerometer_.add_to(with_acceleration);
      if (blank_frames_.is_blank(raw) || time < settled_at_) return Frame::no_sample;
      if constexpr (kHasAccelerometer) {
        sample = with_acceleration;
      } else {
        sample = GyroSample{.time = time};
      }
      set_rates(sample, raw, lsb_, bmi088::kFullScaleRaw);
      return Frame::sample;
    };
    return drain_fifo<kFrameBytes>(bus_, bmi088::kFifoData, frames, out, decode);
  }

  /// Frames carry no mark. The output of a line that got stuck after the level is no sample.
  core::Result<std::size_t, DriverError> unless_stuck(
      core::Result<std::size_t, DriverError> count) {
    if (!count) return count;
    const auto known = check_identity();
    if (known) return count;
    if (known.error().code == DriverErrorCode::wrong_identity) {
      return refused(DriverErrorCode::corrupt_data, bmi088::kFifoData.address);
    }
    return core::Unexpected{known.error()};
  }

  Bus bus_;
  bmi088::Settings settings_;
  core::AngularRate lsb_;
  ConfigurationTable<kEntries> configuration_;
  SampleClock sample_clock_;
  BlankFrames blank_frames_;
  core::Instant reset_at_;
  core::Instant settled_at_;
  Stage stage_ = Stage::off;
  [[no_unique_address]] bmi088::DieOn<AccelerometerBus> accelerometer_;
};

}  // namespace zerorate::drivers
