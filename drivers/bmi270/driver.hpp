/// @file
/// Driver of the gyro, and on demand of the accelerometer, in Bosch's BMI270, over SPI or I2C,
/// polled by data-ready or through the FIFO.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/assert.hpp"
#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "drivers/bmi270/codec.hpp"
#include "drivers/bmi270/config_file_loader.hpp"
#include "drivers/bmi270/registers.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/configuration_table.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/fifo_drain.hpp"
#include "drivers/common/fifo_level.hpp"
#include "drivers/common/gyro_source.hpp"
#include "drivers/common/register_access.hpp"
#include "drivers/common/sample_clock.hpp"

namespace zerorate::drivers {

namespace bmi270 {

enum class Mode : std::uint8_t {
  data_ready,  ///< each read() gives the latest sample; INT1 pulses when there is a new one
  fifo,        ///< the chip keeps 338 samples; INT1 rises at the watermark
};

/// Chosen once, for the life of the driver.
struct Settings {
  FullScale full_scale = FullScale::dps_250;  ///< larger: coarser LSB, 7.6 mdps at 250 deg/s
  OutputDataRate rate = OutputDataRate::hz_100;
  Mode mode = Mode::data_ready;
  std::uint8_t fifo_watermark = 8;  ///< samples that raise INT1, at most 160
  /// Bosch's file for the chip (README). The bytes must outlive the driver.
  std::span<const std::uint8_t> config_file{};
};

}  // namespace bmi270

/// A GyroSource. Bus is SpiRegistersWithDummy<...> or I2cRegisters<...>. SPI mode 0 or 3, up to
/// 10 MHz.
///
/// Not thread-safe, not for interrupts. Cortex-M0+: about 0.5 KiB of stack in read(), without the
/// back end's.
/// @tparam kAccelerometer  whether samples carry the acceleration, which is measured at the gyro's
///         rate. A sample of the FIFO takes twelve bytes then, not six: half as many fit.
template <BurstBus Bus, Accelerometer kAccelerometer = Accelerometer::off>
class Bmi270 {
 public:
  static constexpr bool kHasAccelerometer = kAccelerometer == Accelerometer::on;

  static constexpr std::size_t kAxes = 3;

  constexpr explicit Bmi270(Bus bus, bmi270::Settings settings = {})
      : Bmi270(settings, bmi270::AccelerationRange::g_4, bus) {}
  constexpr Bmi270(Bus bus, bmi270::Settings settings,
                   bmi270::AccelerationRange range) requires(kAccelerometer == Accelerometer::on)
      : Bmi270(settings, range, bus) {}

  /// Without a file whose size can be right always no_config_file. First call: identity, then
  /// software reset, then always not_ready. Later calls: not_ready until 10 ms have passed; then
  /// the chip is woken, and 1 ms later each call loads 256 bytes of the file. The call behind the
  /// last of them ends the loading; 150 ms after it configuration (39 transactions) and success, or
  /// sensor_fault if the chip did not take the file. Over SPI one reading and 2 ms come before the
  /// identity, at first and after the reset: the chip is on I2C until then. When it runs, or after
  /// any other error, a call begins anew.
  core::Result<void, DriverError> start(core::Instant now) {
    if (!loader_.is_possible()) {
      return refused(DriverErrorCode::no_config_file, bmi270::kInitData.address);
    }
    const Stage stage = stage_;
    if (is_waiting(now)) return not_ready();
    stage_ = Stage::off;
    if (is_on_i2c(stage)) return select_spi(now, stage);
    if (const auto known = expect_identity(DriverErrorCode::wrong_identity); !known) return known;
    switch (stage) {
      case Stage::resetting:
      case Stage::on_spi_again:
        return wait_after(write_register(bus_, bmi270::kPwrConf, bmi270::bits::kPwrConfAwake), now,
                          Stage::waking);
      case Stage::waking:
        loader_.restart();
        return wait_after(write_register(bus_, bmi270::kInitCtrl, 0), now, Stage::loading);
      case Stage::loading:
        return load(now);
      case Stage::loaded:
        return finish_start(now);
      default:
        return wait_after(write_register(bus_, bmi270::kCmd, bmi270::kCmdSoftReset), now,
                          Stage::resetting);
    }
  }

