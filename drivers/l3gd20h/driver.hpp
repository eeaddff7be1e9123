/// @file
/// Driver of ST's gyroscopes L3GD20H, L3GD20 and L3G4200D, over SPI or I2C, polled by data-ready or
/// through the FIFO.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/assert.hpp"
#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "drivers/common/configuration_table.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/fifo_drain.hpp"
#include "drivers/common/gyro_source.hpp"
#include "drivers/common/register_access.hpp"
#include "drivers/common/sample_clock.hpp"
#include "drivers/l3gd20h/codec.hpp"
#include "drivers/l3gd20h/registers.hpp"

namespace zerorate::drivers {

namespace l3gd20h {

enum class Mode : std::uint8_t {
  data_ready,  ///< each read() gives the latest sample; DRDY/INT2 rises when there is a new one
  fifo,        ///< the chip keeps up to 31 samples; DRDY/INT2 rises at the watermark
};

/// Chosen once, for the life of the driver; a type for each part.
template <Part kPart>
struct SettingsOf {
  FullScale full_scale = FullScale::dps_250;  ///< larger: coarser LSB, 8.75 mdps at 250 deg/s
  OutputDataRate rate = OutputDataRate::times_1;
  Mode mode = Mode::data_ready;
  std::uint8_t fifo_watermark = 8;  ///< samples that raise DRDY/INT2, at most 31
};
using Settings = SettingsOf<Part::l3gd20h>;

/// Settings of any part.
struct Chosen {
  FullScale full_scale = FullScale::dps_250;
  OutputDataRate rate = OutputDataRate::times_1;
  Mode mode = Mode::data_ready;
  std::uint8_t fifo_watermark = 0;
  const Variant* variant = nullptr;
};
template <Part kPart>
[[nodiscard]] constexpr Chosen chosen(const SettingsOf<kPart>& settings) {
  return {.full_scale = settings.full_scale,
          .rate = settings.rate,
          .mode = settings.mode,
          .fifo_watermark = settings.fifo_watermark,
          .variant = &l3gd20h::variant(kPart)};
}

}  // namespace l3gd20h

/// A GyroSource without a thermometer: the chip's own has no known zero. Bus is SpiRegisters<...>
/// or I2cRegisters<...>. SPI mode 0 or 3, up to 10 MHz.
///
/// Not thread-safe, not for interrupts. Cortex-M0+: about 0.5 KiB of stack in read(), without the
/// back end's.
template <RegisterBus Bus>
class L3gd20h {
  using Chosen = l3gd20h::Chosen;

 public:
  static constexpr std::size_t kAxes = 3;

  constexpr explicit L3gd20h(Bus bus, l3gd20h::Settings settings = {})
      : L3gd20h(l3gd20h::chosen(settings), bus) {}
  /// A relative, by the type of its settings. One class drives them all.
  template <l3gd20h::Part kPart>
  constexpr L3gd20h(Bus bus, const l3gd20h::SettingsOf<kPart>& settings)
      : L3gd20h(l3gd20h::chosen(settings), bus) {}

  /// First call: identity, then the FIFO emptied and the trimming loaded again, then always
  /// not_ready. Later calls: not_ready until 10 ms have passed, then identity, configuration (21
  /// transactions) and success. When it runs, or after any other error, a call begins anew.
  core::Result<void, DriverError> start(core::Instant now) {
    const bool is_boot_pending = stage_ == Stage::booting;
    if (is_boot_pending && now - booted_at_ < l3gd20h::kBootTime) {
      return refused(DriverErrorCode::not_ready, l3gd20h::kCtrl5.address);
    }
    stage_ = Stage::off;
    if (const auto known = check_identity(); !known) return known;
    return is_boot_pending ? finish_start(now) : begin_boot(now);
  }

