/// @file
/// Driver of the gyro, and on demand of the accelerometer, in ST's LSM6DSO and its relatives, over
/// SPI or I2C, polled by data-ready or through the FIFO.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/assert.hpp"
#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/configuration_table.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/fifo_drain.hpp"
#include "drivers/common/gyro_source.hpp"
#include "drivers/common/register_access.hpp"
#include "drivers/common/sample_clock.hpp"
#include "drivers/lsm6dso/codec.hpp"
#include "drivers/lsm6dso/configuration.hpp"
#include "drivers/lsm6dso/registers.hpp"
#include "drivers/lsm6dso/slots.hpp"

namespace zerorate::drivers {

namespace lsm6dso {

/// Output data rates of a chip.
template <Part kPart>
using RateOf = std::conditional_t<variant(kPart).has_new_layout, DsvRate, OutputDataRate>;

/// Chosen once, for the life of the driver; a type for each chip, since two chips answer alike.
template <Part kPart>
struct SettingsOf {
  FullScale full_scale = FullScale::dps_250;  ///< larger: coarser LSB, 8.75 mdps at 250 deg/s
  RateOf<kPart> rate = [] {
    if constexpr (variant(kPart).has_new_layout)
      return DsvRate::hz_120;
    else
      return OutputDataRate::hz_104;
  }();
  Mode mode = Mode::data_ready;
  std::uint8_t fifo_watermark = 8;  ///< samples that raise INT1; larger: fewer, longer bursts
};
using Settings = SettingsOf<Part::lsm6dso>;

}  // namespace lsm6dso

/// A GyroSource. Bus is SpiRegisters<...> or I2cRegisters<...>. SPI mode 0 or 3, up to 10 MHz.
///
/// Not thread-safe, not for interrupts. Cortex-M0+: about 0.5 KiB of stack in read(),
/// without the back end's.
/// @tparam kAccelerometer  whether samples carry the acceleration, which is measured at the gyro's
///         rate. A sample of the FIFO takes two words then: half as many fit, and a watermark is at
///         most half the FIFO.
template <RegisterBus Bus, Accelerometer kAccelerometer = Accelerometer::off>
class Lsm6dso {
  using Chosen = lsm6dso::Chosen;

 public:
  static constexpr bool kHasAccelerometer = kAccelerometer == Accelerometer::on;

  static constexpr std::size_t kAxes = 3;

  constexpr explicit Lsm6dso(Bus bus, lsm6dso::Settings settings = {})
      : Lsm6dso(bus, chosen(settings), kUsualRange) {}
  /// A relative, by the type of its settings. One class drives them all: an image with two of them
  /// has its code once.
  template <lsm6dso::Part kPart>
  constexpr Lsm6dso(Bus bus, const lsm6dso::SettingsOf<kPart>& settings)
      : Lsm6dso(bus, chosen(settings), kUsualRange) {}
  /// @param range  of the accelerometer; 4 g where none is given
  template <lsm6dso::Part kPart>
  constexpr Lsm6dso(Bus bus, const lsm6dso::SettingsOf<kPart>& settings,
                    lsm6dso::AccelerationRange range) requires(kAccelerometer == Accelerometer::on)
      : Lsm6dso(bus, chosen(settings), range) {}

  /// First call: identity, then software reset, then always not_ready. Later calls: not_ready until
  /// the chip has left reset (50 us), then configuration (33 transactions) and success. When it
  /// runs, or after any other error, a call begins anew. A chip that gave 0 as its identity three
  /// times is reset all the same (README).
  core::Result<void, DriverError> start(core::Instant now) {
    const bool is_reset_pending = stage_ == Stage::resetting;
    stage_ = Stage::off;
    if (const auto known = check_identity(); !known) {
      return is_blind_reset_due(known.error()) ? begin_reset() : known;
    }
    return is_reset_pending ? finish_start(now) : begin_reset();
  }