  /// Data-ready mode: two transactions if there is a sample, one if not. FIFO mode: one if there is
  /// none, else three, and one more for every 16 samples beyond 16. Samples of the first 85 ms and
  /// more are dropped (README). Errors: not_ready before start() succeeded; fifo_overrun once for
  /// each gap, with all that was in the FIFO; corrupt_data.
  core::Result<std::size_t, DriverError> read(core::Instant now, std::span<GyroSample> out) {
    if (stage_ != Stage::running) return core::Unexpected{not_ready().error()};
    if (out.empty()) return std::size_t{0};
    return is_batched() ? read_fifo(now, out) : read_latest(now, out[0]);
  }

  /// One transaction. Does not stop the driver: whether to start again is the application's choice.
  core::Result<void, DriverError> verify_next() {
    if (stage_ != Stage::running) return core::Unexpected{not_ready().error()};
    return configuration_.verify_next(bus_);
  }

  /// Nominal: the chip has no trim register.
  [[nodiscard]] constexpr core::Duration sample_period() const {
    return bmi270::sample_period(settings_.rate);
  }
  [[nodiscard]] constexpr core::AngularRate lsb() const { return lsb_; }
  [[nodiscard]] constexpr bool is_batched() const { return settings_.mode == bmi270::Mode::fifo; }

 private:
  constexpr Bmi270(const bmi270::Settings& settings, bmi270::AccelerationRange range, Bus bus)
      : bus_(bus),
        settings_(settings),
        lsb_(bmi270::lsb(settings.full_scale)),
        loader_(settings.config_file),
        configuration_(configuration(settings, range)),
        scale_(scale(range)) {}

  enum class Stage : std::uint8_t {
    off,
    on_spi,
    resetting,
    on_spi_again,
    waking,
    loading,
    loaded,
    running,
  };
  static constexpr std::size_t kGyroEntries = 12;
  static constexpr std::size_t kEntries = kGyroEntries + (kHasAccelerometer ? 2 : 0);
  static constexpr std::size_t kFrameBytes =
      kHasAccelerometer ? bmi270::kLongFrameBytes : bmi270::kFifoFrameBytes;
  using Scale = MemberWith<kAccelerometer, AccelerationScale>;
  using AxesBytes = std::span<const std::uint8_t, 6>;

  static constexpr Scale scale(bmi270::AccelerationRange range) {
    if constexpr (kHasAccelerometer) {
      return {.lsb = bmi270::acceleration_lsb(range)};
    } else {
      return {};
    }
  }

  static constexpr ConfigurationTable<kEntries> configuration(const bmi270::Settings& settings,
                                                              bmi270::AccelerationRange range) {
    if constexpr (kHasAccelerometer) {
      using namespace bmi270;
      const std::array accelerometer{
          configure(kAccConf, bits::kAccConfAll,
                    static_cast<std::uint8_t>(bits::kAccConfNormal |
                                              static_cast<unsigned>(settings.rate))),
          configure(kAccRange, bits::kAccRangeAll, static_cast<std::uint8_t>(range))};
      return ConfigurationTable<kEntries>{joined(entries(settings), accelerometer)};
    } else {
      return ConfigurationTable<kEntries>{entries(settings)};
    }
  }

  static constexpr std::array<ConfigurationEntry, kGyroEntries> entries(
      const bmi270::Settings& settings) {
    using namespace bmi270;
    namespace b = bmi270::bits;
    constexpr unsigned kMostFrames = 160;
    ZERORATE_ASSERT(settings.fifo_watermark > 0 && settings.fifo_watermark <= kMostFrames);
    const bool is_fifo = settings.mode == Mode::fifo;
    // Reached with the last frame, whether the chip compares by "at least" or by "more than".
    const std::size_t level = settings.fifo_watermark * kFrameBytes - 1U;
    constexpr std::uint8_t kContent =
        b::kFifoConfig1Gyr | (kHasAccelerometer ? b::kFifoConfig1Acc : 0U);
    constexpr std::uint8_t kPower =
        b::kPwrCtrlGyr | b::kPwrCtrlTemp | (kHasAccelerometer ? b::kPwrCtrlAcc : 0U);
    return {{
        // A stuck line changes the ones or the zeros of this register.
        configure(kPwrConf, b::kPwrConfAll, b::kPwrConfAwake),
        configure(kFifoDowns, 0xFF, b::kFifoDownsNone),
        configure(
            kGyrConf, b::kGyrConfAll,
            static_cast<std::uint8_t>(b::kGyrConfNormal | static_cast<unsigned>(settings.rate))),
        configure(kGyrRange, b::kGyrRangeAll, encode_range(settings.full_scale)),
        configure(kFifoWtm0, 0xFF, static_cast<std::uint8_t>(level & 0xFFU)),
        configure(kFifoWtm1, b::kFifoWtm1All, static_cast<std::uint8_t>(level >> 8U)),
        configure(kFifoConfig0, b::kFifoConfig0All, 0),
        configure(kInt1IoCtrl, b::kInt1IoCtrlAll, b::kInt1IoCtrlActiveHigh),
        configure(kIntLatch, b::kIntLatchAll, 0),
        configure(kIntMapData, b::kIntMapDataInt1,
                  is_fifo ? b::kIntMapDataWatermark : b::kIntMapDataDrdy),
        configure(kFifoConfig1, b::kFifoConfig1All, is_fifo ? kContent : std::uint8_t{0}),
        configure(kPwrCtrl, b::kPwrCtrlAll, kPower),
    }};
  }

