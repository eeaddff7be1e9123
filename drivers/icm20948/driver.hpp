/// @file
/// Driver of the gyro, and on demand of the accelerometer, in InvenSense's ICM-20948, over SPI or
/// I2C, polled by data-ready or through the FIFO.
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
#include "drivers/icm20948/banked_registers.hpp"
#include "drivers/icm20948/codec.hpp"
#include "drivers/icm20948/configuration.hpp"
#include "drivers/icm20948/registers.hpp"

namespace zerorate::drivers {

/// A GyroSource. Bus is SpiRegisters<...> or I2cRegisters<...>. SPI mode 0 or 3, up to 7 MHz.
/// Errors of a register in bank 2 have bit 7 set in DriverError::reg.
///
/// Not thread-safe, not for interrupts. Cortex-M0+: about 0.5 KiB of stack in read(), without the
/// back end's.
/// @tparam kAccelerometer  whether samples carry the acceleration, which is measured at the gyro's
///         rate. A sample of the FIFO takes twelve bytes then, not six: half as many fit.
template <RegisterBus Bus, Accelerometer kAccelerometer = Accelerometer::off>
class Icm20948 {
 public:
  static constexpr bool kHasAccelerometer = kAccelerometer == Accelerometer::on;

  static constexpr std::size_t kAxes = 3;

  constexpr explicit Icm20948(Bus bus, icm20948::Settings settings = {})
      : Icm20948(settings, icm20948::AccelerationRange::g_4, bus) {}
  constexpr Icm20948(Bus bus, icm20948::Settings settings,
                     icm20948::AccelerationRange range) requires(kAccelerometer ==
                                                                 Accelerometer::on)
      : Icm20948(settings, range, bus) {}

  /// First call: identity, then reset, then always not_ready. Later calls: not_ready until 100 ms
  /// have passed; then the chip is woken, for which another 100 ms pass; then identity,
  /// configuration (63 transactions) and success. When it runs, or after any other error, a call
  /// begins anew. A chip that was left in another bank is brought back first.
  core::Result<void, DriverError> start(core::Instant now) {
    const Stage stage = stage_;
    const bool is_pending = stage == Stage::resetting || stage == Stage::waking;
    if (is_pending && now - commanded_at_ < icm20948::kResetTime) {
      return refused(DriverErrorCode::not_ready, icm20948::kPwrMgmt1.address);
    }
    stage_ = Stage::off;
    if (const auto known = check_identity(); !known) return known;
    namespace b = icm20948::bits;
    if (stage == Stage::waking) return finish_start(now);
    return stage == Stage::resetting ? command(now, b::kPwrMgmt1AutoClock, Stage::waking)
                                     : command(now, b::kPwrMgmt1DeviceReset, Stage::resetting);
  }

