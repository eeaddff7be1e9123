/// @file
/// Driver of the gyro, and on demand of the accelerometer, in InvenSense's MPU-6500, MPU-6050,
/// MPU-9250 and their relatives, over SPI or I2C, polled by data-ready or through the FIFO.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/configuration_table.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/fifo_drain.hpp"
#include "drivers/common/fifo_level.hpp"
#include "drivers/common/gyro_source.hpp"
#include "drivers/common/register_access.hpp"
#include "drivers/common/sample_clock.hpp"
#include "drivers/mpu6500/codec.hpp"
#include "drivers/mpu6500/configuration.hpp"
#include "drivers/mpu6500/registers.hpp"

namespace zerorate::drivers {

/// A GyroSource. Bus is SpiRegisters<...> or I2cRegisters<...>. SPI mode 0 or 3, up to 1 MHz or
/// the chip's own limit (README).
///
/// Not thread-safe, not for interrupts. Cortex-M0+: about 0.5 KiB of stack in read(), without the
/// back end's.
/// @tparam kAccelerometer  whether samples carry the acceleration, which is measured at the gyro's
///         rate. A sample of the FIFO takes twelve bytes then, not six: half as many fit.
template <RegisterBus Bus, Accelerometer kAccelerometer = Accelerometer::off>
class Mpu6500 {
  using Chosen = mpu6500::Chosen;

 public:
  static constexpr bool kHasAccelerometer = kAccelerometer == Accelerometer::on;

  static constexpr std::size_t kAxes = 3;

  constexpr explicit Mpu6500(Bus bus, mpu6500::Settings settings = {})
      : Mpu6500(mpu6500::chosen(settings), mpu6500::AccelerationRange::g_4, bus) {}
  /// A relative, by the type of its settings. One class drives them all: an image with two of them
  /// has its code once.
  template <mpu6500::Part kPart>
  constexpr Mpu6500(Bus bus, const mpu6500::SettingsOf<kPart>& settings)
      : Mpu6500(mpu6500::chosen(settings), mpu6500::AccelerationRange::g_4, bus) {}
  template <mpu6500::Part kPart>
  constexpr Mpu6500(Bus bus, const mpu6500::SettingsOf<kPart>& settings,
                    mpu6500::AccelerationRange range) requires(kAccelerometer == Accelerometer::on)
      : Mpu6500(mpu6500::chosen(settings), range, bus) {}

  /// First call: identity, then reset, then always not_ready. Later calls: not_ready until 100 ms
  /// have passed; then identity, waking up, and where the chip needs it a reset of the signal
  /// paths, for which another 100 ms pass; then identity, configuration (30 transactions) and
  /// success. When it runs, or after any other error, a call begins anew. The identity must be the
  /// same each time.
  core::Result<void, DriverError> start(core::Instant now) {
    const Stage stage = stage_;
    const bool is_pending = stage == Stage::resetting || stage == Stage::clearing;
    if (is_pending && now - reset_at_ < mpu6500::kResetTime) {
      return refused(DriverErrorCode::not_ready, mpu6500::kPwrMgmt1.address);
    }
    stage_ = Stage::off;
    if (const auto known = check_identity(is_pending); !known) return known;
    if (stage == Stage::resetting) return clear_paths(now);
    return stage == Stage::clearing ? finish_start(now) : begin_reset(now);
  }