  static core::Result<void, DriverError> not_ready() {
    return refused(DriverErrorCode::not_ready, bmi270::kInternalStatus.address);
  }

  [[nodiscard]] bool is_waiting(core::Instant now) const {
    const core::Duration passed = now - commanded_at_;
    const bool is_changing = stage_ == Stage::on_spi || stage_ == Stage::on_spi_again;
    return (is_changing && passed < bmi270::kInterfaceTime) ||
           (stage_ == Stage::resetting && passed < bmi270::kResetTime) ||
           (stage_ == Stage::waking && passed < bmi270::kWakeTime) ||
           (stage_ == Stage::loaded && passed < bmi270::kLoadTime);
  }

  /// True over SPI where the chip may be on I2C still, as after power-on and after a reset.
  static constexpr bool is_on_i2c(Stage stage) {
    return kIsSpi<Bus> &&
           (stage == Stage::off || stage == Stage::resetting || stage == Stage::running);
  }

  /// Chip select rises after a reading, which is worth nothing itself.
  core::Result<void, DriverError> select_spi(core::Instant now, Stage stage) {
    const auto ignored = read_register(bus_, bmi270::kChipId);
    if (!ignored) return core::Unexpected{ignored.error()};
    return wait_after({}, now, stage == Stage::resetting ? Stage::on_spi_again : Stage::on_spi);
  }

  core::Result<void, DriverError> expect_identity(DriverErrorCode otherwise) {
    const auto identity = read_register(bus_, bmi270::kChipId);
    if (!identity) return core::Unexpected{identity.error()};
    if (*identity == bmi270::kChipId.reset) return {};
    return refused(otherwise, bmi270::kChipId.address);
  }

  core::Result<void, DriverError> wait_after(const core::Result<void, DriverError>& written,
                                             core::Instant now, Stage stage) {
    if (!written) return written;
    commanded_at_ = now;
    stage_ = stage;
    return not_ready();
  }

  core::Result<void, DriverError> load(core::Instant now) {
    if (loader_.is_done()) {
      return wait_after(write_register(bus_, bmi270::kInitCtrl, 1), now, Stage::loaded);
    }
    if (const auto done = loader_.load_portion(bus_); !done) return done;
    stage_ = Stage::loading;
    return not_ready();
  }

  core::Result<void, DriverError> finish_start(core::Instant now) {
    const auto status = read_register(bus_, bmi270::kInternalStatus);
    if (!status) return core::Unexpected{status.error()};
    if (!bmi270::is_initialised(*status)) {
      return refused(DriverErrorCode::sensor_fault, bmi270::kInternalStatus.address);
    }
    if (const auto done = read_cross_sensitivity(); !done) return done;
    if (const auto done = configuration_.apply(bus_); !done) return done;
    if (const auto done = flush(); !done) return done;
    settled_at_ = now + bmi270::settling_time(sample_period());
    sample_clock_.restart(now, sample_period());
    blank_frames_.restart();
    stage_ = Stage::running;
    return {};
  }