  /// Data-ready mode: two transactions if there is a sample, one if not. FIFO mode: two, and one
  /// for every 16 samples. Samples of the first 70 ms and more after power-up are dropped (README).
  /// Errors: not_ready before start() succeeded; fifo_overrun once for each gap; corrupt_data.
  core::Result<std::size_t, DriverError> read(core::Instant now, std::span<GyroSample> out) {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, lsm6dso::kCtrl2G.address);
    }
    if (out.empty()) return std::size_t{0};
    return settings_.mode == lsm6dso::Mode::fifo ? read_fifo(now, out) : read_latest(now, out[0]);
  }

  /// One transaction. Does not stop the driver: whether to start again is the application's choice.
  core::Result<void, DriverError> verify_next() {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, lsm6dso::kCtrl2G.address);
    }
    return configuration_.verify_next(bus_);
  }

  /// Nominal until start() has read the chip's trim.
  [[nodiscard]] constexpr core::Duration sample_period() const { return period_; }

  [[nodiscard]] constexpr core::AngularRate lsb() const { return lsb_; }
  [[nodiscard]] constexpr bool is_batched() const { return settings_.mode == lsm6dso::Mode::fifo; }

 private:
  template <lsm6dso::Part kPart>
  static constexpr Chosen chosen(const lsm6dso::SettingsOf<kPart>& settings) {
    ZERORATE_ASSERT(lsm6dso::variant(kPart).has_tags || settings.mode == lsm6dso::Mode::data_ready);
    return {.variant = &lsm6dso::variant(kPart),
            .full_scale = settings.full_scale,
            .rate = static_cast<std::uint8_t>(settings.rate),
            .mode = settings.mode,
            .fifo_watermark = settings.fifo_watermark};
  }
  constexpr Lsm6dso(Bus bus, const Chosen& settings, lsm6dso::AccelerationRange range)
      : bus_(bus),
        settings_(settings),
        lsb_(lsm6dso::lsb(settings.full_scale)),
        period_(lsm6dso::decode_period(*settings.variant, settings.rate, 0)),
        configuration_(configuration(settings, range)),
        slots_(slots(range)) {}

  enum class Stage : std::uint8_t { off, resetting, running };
  static constexpr lsm6dso::AccelerationRange kUsualRange = lsm6dso::AccelerationRange::g_4;
  static constexpr std::size_t kEntries =
      lsm6dso::kGyroEntries + (kHasAccelerometer ? lsm6dso::kAccelerometerEntries : 0);
  static constexpr std::size_t kWordBytes = lsm6dso::kFifoWordBytes;
  using Slots = MemberWith<kAccelerometer, lsm6dso::Slots>;

  static constexpr Slots slots(lsm6dso::AccelerationRange range) {
    if constexpr (kHasAccelerometer) {
      return Slots{AccelerationScale{.lsb = lsm6dso::acceleration_lsb(range)}};
    } else {
      return {};
    }
  }

  static constexpr ConfigurationTable<kEntries> configuration(const Chosen& settings,
                                                              lsm6dso::AccelerationRange range) {
    if constexpr (kHasAccelerometer) {
      return ConfigurationTable<kEntries>{
          lsm6dso::configuration_with_accelerometer(settings, range)};
    } else {
      return ConfigurationTable<kEntries>{lsm6dso::configuration_of_gyro(settings)};
    }
  }

  core::Result<void, DriverError> check_identity() {
    const auto identity = read_register(bus_, lsm6dso::kWhoAmI);
    if (!identity) return core::Unexpected{identity.error()};
    zero_identities_ = *identity == 0 ? static_cast<std::uint8_t>(zero_identities_ + 1) : 0;
    if (*identity != settings_.variant->identity) {
      return refused(DriverErrorCode::wrong_identity, lsm6dso::kWhoAmI.address);
    }
    return {};
  }

  /// Some chips come out of a brown-out deaf but for writing, until a reset.
  [[nodiscard]] constexpr bool is_blind_reset_due(const DriverError& error) {
    constexpr std::uint8_t kAfter = 3;
    if (error.code != DriverErrorCode::wrong_identity || zero_identities_ < kAfter) return false;
    zero_identities_ = 0;
    return true;
  }

  core::Result<void, DriverError> begin_reset() {
    constexpr std::uint8_t kReset = lsm6dso::kCtrl3C.reset | lsm6dso::bits::kCtrl3CSwReset;
    if (const auto done = write_register(bus_, lsm6dso::kCtrl3C, kReset); !done) return done;
    stage_ = Stage::resetting;
    return refused(DriverErrorCode::not_ready, lsm6dso::kCtrl3C.address);
  }

  core::Result<void, DriverError> finish_start(core::Instant now) {
    const auto ctrl3 = read_register(bus_, lsm6dso::kCtrl3C);
    if (!ctrl3) return core::Unexpected{ctrl3.error()};
    if ((*ctrl3 & lsm6dso::bits::kCtrl3CSwReset) != 0) {
      stage_ = Stage::resetting;
      return refused(DriverErrorCode::not_ready, lsm6dso::kCtrl3C.address);
    }
    if (const auto done = configuration_.apply(bus_); !done) return done;
    const lsm6dso::Variant& variant = *settings_.variant;
    const auto trim = read_trim();
    if (!trim) return core::Unexpected{trim.error()};
    period_ = lsm6dso::decode_period(variant, settings_.rate, static_cast<std::int8_t>(*trim));
    settled_at_ = now + lsm6dso::settling_time(variant, settings_.rate, period_);
    sample_clock_.restart(now, period_);
    forget_words();
    stage_ = Stage::running;
    return {};
  }

  core::Result<std::uint8_t, DriverError> read_trim() {
    const lsm6dso::Variant& variant = *settings_.variant;
    if (variant.trim_step == 0) return std::uint8_t{0};
    return variant.has_new_layout ? read_register(bus_, lsm6dso::kDsvInternalFreq)
                                  : read_register(bus_, lsm6dso::kInternalFreqFine);
  }

  core::Result<std::size_t, DriverError> read_latest(core::Instant now, GyroSample& out) {
    const auto status = read_register(bus_, lsm6dso::kStatusReg);
    if (!status) return core::Unexpected{status.error()};
    const unsigned always_zero = settings_.variant->status_always_zero;
    if ((*status & always_zero) != 0) {
      return refused(DriverErrorCode::corrupt_data, lsm6dso::kStatusReg.address);
    }
    if ((*status & lsm6dso::bits::kStatusGda) == 0) return std::size_t{0};
    // Only now: reading the outputs clears data-ready, and a sample that came after the status was
    // read would be thrown away with it. The status comes once more in front of them: the output of
    // a line that got stuck in between is no sample.
    constexpr std::size_t kBytes = kHasAccelerometer ? 16 : 10;
    std::array<std::uint8_t, kBytes> bytes{};
    if (const auto done = read_registers(bus_, lsm6dso::kStatusReg, bytes); !done) {
      return core::Unexpected{done.error()};
    }
    const unsigned again = bytes[0];
    if ((again & (always_zero | lsm6dso::bits::kStatusGda)) != lsm6dso::bits::kStatusGda) {
      return refused(DriverErrorCode::corrupt_data, lsm6dso::kStatusReg.address);
    }
    if (now < settled_at_) return std::size_t{0};
    const auto temperature = lsm6dso::decode_temperature(decode_int16(bytes[2], bytes[3]));
    out = make_sample(now, std::span<const std::uint8_t, 6>{&bytes[4], 6}, temperature);
    if constexpr (kHasAccelerometer) {
      const std::span<const std::uint8_t, 6> acceleration{&bytes[10], 6};
      const bool is_new = (again & lsm6dso::bits::kStatusXlda) != 0;
      if (is_new) set_acceleration(out, raw_of(acceleration), slots_.scale());
    }
    return std::size_t{1};
  }

  core::Result<std::size_t, DriverError> read_fifo(core::Instant now, std::span<GyroSample> out) {
    const auto words = read_fifo_level();
    if (!words) return core::Unexpected{words.error()};
    if (*words == 0) return std::size_t{0};
    std::array<std::uint8_t, 2> temperature{};
    if (const auto done = read_registers(bus_, lsm6dso::kOutTempL, temperature); !done) {
      return core::Unexpected{done.error()};
    }
    const core::Temperature degrees =
        lsm6dso::decode_temperature(decode_int16(temperature[0], temperature[1]));
    if constexpr (kHasAccelerometer) {
      const auto count = drain_slots(now, *words, out, degrees);
      if (!count) forget_words();
      return count;
    } else {
      sample_clock_.begin_batch(now, *words);
      return drain(*words, out, degrees);
    }
  }

  core::Result<std::uint16_t, DriverError> read_fifo_level() {
    const lsm6dso::Variant& variant = *settings_.variant;
    const std::uint8_t address =
        variant.has_new_layout ? lsm6dso::kDsvFifoStatus1.address : lsm6dso::kFifoStatus1.address;
    std::array<std::uint8_t, 2> bytes{};
    if (const auto done = bus_.read(address, bytes); !done) {
      return bus_failed(done.error(), address);
    }
    const auto status = lsm6dso::decode_fifo_status(variant, bytes[0], bytes[1]);
    if (!status.is_plausible) return refused(DriverErrorCode::corrupt_data, address);
    if (overrun_report_.is_due(status.is_overrun)) {
      sample_clock_.lose_count();
      forget_words();
      return refused(DriverErrorCode::fifo_overrun, address);
    }
    return status.words;
  }

  core::Result<std::size_t, DriverError> drain(std::size_t words, std::span<GyroSample> out,
                                               core::Temperature temperature) {
    const auto decode = [&](std::span<const std::uint8_t, kWordBytes> word, GyroSample& sample) {
      if (!lsm6dso::is_gyro_tag(*settings_.variant, word[0])) return Frame::corrupt;
      const core::Instant time = sample_clock_.next();
      if (time < settled_at_) return Frame::no_sample;
      sample = make_sample(time, word.template subspan<1, 6>(), temperature);
      return Frame::sample;
    };
    return drain_fifo<kWordBytes>(bus_, lsm6dso::kFifoDataOutTag, words, out, decode);
  }

  /// Words of two sensors. How many samples they make shows when they are read: the samples are
  /// stamped then.
  core::Result<std::size_t, DriverError> drain_slots(core::Instant now, std::size_t words,
                                                     std::span<GyroSample> out,
                                                     core::Temperature temperature) {
    const auto decode = [&](std::span<const std::uint8_t, kWordBytes> word, GyroSample& sample) {
      const lsm6dso::Variant& variant = *settings_.variant;
      const auto payload = word.template subspan<1, 6>();
      const std::uint8_t slot = lsm6dso::time_slot(word[0]);
      bool is_sample = false;
      --words;
      if (lsm6dso::is_gyro_tag(variant, word[0])) {
        is_sample = slots_.add_gyro(slot, make_sample(now, payload, temperature), sample);
      } else if (lsm6dso::is_tag_of(variant, lsm6dso::kTagAccelerometer, word[0])) {
        is_sample = slots_.add_acceleration(slot, raw_of(payload), sample);
      } else {
        return Frame::corrupt;
      }
      return is_sample ? Frame::sample : Frame::no_sample;
    };
    const auto count = drain_fifo<kWordBytes>(bus_, lsm6dso::kFifoDataOutTag, words, out, decode);
    return count ? stamp(now, out.first(*count), words) : count;
  }

  /// @param words  left in the FIFO
  /// @return samples that are settled, which are moved to the front
  std::size_t stamp(core::Instant now, std::span<GyroSample> samples, std::size_t words) {
    const std::size_t waiting = samples.size() + slots_.samples_to_come(words);
    if (waiting > 0) sample_clock_.begin_batch(now, waiting);
    std::size_t settled = 0;
    for (GyroSample& sample : samples) {
      sample.time = sample_clock_.next();
      if (sample.time >= settled_at_) samples[settled++] = sample;
    }
    return settled;
  }

  constexpr void forget_words() {
    if constexpr (kHasAccelerometer) slots_.restart();
  }

  static constexpr std::array<std::int16_t, 3> raw_of(std::span<const std::uint8_t, 6> bytes) {
    return {decode_int16(bytes[0], bytes[1]), decode_int16(bytes[2], bytes[3]),
            decode_int16(bytes[4], bytes[5])};
  }

  [[nodiscard]] GyroSample make_sample(core::Instant time, std::span<const std::uint8_t, 6> bytes,
                                       core::Temperature temperature) const {
    GyroSample sample;
    sample.time = time;
    sample.temperature = temperature;
    sample.has_temperature = true;
    set_rates(sample, raw_of(bytes), lsb_, lsm6dso::kFullScaleRaw);
    return sample;
  }

  Bus bus_;
  Chosen settings_;
  core::AngularRate lsb_;
  core::Duration period_;
  ConfigurationTable<kEntries> configuration_;
  SampleClock sample_clock_;
  OverrunReport overrun_report_;
  core::Instant settled_at_;
  std::uint8_t zero_identities_ = 0;  ///< in a row
  Stage stage_ = Stage::off;
  [[no_unique_address]] Slots slots_;
};

}  // namespace zerorate::drivers