  /// Data-ready mode: two transactions if there is a sample, one if not. FIFO mode: two, and if
  /// there are samples, one more and one for every 16. Samples of the first 70 ms and more after
  /// configuration are dropped (README). Errors: not_ready before start() succeeded; fifo_overrun
  /// once for each gap, with all that was in the FIFO; corrupt_data.
  core::Result<std::size_t, DriverError> read(core::Instant now, std::span<GyroSample> out) {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, icm20948::kPwrMgmt1.address);
    }
    if (out.empty()) return std::size_t{0};
    return is_batched() ? read_fifo(now, out) : read_latest(now, out[0]);
  }

  /// One transaction; three for a register of bank 2. Does not stop the driver: whether to start
  /// again is the application's choice.
  core::Result<void, DriverError> verify_next() {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, icm20948::kPwrMgmt1.address);
    }
    return configuration_.verify_next(bus_);
  }

  /// Nominal: the trim register is not used (README).
  [[nodiscard]] constexpr core::Duration sample_period() const {
    return icm20948::sample_period(settings_.rate);
  }
  [[nodiscard]] constexpr core::AngularRate lsb() const { return lsb_; }
  [[nodiscard]] constexpr bool is_batched() const { return settings_.mode == icm20948::Mode::fifo; }

 private:
  constexpr Icm20948(const icm20948::Settings& settings, icm20948::AccelerationRange range, Bus bus)
      : bus_(bus),
        settings_(settings),
        lsb_(icm20948::lsb(settings.full_scale)),
        configuration_(configuration(settings, range)),
        scale_(scale(range)) {}

  enum class Stage : std::uint8_t { off, resetting, waking, running };
  static constexpr std::size_t kEntries =
      icm20948::kGyroEntries + (kHasAccelerometer ? icm20948::kAccelerometerEntries : 0);
  static constexpr std::size_t kSampleBytes =
      kHasAccelerometer ? icm20948::kLongSampleBytes : icm20948::kFifoSampleBytes;
  using Scale = MemberWith<kAccelerometer, AccelerationScale>;
  using AxesBytes = std::span<const std::uint8_t, 6>;

  static constexpr Scale scale(icm20948::AccelerationRange range) {
    if constexpr (kHasAccelerometer) {
      return {.lsb = icm20948::acceleration_lsb(range)};
    } else {
      return {};
    }
  }

  static constexpr ConfigurationTable<kEntries> configuration(const icm20948::Settings& settings,
                                                              icm20948::AccelerationRange range) {
    const auto gyro = icm20948::configuration_of_gyro(settings, kIsSpi<Bus>, kHasAccelerometer);
    if constexpr (kHasAccelerometer) {
      return ConfigurationTable<kEntries>{
          joined(gyro, icm20948::configuration_of_accelerometer(settings, range))};
    } else {
      return ConfigurationTable<kEntries>{gyro};
    }
  }

  core::Result<void, DriverError> check_identity() {
    auto identity = read_register(bus_, icm20948::kWhoAmI);
    if (identity && *identity != icm20948::kWhoAmI.reset) {
      const auto bank = read_register(bus_, icm20948::kRegBankSel);
      if (!bank) return core::Unexpected{bank.error()};
      constexpr std::uint8_t kBank = icm20948::bits::kRegBankSelBank;
      const bool is_elsewhere = *bank != 0 && (*bank & ~kBank) == 0;
      if (!is_elsewhere) return refused(DriverErrorCode::wrong_identity, icm20948::kWhoAmI.address);
      const auto done = write_register(bus_, icm20948::kRegBankSel, 0);
      if (!done) return done;
      identity = read_register(bus_, icm20948::kWhoAmI);
    }
    if (!identity) return core::Unexpected{identity.error()};
    if (*identity == icm20948::kWhoAmI.reset) return {};
    return refused(DriverErrorCode::wrong_identity, icm20948::kWhoAmI.address);
  }

  core::Result<void, DriverError> command(core::Instant now, std::uint8_t power, Stage stage) {
    if (const auto done = write_register(bus_, icm20948::kPwrMgmt1, power); !done) return done;
    commanded_at_ = now;
    stage_ = stage;
    return refused(DriverErrorCode::not_ready, icm20948::kPwrMgmt1.address);
  }

  core::Result<void, DriverError> finish_start(core::Instant now) {
    if (const auto done = configuration_.apply(bus_); !done) return done;
    settled_at_ = now + icm20948::settling_time(sample_period());
    sample_clock_.restart(now, sample_period());
    blank_frames_.restart();
    is_shifted_ = false;
    stage_ = Stage::running;
    return {};
  }

  /// INT_STATUS to INT_STATUS_3, what lies between, accelerometer, gyro, temperature.
  using Outputs = std::array<std::uint8_t, 34>;
  static constexpr std::size_t kAccelAt = 20;
  static constexpr std::size_t kGyroAt = 26;
  static constexpr std::size_t kTemperatureAt = 32;

  /// One burst, of one instant (README): reading the status clears it, and later samples show in
  /// the next burst.
  core::Result<void, DriverError> read_outputs(Outputs& bytes) {
    if (const auto done = read_registers(bus_, icm20948::kIntStatus, bytes); !done) return done;
    constexpr std::uint8_t kReserved = icm20948::bits::kIntStatus1Reserved;
    if ((bytes[1] & kReserved) != kReserved) return {};
    return refused(DriverErrorCode::corrupt_data, icm20948::kIntStatus.address);
  }

  core::Result<std::size_t, DriverError> read_latest(core::Instant now, GyroSample& out) {
    Outputs bytes{};
    if (const auto done = read_outputs(bytes); !done) return core::Unexpected{done.error()};
    if ((bytes[1] & icm20948::bits::kRawDataRdy) == 0) return std::size_t{0};
    if (const auto alive = check_line(); !alive) return core::Unexpected{alive.error()};
    if (now < settled_at_) return std::size_t{0};
    const auto outputs = std::span<const std::uint8_t, 34>{bytes};
    out = make_sample(now, outputs.template subspan<kGyroAt, 6>(), raw_temperature(bytes));
    if constexpr (kHasAccelerometer) {
      set_acceleration(out, raw_axes(outputs.template subspan<kAccelAt, 6>()), scale_);
    }
    return std::size_t{1};
  }

  core::Result<std::size_t, DriverError> read_fifo(core::Instant now, std::span<GyroSample> out) {
    if (is_shifted_) {
      if (const auto done = clear_fifo(); !done) return core::Unexpected{done.error()};
    }
    Outputs bytes{};
    if (const auto done = read_outputs(bytes); !done) return core::Unexpected{done.error()};
    const bool has_dropped = (bytes[2] & icm20948::bits::kFifos) != 0;
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
      if (const auto done = read_registers(bus_, icm20948::kFifoCountH, bytes); !done) {
        return core::Unexpected{done.error()};
      }
      level = icm20948::decode_fifo_level(bytes[0], bytes[1], kSampleBytes);
    }
    if (!level.is_plausible) {
      return refused(DriverErrorCode::corrupt_data, icm20948::kFifoCountH.address);
    }
    if (level.is_overrun || !level.is_whole) return report_overrun();
    return std::size_t{level.frames};
  }

  /// The start of a sample in the FIFO is unknown: the FIFO is emptied, and the gap is reported.
  core::Result<std::size_t, DriverError> report_overrun() {
    is_shifted_ = true;
    if (const auto done = clear_fifo(); !done) return core::Unexpected{done.error()};
    return refused(DriverErrorCode::fifo_overrun, icm20948::kFifoCountH.address);
  }

  /// Two transactions: the FIFO stays empty until the bits are 0 again.
  core::Result<void, DriverError> clear_fifo() {
    sample_clock_.lose_count();
    auto done = write_register(bus_, icm20948::kFifoRst, icm20948::bits::kFifos);
    if (done) done = write_register(bus_, icm20948::kFifoRst, 0);
    if (done) is_shifted_ = false;
    return done;
  }

  core::Result<std::size_t, DriverError> drain(std::size_t samples, std::span<GyroSample> out,
                                               std::int16_t temperature) {
    blank_frames_.begin_reading();
    const auto decode = [&](std::span<const std::uint8_t, kSampleBytes> bytes, GyroSample& sample) {
      const core::Instant time = sample_clock_.next();
      const AxesBytes gyro = bytes.template last<6>();
      if (blank_frames_.is_blank(raw_axes(gyro)) || time < settled_at_) return Frame::no_sample;
      sample = make_sample(time, gyro, temperature);
      if constexpr (kHasAccelerometer) {
        set_acceleration(sample, raw_axes(bytes.template first<6>()), scale_);
      }
      return Frame::sample;
    };
    return drain_fifo<kSampleBytes>(bus_, icm20948::kFifoRW, samples, out, decode);
  }

  /// Samples carry no mark. The output of a line that got stuck in the middle of them, or of a chip
  /// in another bank, is no sample: the identity behind them shows it.
  core::Result<void, DriverError> check_line() {
    const auto identity = read_register(bus_, icm20948::kWhoAmI);
    if (!identity) return core::Unexpected{identity.error()};
    if (*identity == icm20948::kWhoAmI.reset) return {};
    return refused(DriverErrorCode::corrupt_data, icm20948::kWhoAmI.address);
  }

  static constexpr std::int16_t raw_temperature(const Outputs& bytes) {
    return decode_int16(bytes[kTemperatureAt + 1], bytes[kTemperatureAt]);
  }

  static constexpr BlankFrames::Raw raw_axes(AxesBytes bytes) {
    return {decode_int16(bytes[1], bytes[0]), decode_int16(bytes[3], bytes[2]),
            decode_int16(bytes[5], bytes[4])};
  }

  [[nodiscard]] GyroSample make_sample(core::Instant time, AxesBytes bytes,
                                       std::int16_t temperature) const {
    GyroSample sample;
    sample.time = time;
    sample.has_temperature = true;
    sample.temperature = icm20948::decode_temperature(temperature);
    set_rates(sample, raw_axes(bytes), lsb_, icm20948::kFullScaleRaw);
    return sample;
  }

  icm20948::BankedRegisters<Bus> bus_;
  icm20948::Settings settings_;
  core::AngularRate lsb_;
  ConfigurationTable<kEntries> configuration_;
  SampleClock sample_clock_;
  BlankFrames blank_frames_;
  core::Instant commanded_at_;
  core::Instant settled_at_;
  bool is_shifted_ = false;  ///< the start of a sample in the FIFO is unknown
  Stage stage_ = Stage::off;
  [[no_unique_address]] Scale scale_;
};

}  // namespace zerorate::drivers