  /// Read twice, because a flipped bit would be a wrong correction until the next start.
  core::Result<void, DriverError> read_cross_sensitivity() {
    cross_sensitivity_ = 0.0F;
    if (!bmi270::has_features(settings_.config_file.size())) return {};
    const auto first = read_register(bus_, bmi270::kGyrCas);
    if (!first) return core::Unexpected{first.error()};
    const auto second = read_register(bus_, bmi270::kGyrCas);
    if (!second) return core::Unexpected{second.error()};
    if (*first != *second) return corrupt(bmi270::kGyrCas.address);
    cross_sensitivity_ = bmi270::decode_cross_sensitivity(*first);
    return {};
  }

  core::Result<void, DriverError> flush() {
    sample_clock_.lose_count();
    return write_register(bus_, bmi270::kCmd, bmi270::kCmdFifoFlush);
  }

  core::Result<std::size_t, DriverError> read_latest(core::Instant now, GyroSample& out) {
    // Status, magnetometer, accelerometer, gyro, times, interrupts, internal status, temperature.
    constexpr std::size_t kSize = 33;
    std::array<std::uint8_t, kSize> bytes{};
    if (const auto done = read_registers(bus_, bmi270::kStatus, bytes); !done) {
      return core::Unexpected{done.error()};
    }
    if (!bmi270::is_initialised(bytes[30])) return corrupt(bmi270::kInternalStatus.address);
    if ((bytes[0] & bmi270::bits::kStatusDrdyGyr) == 0) return std::size_t{0};
    if (const auto alive = expect_identity(DriverErrorCode::corrupt_data); !alive) {
      return core::Unexpected{alive.error()};
    }
    if (now < settled_at_) return std::size_t{0};
    const auto all = std::span<const std::uint8_t, kSize>{bytes};
    out = make_sample(now, all.template subspan<15, 6>(), decode_int16(bytes[31], bytes[32]));
    if constexpr (kHasAccelerometer) {
      const bool is_new = (bytes[0] & bmi270::bits::kStatusDrdyAcc) != 0;
      if (is_new) set_acceleration(out, raw_axes(all.template subspan<9, 6>()), scale_);
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
      const auto raw = raw_axes(gyro);
      if (bmi270::is_placeholder(raw)) return Frame::no_sample;
      if (blank_frames_.is_blank(raw) || time < settled_at_) return Frame::no_sample;
      sample = make_sample(time, gyro, temperature);
      if constexpr (kHasAccelerometer) {
        set_acceleration(sample, raw_axes(bytes.template last<6>()), scale_);
      }
      return Frame::sample;
    };
    auto count = drain_fifo<kFrameBytes>(bus_, bmi270::kFifoData, *frames, out, decode);
    if (count) {
      // Frames carry no mark. The output of a line that got stuck in the middle of them is no
      // sample.
      const auto alive = expect_identity(DriverErrorCode::corrupt_data);
      if (!alive) count = core::Unexpected{alive.error()};
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
      std::array<std::uint8_t, 5> bytes{};  // internal status, temperature, level
      if (const auto done = read_registers(bus_, bmi270::kInternalStatus, bytes); !done) {
        return core::Unexpected{done.error()};
      }
      level = bmi270::decode_fifo_length(bytes[3], bytes[4], kFrameBytes);
      if (!bmi270::is_initialised(bytes[0]) || !level.is_plausible) {
        return corrupt(bmi270::kInternalStatus.address);
      }
      temperature = decode_int16(bytes[1], bytes[2]);
    }
    if (!level.is_overrun && level.is_whole) return std::size_t{level.frames};
    if (const auto done = flush(); !done) return core::Unexpected{done.error()};
    return refused(DriverErrorCode::fifo_overrun, bmi270::kFifoData.address);
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
    if (sample.has_temperature) sample.temperature = bmi270::decode_temperature(temperature);
    set_rates(sample, raw_axes(bytes), lsb_, bmi270::kFullScaleRaw);
    sample.rate[0] = sample.rate[0] - sample.rate[2] * cross_sensitivity_;
    return sample;
  }

  Bus bus_;
  bmi270::Settings settings_;
  core::AngularRate lsb_;
  float cross_sensitivity_ = 0.0F;  ///< share of the rate about z in the output of x
  bmi270::ConfigFileLoader loader_;
  ConfigurationTable<kEntries> configuration_;
  SampleClock sample_clock_;
  BlankFrames blank_frames_;
  core::Instant commanded_at_;
  core::Instant settled_at_;
  Stage stage_ = Stage::off;
  [[no_unique_address]] Scale scale_;
};

}  // namespace zerorate::drivers