  /// Data-ready mode: three transactions if there is a sample, one if not. FIFO mode: one if there
  /// is none, else three, and one more for every 16 samples beyond 16. Samples of the first 300 ms
  /// and more after power-up are dropped (README). Errors: not_ready before start() succeeded;
  /// fifo_overrun once for each gap, with all that was in the FIFO; corrupt_data.
  core::Result<std::size_t, DriverError> read(core::Instant now, std::span<GyroSample> out) {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, l3gd20h::kCtrl1.address);
    }
    if (out.empty()) return std::size_t{0};
    blank_frames_.begin_reading();
    return is_batched() ? read_fifo(now, out) : unless_stuck(read_latest(now, out[0]));
  }

  /// One transaction. Does not stop the driver: whether to start again is the application's choice.
  core::Result<void, DriverError> verify_next() {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, l3gd20h::kCtrl1.address);
    }
    return configuration_.verify_next(bus_);
  }

  /// Nominal: the chip has no trim register.
  [[nodiscard]] constexpr core::Duration sample_period() const {
    return l3gd20h::sample_period(*settings_.variant, settings_.rate);
  }
  [[nodiscard]] constexpr core::AngularRate lsb() const { return lsb_; }
  [[nodiscard]] constexpr bool is_batched() const { return settings_.mode == l3gd20h::Mode::fifo; }

 private:
  constexpr L3gd20h(const Chosen& settings, Bus bus)
      : bus_(bus),
        settings_(settings),
        lsb_(l3gd20h::lsb(settings.full_scale)),
        configuration_(configuration(settings)) {}

  enum class Stage : std::uint8_t { off, booting, running };
  static constexpr std::size_t kEntries = 7;
  static constexpr std::size_t kFrameBytes = l3gd20h::kFifoFrameBytes;
  using FrameBytes = std::span<const std::uint8_t, kFrameBytes>;

  static constexpr std::uint8_t fifo_ctrl(const Chosen& settings) {
    return static_cast<std::uint8_t>(l3gd20h::bits::kFifoCtrlStream | settings.fifo_watermark);
  }

  /// Whole registers, since no reset brings back their values. Where the chip does not have a
  /// register, the entry before it stands twice.
  static constexpr ConfigurationTable<kEntries> configuration(const Chosen& settings) {
    using namespace l3gd20h;
    namespace b = l3gd20h::bits;
    ZERORATE_ASSERT(settings.fifo_watermark <= b::kFifoSrcLevel);
    const bool is_fifo = settings.mode == Mode::fifo;
    const auto range = static_cast<std::uint8_t>(settings.full_scale);
    // A stuck line changes the ones or the zeros of this register.
    const auto interface = configure(kCtrl4, 0xFF, static_cast<std::uint8_t>(b::kCtrl4Bdu | range));
    return ConfigurationTable<kEntries>{{{
        interface,
        settings.variant->has_low_odr ? configure(kLowOdr, b::kLowOdrAll, 0) : interface,
        // No trigger, and no high-pass filter here or in CTRL5: it would remove the bias.
        configure(kCtrl2, 0xFF, 0),
        configure(kCtrl3, 0xFF, is_fifo ? b::kCtrl3Watermark : b::kCtrl3DataReady),
        configure(kCtrl5, 0xFF, is_fifo ? b::kCtrl5FifoEn : std::uint8_t{0}),
        configure(kFifoCtrl, 0xFF, is_fifo ? fifo_ctrl(settings) : std::uint8_t{0}),
        configure(kCtrl1, 0xFF, encode_ctrl1(settings.rate)),
    }}};
  }

  core::Result<void, DriverError> check_identity() {
    const auto identity = read_register(bus_, l3gd20h::kWhoAmI);
    if (!identity) return core::Unexpected{identity.error()};
    if (*identity == settings_.variant->identity) return {};
    return refused(DriverErrorCode::wrong_identity, l3gd20h::kWhoAmI.address);
  }

  core::Result<void, DriverError> begin_boot(core::Instant now) {
    auto done = write_register(bus_, l3gd20h::kFifoCtrl, 0);
    if (done) done = write_register(bus_, l3gd20h::kCtrl5, l3gd20h::bits::kCtrl5Boot);
    if (!done) return done;
    booted_at_ = now;
    stage_ = Stage::booting;
    return refused(DriverErrorCode::not_ready, l3gd20h::kCtrl5.address);
  }

  core::Result<void, DriverError> finish_start(core::Instant now) {
    if (const auto done = configuration_.apply(bus_); !done) return done;
    settled_at_ = now + l3gd20h::settling_time(sample_period());
    sample_clock_.restart(now, sample_period());
    blank_frames_.restart();
    stage_ = Stage::running;
    return {};
  }

  core::Result<std::size_t, DriverError> read_latest(core::Instant now, GyroSample& out) {
    constexpr std::uint8_t kNew = l3gd20h::bits::kStatusZyxda;
    const auto status = read_register(bus_, l3gd20h::kStatus);
    if (!status) return core::Unexpected{status.error()};
    if ((*status & kNew) == 0) return std::size_t{0};
    // Only now: reading the outputs clears data-ready. The status comes once more in front of them.
    std::array<std::uint8_t, 1 + kFrameBytes> bytes{};
    const auto done = read_registers(bus_, l3gd20h::kStatusAndOutputs<kIsSpi<Bus>>, bytes);
    if (!done) return core::Unexpected{done.error()};
    if ((bytes[0] & kNew) == 0) {
      return refused(DriverErrorCode::corrupt_data, l3gd20h::kStatus.address);
    }
    const bool is_sample = make_sample(now, std::span{bytes}.template last<kFrameBytes>(), out);
    return std::size_t{is_sample ? 1U : 0U};
  }

  core::Result<std::size_t, DriverError> read_fifo(core::Instant now, std::span<GyroSample> out) {
    const auto frames = read_fifo_level();
    if (!frames) return core::Unexpected{frames.error()};
    if (*frames == 0) return std::size_t{0};
    sample_clock_.begin_batch(now, *frames);
    const auto decode = [&](FrameBytes bytes, GyroSample& sample) {
      return make_sample(sample_clock_.next(), bytes, sample) ? Frame::sample : Frame::no_sample;
    };
    const auto count = unless_stuck(
        drain_fifo<kFrameBytes>(bus_, l3gd20h::kOutputs<kIsSpi<Bus>>, *frames, out, decode));
    // The place in the FIFO is unknown after a burst that broke off: begin at a frame's start.
    if (!count) static_cast<void>(clear_fifo());
    return count;
  }

  core::Result<std::uint8_t, DriverError> read_fifo_level() {
    const auto byte = read_register(bus_, l3gd20h::kFifoSrc);
    if (!byte) return core::Unexpected{byte.error()};
    const l3gd20h::FifoStatus status = l3gd20h::decode_fifo_src(*byte);
    if (!status.is_plausible) {
      return refused(DriverErrorCode::corrupt_data, l3gd20h::kFifoSrc.address);
    }
    if (!status.is_full) return status.frames;
    // How many were overwritten is not known, and so are the times of the others.
    if (const auto done = clear_fifo(); !done) return core::Unexpected{done.error()};
    return refused(DriverErrorCode::fifo_overrun, l3gd20h::kFifoSrc.address);
  }

  /// Bypass empties it.
  core::Result<void, DriverError> clear_fifo() {
    sample_clock_.lose_count();
    const auto done = write_register(bus_, l3gd20h::kFifoCtrl, 0);
    return done ? write_register(bus_, l3gd20h::kFifoCtrl, fifo_ctrl(settings_)) : done;
  }

  /// False if there is none: the chip settles, or the frame was not read.
  bool make_sample(core::Instant time, FrameBytes bytes, GyroSample& out) {
    const std::array raw{decode_int16(bytes[0], bytes[1]), decode_int16(bytes[2], bytes[3]),
                         decode_int16(bytes[4], bytes[5])};
    if (blank_frames_.is_blank(raw) || time < settled_at_) return false;
    out = GyroSample{.time = time};
    set_rates(out, raw, lsb_, l3gd20h::kFullScaleRaw);
    return true;
  }

  /// Frames carry no mark. The output of a line that got stuck is no sample.
  core::Result<std::size_t, DriverError> unless_stuck(
      core::Result<std::size_t, DriverError> count) {
    if (!count || *count == 0) return count;
    const auto known = check_identity();
    if (known) return count;
    if (known.error().code == DriverErrorCode::wrong_identity) {
      return refused(DriverErrorCode::corrupt_data, l3gd20h::kWhoAmI.address);
    }
    return core::Unexpected{known.error()};
  }

  Bus bus_;
  Chosen settings_;
  core::AngularRate lsb_;
  ConfigurationTable<kEntries> configuration_;
  SampleClock sample_clock_;
  BlankFrames blank_frames_;
  core::Instant booted_at_;
  core::Instant settled_at_;
  Stage stage_ = Stage::off;
};

}  // namespace zerorate::drivers
