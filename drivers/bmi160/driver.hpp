/// @file
/// Driver of the gyro, and on demand of the accelerometer, in Bosch's BMI160, over SPI or I2C,
/// polled by data-ready or through the FIFO.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/assert.hpp"
#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "drivers/bmi160/codec.hpp"
#include "drivers/bmi160/registers.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/configuration_table.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/fifo_drain.hpp"
#include "drivers/common/fifo_level.hpp"
#include "drivers/common/gyro_source.hpp"
#include "drivers/common/register_access.hpp"
#include "drivers/common/sample_clock.hpp"

namespace zerorate::drivers {

namespace bmi160 {

enum class Mode : std::uint8_t {
  data_ready,  ///< each read() gives the latest sample; INT1 pulses when there is a new one
  fifo,        ///< the chip keeps 167 samples; INT1 rises at the watermark
};

/// Chosen once, for the life of the driver.
struct Settings {
  FullScale full_scale = FullScale::dps_250;  ///< larger: coarser LSB, 7.6 mdps at 250 deg/s
  OutputDataRate rate = OutputDataRate::hz_100;
  Mode mode = Mode::data_ready;
  std::uint8_t fifo_watermark = 8;  ///< samples that raise INT1, at most 80
};

}  // namespace bmi160

/// A GyroSource. Bus is SpiRegisters<...> or I2cRegisters<...>. SPI mode 0 or 3, up to 10 MHz.
///
/// Not thread-safe, not for interrupts. Cortex-M0+: about 0.5 KiB of stack in read(), without the
/// back end's.
/// @tparam kAccelerometer  whether samples carry the acceleration, which is measured at the gyro's
///         rate. A sample of the FIFO takes twelve bytes then, not six: half as many fit.
template <RegisterBus Bus, Accelerometer kAccelerometer = Accelerometer::off>
class Bmi160 {
 public:
  static constexpr bool kHasAccelerometer = kAccelerometer == Accelerometer::on;

  static constexpr std::size_t kAxes = 3;

  constexpr explicit Bmi160(Bus bus, bmi160::Settings settings = {})
      : Bmi160(settings, bmi160::AccelerationRange::g_4, bus) {}
  constexpr Bmi160(Bus bus, bmi160::Settings settings,
                   bmi160::AccelerationRange range) requires(kAccelerometer == Accelerometer::on)
      : Bmi160(settings, range, bus) {}

  /// First call: identity, then software reset, then always not_ready. Later calls: not_ready until
  /// 10 ms have passed; then the sensors are switched on, for which another 85 ms pass (with the
  /// accelerometer 5 ms more); then their state, configuration (27 transactions) and success. When
  /// it runs, or after any other error, a call begins anew.
  core::Result<void, DriverError> start(core::Instant now) {
    const Stage stage = stage_;
    if (is_waiting(now)) return refused(DriverErrorCode::not_ready, bmi160::kPmuStatus.address);
    stage_ = Stage::off;
    if (const auto known = check_identity(); !known) return known;
    switch (stage) {
      case Stage::resetting:
        return kHasAccelerometer ? command(bmi160::kCmdAccNormal, now, Stage::accelerometer)
                                 : command(bmi160::kCmdGyrNormal, now, Stage::gyro);
      case Stage::accelerometer:
        return command(bmi160::kCmdGyrNormal, now, Stage::gyro);
      case Stage::gyro:
        return finish_start(now);
      default:
        return command(bmi160::kCmdSoftReset, now, Stage::resetting);
    }
  }