  /// Data-ready mode: two transactions if there is a sample, one if not. FIFO mode: two, and if
  /// there are samples, one more and one for every 16. Samples of the first 70 ms and more after
  /// configuration are dropped (README). Errors: not_ready before start() succeeded; fifo_overrun
  /// once for each gap, with all that was in the FIFO; corrupt_data.
  core::Result<std::size_t, DriverError> read(core::Instant now, std::span<GyroSample> out) {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, mpu6500::kPwrMgmt1.address);
    }
    if (out.empty()) return std::size_t{0};
    return settings_.mode == mpu6500::Mode::fifo ? read_fifo(now, out) : read_latest(now, out[0]);
  }

  /// One transaction. Does not stop the driver: whether to start again is the application's choice.
  core::Result<void, DriverError> verify_next() {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, mpu6500::kPwrMgmt1.address);
    }
    return configuration_.verify_next(bus_);
  }

  /// Nominal: the chip has no trim register.
  [[nodiscard]] constexpr core::Duration sample_period() const {
    return mpu6500::sample_period(settings_.rate);
  }

  [[nodiscard]] constexpr core::AngularRate lsb() const { return lsb_; }
  [[nodiscard]] constexpr bool is_batched() const { return settings_.mode == mpu6500::Mode::fifo; }

 private:
  constexpr Mpu6500(const Chosen& settings, mpu6500::AccelerationRange range, Bus bus)
      : bus_(bus),
        settings_(settings),
        lsb_(mpu6500::lsb(settings.full_scale)),
        variant_(&mpu6500::variant_of(settings.part)),
        configuration_(configuration(settings, range, *variant_)),
        accelerometer_(accelerometer(range)) {}

  enum class Stage : std::uint8_t { off, resetting, clearing, running };
  static constexpr std::size_t kEntries = mpu6500::kGyroEntries + (kHasAccelerometer ? 2 : 0);
  static constexpr std::size_t kSampleBytes =
      kHasAccelerometer ? mpu6500::kLongSampleBytes : mpu6500::kFifoSampleBytes;
  using AxesBytes = std::span<const std::uint8_t, 6>;

  struct ChosenAccelerometer {
    AccelerationScale scale;
    mpu6500::AccelerationRange range = mpu6500::AccelerationRange::g_4;
  };
  using MaybeAccelerometer = MemberWith<kAccelerometer, ChosenAccelerometer>;
  static constexpr MaybeAccelerometer accelerometer(mpu6500::AccelerationRange range) {
    if constexpr (kHasAccelerometer) {
      return {.scale = {.lsb = mpu6500::acceleration_lsb(range)}, .range = range};
    } else {
      return {};
    }
  }

  /// Where the chip does not have a register, the entry before it stands twice.
  static constexpr ConfigurationTable<kEntries> configuration(const Chosen& settings,
                                                              mpu6500::AccelerationRange range,
                                                              const mpu6500::Variant& variant) {
    const auto gyro =
        mpu6500::configuration_of_gyro(settings, variant, kIsSpi<Bus>, kHasAccelerometer);
    if constexpr (kHasAccelerometer) {
      using namespace mpu6500;
      const auto scale =
          configure(kAccelConfig, bits::kAccelConfigAll, static_cast<std::uint8_t>(range));
      const auto filter =
          configure(kAccelConfig2, bits::kAccelConfig2Filter, low_pass(settings.rate));
      return ConfigurationTable<kEntries>{
          joined(gyro, std::array{scale, variant.has_accel_config_2 ? filter : scale})};
    } else {
      return ConfigurationTable<kEntries>{gyro};
    }
  }

  /// @param is_same whether it must equal that of the last time
  core::Result<void, DriverError> check_identity(bool is_same) {
    const auto identity = read_register(bus_, mpu6500::kWhoAmI);
    if (!identity) return core::Unexpected{identity.error()};
    const mpu6500::Variant* const variant = mpu6500::find_variant(*identity);
    const bool is_taken = variant != nullptr && mpu6500::takes(settings_.part, *identity);
    if (!is_taken || (is_same && variant != variant_)) {
      return refused(DriverErrorCode::wrong_identity, mpu6500::kWhoAmI.address);
    }
    variant_ = variant;
    return {};
  }

  core::Result<void, DriverError> begin_reset(core::Instant now) {
    constexpr std::uint8_t kReset = mpu6500::bits::kPwrMgmt1DeviceReset;
    if (const auto done = write_register(bus_, mpu6500::kPwrMgmt1, kReset); !done) return done;
    return wait(now, Stage::resetting);
  }

  core::Result<void, DriverError> clear_paths(core::Instant now) {
    namespace b = mpu6500::bits;
    auto done = write_register(bus_, mpu6500::kPwrMgmt1, b::kPwrMgmt1Pll);
    if (done && needs_path_reset())
      done = write_register(bus_, mpu6500::kSignalPathReset, b::kSignalPathResetAll);
    return done ? wait(now, Stage::clearing) : done;
  }

  [[nodiscard]] constexpr bool needs_path_reset() const {
    const mpu6500::PathReset reset = variant_->path_reset;
    return reset == mpu6500::PathReset::always ||
           (reset == mpu6500::PathReset::on_spi && kIsSpi<Bus>);
  }

  core::Result<void, DriverError> wait(core::Instant now, Stage stage) {
    reset_at_ = now;
    stage_ = stage;
    return refused(DriverErrorCode::not_ready, mpu6500::kPwrMgmt1.address);
  }

  core::Result<void, DriverError> finish_start(core::Instant now) {
    if constexpr (kHasAccelerometer) {
      configuration_ = configuration(settings_, accelerometer_.range, *variant_);
    }
    if (const auto done = configuration_.apply(bus_); !done) return done;
    settled_at_ = now + mpu6500::settling_time(*variant_, sample_period());
    sample_clock_.restart(now, sample_period());
    blank_frames_.restart();
    is_shifted_ = false;
    stage_ = Stage::running;
    return {};
  }

  /// INT_STATUS, accelerometer, temperature, and gyro.
  using Outputs = std::array<std::uint8_t, 15>;

  /// One burst, of one instant (README): reading the status clears it, and later samples show in
  /// the next burst.
  core::Result<void, DriverError> read_outputs(std::span<std::uint8_t> bytes) {
    if (const auto done = read_registers(bus_, mpu6500::kIntStatus, bytes); !done) return done;
    constexpr unsigned kNever = mpu6500::bits::kIntStatusNeverAtOnce;
    if ((bytes[0] & kNever) == kNever) {
      return refused(DriverErrorCode::corrupt_data, mpu6500::kIntStatus.address);
    }
    return {};
  }

  core::Result<std::size_t, DriverError> read_latest(core::Instant now, GyroSample& out) {
    Outputs bytes{};
    if (const auto done = read_outputs(bytes); !done) return core::Unexpected{done.error()};
    if ((bytes[0] & mpu6500::bits::kIntDataRdy) == 0) return std::size_t{0};
    if (const auto alive = check_line(); !alive) return core::Unexpected{alive.error()};
    if (now < settled_at_) return std::size_t{0};
    const auto outputs = std::span<const std::uint8_t, 15>{bytes};
    out = make_sample(now, outputs.template last<6>(), raw_temperature(bytes));
    if constexpr (kHasAccelerometer) {
      set_acceleration(out, raw_axes(outputs.template subspan<1, 6>()), accelerometer_.scale);
    }
    return std::size_t{1};
  }

  core::Result<std::size_t, DriverError> read_fifo(core::Instant now, std::span<GyroSample> out) {
    if (is_shifted_) {
      if (const auto done = clear_fifo(); !done) return core::Unexpected{done.error()};
    }
    std::array<std::uint8_t, 9> bytes{};
    if (const auto done = read_outputs(bytes); !done) return core::Unexpected{done.error()};
    const bool has_dropped = (bytes[0] & mpu6500::bits::kIntFifoOflow) != 0;
    const auto samples = has_dropped ? report_overrun() : read_fifo_level();
    if (!samples || *samples == 0) return samples;
    sample_clock_.begin_batch(now, *samples);
    auto count = drain(*samples, out, raw_temperature(bytes));
    if (count) {
      if (const auto alive = check_line(); !alive) count = core::Unexpected{alive.error()};
    }
    // The place in the FIFO is unknown after a burst that broke off.
    if (!count) is_shifted_ = true;
    return count;
  }

  /// Reads the level, and once more where bytes are left over: they may be a sample that is being
  /// written.
  core::Result<std::size_t, DriverError> read_fifo_level() {
    FifoLevel level{};
    for (int attempt = 0; attempt < 2 && !level.is_whole; ++attempt) {
      std::array<std::uint8_t, 2> bytes{};
      if (const auto done = read_registers(bus_, mpu6500::kFifoCountH, bytes); !done) {
        return core::Unexpected{done.error()};
      }
      level = mpu6500::decode_fifo_level(*variant_, bytes[0], bytes[1], kSampleBytes);
    }
    if (!level.is_plausible) {
      return refused(DriverErrorCode::corrupt_data, mpu6500::kFifoCountH.address);
    }
    if (level.is_overrun || !level.is_whole) return report_overrun();
    return std::size_t{level.frames};
  }

  /// The start of a sample in the FIFO is unknown: the FIFO is emptied, and the gap is reported.
  core::Result<std::size_t, DriverError> report_overrun() {
    is_shifted_ = true;
    if (const auto done = clear_fifo(); !done) return core::Unexpected{done.error()};
    return refused(DriverErrorCode::fifo_overrun, mpu6500::kFifoCountH.address);
  }

  /// Two transactions: it can be emptied only while it is off.
  core::Result<void, DriverError> clear_fifo() {
    namespace b = mpu6500::bits;
    const std::uint8_t rest = mpu6500::interface(*variant_, kIsSpi<Bus>);
    const auto empty = static_cast<std::uint8_t>(b::kUserCtrlFifoReset | rest);
    const auto on = static_cast<std::uint8_t>(b::kUserCtrlFifoEn | rest);
    sample_clock_.lose_count();
    auto done = write_register(bus_, mpu6500::kUserCtrl, empty);
    if (done) done = write_register(bus_, mpu6500::kUserCtrl, on);
    if (done) is_shifted_ = false;
    return done;
  }

  core::Result<std::size_t, DriverError> drain(std::size_t samples, std::span<GyroSample> out,
                                               std::int16_t temperature) {
    blank_frames_.begin_reading();
    const auto decode = [&](std::span<const std::uint8_t> bytes, GyroSample& sample) {
      const core::Instant time = sample_clock_.next();
      const AxesBytes gyro = bytes.template last<6>();
      if (blank_frames_.is_blank(raw_axes(gyro)) || time < settled_at_) return Frame::no_sample;
      if (variant_->is_younger) {
        const auto mark = bytes.last(sizeof(std::int16_t) + gyro.size());
        if (!mpu6500::is_marked(decode_int16(mark[1], mark[0]), temperature)) return Frame::corrupt;
      }
      sample = make_sample(time, gyro, temperature);
      if constexpr (kHasAccelerometer) {
        set_acceleration(sample, raw_axes(bytes.template first<6>()), accelerometer_.scale);
      }
      return Frame::sample;
    };
    constexpr std::size_t kMost = kSampleBytes + mpu6500::kTemperatureBytes;
    const std::size_t size = mpu6500::sample_bytes(*variant_, kSampleBytes);
    return drain_frames<kMost>(bus_, mpu6500::kFifoRW, size, samples, out, decode);
  }

  /// Samples carry no mark. The output of a line that got stuck in the middle of them is no sample:
  /// the identity behind them shows it.
  core::Result<void, DriverError> check_line() {
    const auto identity = read_register(bus_, mpu6500::kWhoAmI);
    if (!identity) return core::Unexpected{identity.error()};
    if (*identity == variant_->identity) return {};
    return refused(DriverErrorCode::corrupt_data, mpu6500::kWhoAmI.address);
  }

  /// @param outputs INT_STATUS and what follows
  static constexpr std::int16_t raw_temperature(std::span<const std::uint8_t> outputs) {
    return decode_int16(outputs[8], outputs[7]);
  }

  static constexpr BlankFrames::Raw raw_axes(AxesBytes bytes) {
    return {decode_int16(bytes[1], bytes[0]), decode_int16(bytes[3], bytes[2]),
            decode_int16(bytes[5], bytes[4])};
  }

  [[nodiscard]] GyroSample make_sample(core::Instant time, AxesBytes bytes,
                                       std::int16_t temperature) const {
    GyroSample sample;
    sample.time = time;
    sample.has_temperature = variant_->counts_per_degree > 0.0F;
    if (sample.has_temperature) {
      sample.temperature = mpu6500::decode_temperature(*variant_, temperature);
    }
    set_rates(sample, raw_axes(bytes), lsb_, mpu6500::kFullScaleRaw);
    return sample;
  }

  Bus bus_;
  Chosen settings_;
  core::AngularRate lsb_;
  const mpu6500::Variant* variant_ = nullptr;  ///< the one that answered, while it runs
  ConfigurationTable<kEntries> configuration_;
  SampleClock sample_clock_;
  BlankFrames blank_frames_;
  core::Instant reset_at_;
  core::Instant settled_at_;
  bool is_shifted_ = false;  ///< the start of a sample in the FIFO is unknown
  Stage stage_ = Stage::off;
  [[no_unique_address]] MaybeAccelerometer accelerometer_;
};

}  // namespace zerorate::drivers