  /// Data-ready mode: two transactions if there is a sample, one if not. FIFO mode: one if there is
  /// none, else three, and one more for every 16 samples beyond 16. Samples of the first 30 ms and
  /// more are dropped (README). Errors: not_ready before start() succeeded; fifo_overrun once for
  /// each gap, with all that was in the FIFO; corrupt_data.
  core::Result<std::size_t, DriverError> read(core::Instant now, std::span<GyroSample> out) {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, bmi160::kPmuStatus.address);
    }
    if (out.empty()) return std::size_t{0};
    return is_batched() ? read_fifo(now, out) : read_latest(now, out[0]);
  }

  /// One transaction. Does not stop the driver: whether to start again is the application's choice.
  core::Result<void, DriverError> verify_next() {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, bmi160::kPmuStatus.address);
    }
    return configuration_.verify_next(bus_);
  }

  /// Nominal: the chip has no trim register.
  [[nodiscard]] constexpr core::Duration sample_period() const {
    return bmi160::sample_period(settings_.rate);
  }
  [[nodiscard]] constexpr core::AngularRate lsb() const { return lsb_; }
  [[nodiscard]] constexpr bool is_batched() const { return settings_.mode == bmi160::Mode::fifo; }

 private:
  constexpr Bmi160(const bmi160::Settings& settings, bmi160::AccelerationRange range, Bus bus)
      : bus_(bus),
        settings_(settings),
        lsb_(bmi160::lsb(settings.full_scale)),
        configuration_(configuration(settings, range)),
        scale_(scale(range)) {}

  enum class Stage : std::uint8_t { off, resetting, accelerometer, gyro, running };
  static constexpr std::size_t kGyroEntries = 9;
  static constexpr std::size_t kEntries = kGyroEntries + (kHasAccelerometer ? 2 : 0);
  static constexpr std::size_t kFrameBytes =
      kHasAccelerometer ? bmi160::kLongFrameBytes : bmi160::kFifoFrameBytes;
  using Scale = MemberWith<kAccelerometer, AccelerationScale>;
  using AxesBytes = std::span<const std::uint8_t, 6>;

  static constexpr Scale scale(bmi160::AccelerationRange range) {
    if constexpr (kHasAccelerometer) {
      return {.lsb = bmi160::acceleration_lsb(range)};
    } else {
      return {};
    }
  }

  static constexpr ConfigurationTable<kEntries> configuration(const bmi160::Settings& settings,
                                                              bmi160::AccelerationRange range) {
    if constexpr (kHasAccelerometer) {
      using namespace bmi160;
      const std::array accelerometer{
          configure(kAccConf, bits::kAccConfAll, encode_conf(settings.rate)),
          configure(kAccRange, bits::kAccRangeAll, static_cast<std::uint8_t>(range))};
      return ConfigurationTable<kEntries>{joined(entries(settings), accelerometer)};
    } else {
      return ConfigurationTable<kEntries>{entries(settings)};
    }
  }

  static constexpr std::array<ConfigurationEntry, kGyroEntries> entries(
      const bmi160::Settings& settings) {
    using namespace bmi160;
    namespace b = bmi160::bits;
    constexpr unsigned kMostFrames = 80;
    ZERORATE_ASSERT(settings.fifo_watermark <= kMostFrames);
    const bool is_fifo = settings.mode == Mode::fifo;
    constexpr std::uint8_t kContent =
        b::kFifoConfig1Gyr | (kHasAccelerometer ? b::kFifoConfig1Acc : 0U);
    return {{
        // A stuck line changes the ones or the zeros of this register.
        configure(kFifoDowns, 0xFF, b::kFifoDownsNone),
        configure(kGyrConf, b::kGyrConfAll, encode_conf(settings.rate)),
        configure(kGyrRange, b::kGyrRangeAll, static_cast<std::uint8_t>(settings.full_scale)),
        configure(kFifoConfig0, 0xFF, encode_watermark(settings.fifo_watermark, kFrameBytes)),
        configure(kIntEn1, b::kIntEn1All, is_fifo ? b::kIntEn1Watermark : b::kIntEn1Drdy),
        configure(kIntOutCtrl, b::kIntOutCtrlInt1, b::kIntOutCtrlActiveHigh),
        configure(kIntLatch, b::kIntLatchInt1, 0),
        configure(kIntMap1, b::kIntMap1Int1, is_fifo ? b::kIntMap1Watermark : b::kIntMap1Drdy),
        configure(kFifoConfig1, b::kFifoConfig1All, is_fifo ? kContent : std::uint8_t{0}),
    }};
  }

  [[nodiscard]] bool is_waiting(core::Instant now) const {
    const core::Duration passed = now - commanded_at_;
    return (stage_ == Stage::resetting && passed < bmi160::kResetTime) ||
           (stage_ == Stage::accelerometer && passed < bmi160::kAccStartUp) ||
           (stage_ == Stage::gyro && passed < bmi160::kGyrStartUp);
  }

  /// After power-on and after a reset the chip is on I2C until chip select rises once.
  core::Result<void, DriverError> check_identity() {
    if constexpr (kIsSpi<Bus>) {
      const auto woken = read_register(bus_, bmi160::kSpiCommTest);
      if (!woken) return core::Unexpected{woken.error()};
    }
    const auto identity = read_register(bus_, bmi160::kChipId);
    if (!identity) return core::Unexpected{identity.error()};
    if (*identity == bmi160::kChipId.reset) return {};
    return refused(DriverErrorCode::wrong_identity, bmi160::kChipId.address);
  }

  core::Result<void, DriverError> command(std::uint8_t code, core::Instant now, Stage stage) {
    if (const auto done = write_register(bus_, bmi160::kCmd, code); !done) return done;
    commanded_at_ = now;
    stage_ = stage;
    return refused(DriverErrorCode::not_ready, bmi160::kCmd.address);
  }

  core::Result<void, DriverError> finish_start(core::Instant now) {
    namespace b = bmi160::bits;
    constexpr std::uint8_t kOn =
        b::kPmuStatusGyrNormal | (kHasAccelerometer ? b::kPmuStatusAccNormal : 0U);
    const auto power = read_register(bus_, bmi160::kPmuStatus);
    if (!power) return core::Unexpected{power.error()};
    if ((*power & b::kPmuStatusBoth) != kOn) {
      return refused(DriverErrorCode::configuration_lost, bmi160::kPmuStatus.address);
    }
    if (const auto done = configuration_.apply(bus_); !done) return done;
    if (const auto done = flush(); !done) return done;
    settled_at_ = now + bmi160::settling_time(sample_period());
    sample_clock_.restart(now, sample_period());
    blank_frames_.restart();
    stage_ = Stage::running;
    return {};
  }

  core::Result<void, DriverError> flush() {
    sample_clock_.lose_count();
    return write_register(bus_, bmi160::kCmd, bmi160::kCmdFifoFlush);
  }

  core::Result<std::size_t, DriverError> read_latest(core::Instant now, GyroSample& out) {
    const auto status = read_register(bus_, bmi160::kStatus);
    if (!status) return core::Unexpected{status.error()};
    if ((*status & bmi160::bits::kStatusAlwaysZero) != 0) return corrupt(bmi160::kStatus.address);
    if ((*status & bmi160::bits::kStatusDrdyGyr) == 0) return std::size_t{0};
    // Gyro, accelerometer, sensor time, status, interrupts, temperature.
    std::array<std::uint8_t, 22> bytes{};
    if (const auto done = read_registers(bus_, bmi160::kGyrData, bytes); !done) {
      return core::Unexpected{done.error()};
    }
    constexpr std::size_t kStatusAt = bmi160::kStatus.address - bmi160::kGyrData.address;
    if (!bmi160::is_plausible(bytes[kStatusAt])) return corrupt(bmi160::kStatus.address);
    if (now < settled_at_) return std::size_t{0};
    const auto all = std::span<const std::uint8_t, 22>{bytes};
    out = make_sample(now, all.template first<6>(), decode_int16(bytes[20], bytes[21]));
    if constexpr (kHasAccelerometer) {
      const bool is_new = (*status & bmi160::bits::kStatusDrdyAcc) != 0;
      if (is_new) set_acceleration(out, raw_axes(all.template subspan<6, 6>()), scale_);
    }
    return std::size_t{1};
  }

  core::Result<std::size_t, DriverError> read_fifo(core::Instant now, std::span<GyroSample> out) {
    std::int16_t temperature = 0;
    const auto frames = read_fifo_level(temperature);
    if (!frames || *frames == 0) return frames;
    sample_clock_.begin_batch(now, *frames);
    blank_frames_.begin_reading();
    const auto decode = [&](std::span<const std::uint8_t, kFrameBytes> bytes, GyroSample& sample) {
      const core::Instant time = sample_clock_.next();
      const AxesBytes gyro = bytes.template first<6>();
      if (blank_frames_.is_blank(raw_axes(gyro)) || time < settled_at_) return Frame::no_sample;
      sample = make_sample(time, gyro, temperature);
      if constexpr (kHasAccelerometer) {
        set_acceleration(sample, raw_axes(bytes.template last<6>()), scale_);
      }
      return Frame::sample;
    };
    auto count = drain_fifo<kFrameBytes>(bus_, bmi160::kFifoData, *frames, out, decode);
    if (count) {
      if (const auto alive = check_line(); !alive) count = core::Unexpected{alive.error()};
    }
    // The place in the FIFO is unknown after a burst that broke off.
    if (!count) static_cast<void>(flush());
    return count;
  }

  /// Reads the level, and once more where bytes are left over: they may be a frame that is being
  /// written.
  core::Result<std::size_t, DriverError> read_fifo_level(std::int16_t& temperature) {
    FifoLevel level{};
    for (int attempt = 0; attempt < 2 && !level.is_whole; ++attempt) {
      std::array<std::uint8_t, 9> bytes{};  // status, interrupts, temperature, level
      if (const auto done = read_registers(bus_, bmi160::kStatus, bytes); !done) {
        return core::Unexpected{done.error()};
      }
      level = bmi160::decode_fifo_length(bytes[7], bytes[8], kFrameBytes);
      if (!bmi160::is_plausible(bytes[0]) || !level.is_plausible) {
        return corrupt(bmi160::kStatus.address);
      }
      temperature = decode_int16(bytes[5], bytes[6]);
    }
    if (!level.is_overrun && level.is_whole) return std::size_t{level.frames};
    if (const auto done = flush(); !done) return core::Unexpected{done.error()};
    return refused(DriverErrorCode::fifo_overrun, bmi160::kFifoData.address);
  }

  /// Frames carry no mark. The output of a line that got stuck in the middle of them is no sample.
  core::Result<void, DriverError> check_line() {
    const auto identity = read_register(bus_, bmi160::kChipId);
    if (!identity) return core::Unexpected{identity.error()};
    if (*identity == bmi160::kChipId.reset) return {};
    return corrupt(bmi160::kChipId.address);
  }

  static core::Unexpected<DriverError> corrupt(std::uint8_t address) {
    return refused(DriverErrorCode::corrupt_data, address);
  }

  static constexpr BlankFrames::Raw raw_axes(AxesBytes bytes) {
    return {decode_int16(bytes[0], bytes[1]), decode_int16(bytes[2], bytes[3]),
            decode_int16(bytes[4], bytes[5])};
  }

  [[nodiscard]] GyroSample make_sample(core::Instant time, AxesBytes bytes,
                                       std::int16_t temperature) const {
    constexpr std::int16_t kNone = -32768;
    GyroSample sample;
    sample.time = time;
    sample.has_temperature = temperature != kNone;
    if (sample.has_temperature) sample.temperature = bmi160::decode_temperature(temperature);
    set_rates(sample, raw_axes(bytes), lsb_, bmi160::kFullScaleRaw);
    return sample;
  }

  Bus bus_;
  bmi160::Settings settings_;
  core::AngularRate lsb_;
  ConfigurationTable<kEntries> configuration_;
  SampleClock sample_clock_;
  BlankFrames blank_frames_;
  core::Instant commanded_at_;
  core::Instant settled_at_;
  Stage stage_ = Stage::off;
  [[no_unique_address]] Scale scale_;
};

}  // namespace zerorate::drivers
