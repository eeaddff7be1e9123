/// @file
/// Driver of the gyro, and on demand of the accelerometer, in TDK's ICM-42688-P and its relatives,
/// over SPI or I2C, polled by data-ready or through the FIFO.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

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
#include "drivers/icm42688/codec.hpp"
#include "drivers/icm42688/registers.hpp"

namespace zerorate::drivers {

namespace icm42688 {

enum class Mode : std::uint8_t {
  data_ready,  ///< each read() gives the latest sample; INT1 pulses when there is a new one
  fifo,        ///< the chip keeps up to 256 samples; INT1 pulses from the watermark on
};

/// Chosen once, for the life of the driver; a type for each part.
template <Part kPart>
struct SettingsOf {
  FullScale full_scale = FullScale::dps_250;  ///< larger: coarser LSB, 7.6 mdps at 250 deg/s
  OutputDataRate rate = OutputDataRate::hz_100;
  Mode mode = Mode::data_ready;
  std::uint8_t fifo_watermark = 8;  ///< samples that raise INT1; larger: fewer, longer bursts
};
using Settings = SettingsOf<Part::icm42688>;

/// Settings of any part.
struct Chosen {
  FullScale full_scale = FullScale::dps_250;
  OutputDataRate rate = OutputDataRate::hz_100;
  Mode mode = Mode::data_ready;
  std::uint8_t fifo_watermark = 0;
  Part part = Part::icm42688;
};
template <Part kPart>
[[nodiscard]] constexpr Chosen chosen(const SettingsOf<kPart>& settings) {
  return {.full_scale = settings.full_scale,
          .rate = settings.rate,
          .mode = settings.mode,
          .fifo_watermark = settings.fifo_watermark,
          .part = kPart};
}

}  // namespace icm42688

/// A GyroSource. Bus is SpiRegisters<...> or I2cRegisters<...>. SPI mode 0 or 3, up to 24 MHz.
///
/// Not thread-safe, not for interrupts. Cortex-M0+: about 0.5 KiB of stack in read(), without the
/// back end's.
/// @tparam kAccelerometer  whether samples carry the acceleration, which is measured at the gyro's
///         rate. A sample of the FIFO takes 16 bytes then, not 8: half as many fit, and a watermark
///         is at most 128 samples.
template <RegisterBus Bus, Accelerometer kAccelerometer = Accelerometer::off>
class Icm42688 {
  using Chosen = icm42688::Chosen;

 public:
  static constexpr bool kHasAccelerometer = kAccelerometer == Accelerometer::on;

  static constexpr std::size_t kAxes = 3;

  constexpr explicit Icm42688(Bus bus, icm42688::Settings settings = {})
      : Icm42688(icm42688::chosen(settings), icm42688::AccelerationRange::g_4, bus) {}
  /// A relative, by the type of its settings. One class drives them all: an image with two of them
  /// has its code once.
  template <icm42688::Part kPart>
  constexpr Icm42688(Bus bus, const icm42688::SettingsOf<kPart>& settings)
      : Icm42688(icm42688::chosen(settings), icm42688::AccelerationRange::g_4, bus) {}
  template <icm42688::Part kPart>
  constexpr Icm42688(Bus bus, const icm42688::SettingsOf<kPart>& settings,
                     icm42688::AccelerationRange range) requires(kAccelerometer ==
                                                                 Accelerometer::on)
      : Icm42688(icm42688::chosen(settings), range, bus) {}

  /// First call: identity, then software reset, then always not_ready. Later calls: not_ready until
  /// 1 ms has passed, then identity, configuration (39 transactions) and success. When it runs, or
  /// after any other error, a call begins anew. A chip that was left in another register bank is
  /// brought back first, which takes one call more.
  core::Result<void, DriverError> start(core::Instant now) {
    const bool is_reset_pending = stage_ == Stage::resetting;
    if (is_reset_pending && now - reset_at_ < icm42688::kResetTime) {
      return refused(DriverErrorCode::not_ready, icm42688::kDeviceConfig.address);
    }
    stage_ = Stage::off;
    if (const auto known = check_identity(); !known) return known;
    return is_reset_pending ? finish_start(now) : begin_reset(now);
  }

  /// Data-ready mode: two transactions if there is a sample (three or four where the chip measures
  /// in between), one if not. FIFO mode: two, and one
  /// for every 16 samples. Samples of the first 60 ms and more after power-up are dropped (README).
  /// Errors: not_ready before start() succeeded; fifo_overrun once for each gap; corrupt_data.
  core::Result<std::size_t, DriverError> read(core::Instant now, std::span<GyroSample> out) {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, icm42688::kPwrMgmt0.address);
    }
    if (out.empty()) return std::size_t{0};
    return settings_.mode == icm42688::Mode::fifo ? read_fifo(now, out) : read_latest(now, out[0]);
  }

  /// One transaction. Does not stop the driver: whether to start again is the application's choice.
  core::Result<void, DriverError> verify_next() {
    if (stage_ != Stage::running) {
      return refused(DriverErrorCode::not_ready, icm42688::kPwrMgmt0.address);
    }
    return configuration_.verify_next(bus_);
  }

  /// Nominal: the chip has no trim register.
  [[nodiscard]] constexpr core::Duration sample_period() const {
    return icm42688::sample_period(settings_.rate);
  }

  [[nodiscard]] constexpr core::AngularRate lsb() const { return lsb_; }
  [[nodiscard]] constexpr bool is_batched() const { return settings_.mode == icm42688::Mode::fifo; }

 private:
  constexpr Icm42688(const Chosen& settings, icm42688::AccelerationRange range, Bus bus)
      : bus_(bus),
        settings_(settings),
        lsb_(icm42688::lsb(settings.full_scale)),
        configuration_(configuration(settings, range)),
        scale_(scale(range)) {}

  enum class Stage : std::uint8_t { off, resetting, running };
  static constexpr std::size_t kGyroEntries = 13;
  static constexpr std::size_t kEntries = kGyroEntries + (kHasAccelerometer ? 1 : 0);
  static constexpr std::size_t kPacketBytes =
      kHasAccelerometer ? icm42688::kLongPacketBytes : icm42688::kFifoPacketBytes;
  using Scale = MemberWith<kAccelerometer, AccelerationScale>;

  static constexpr Scale scale(icm42688::AccelerationRange range) {
    if constexpr (kHasAccelerometer) {
      return {.lsb = icm42688::acceleration_lsb(range),
              .highest_raw = icm42688::kHighestRaw,
              .lowest_raw = icm42688::kLowestRaw};
    } else {
      return {};
    }
  }

  static constexpr ConfigurationTable<kEntries> configuration(const Chosen& settings,
                                                              icm42688::AccelerationRange range) {
    if constexpr (kHasAccelerometer) {
      const auto accelerometer =
          configure(icm42688::kAccelConfig0, icm42688::bits::kAccelConfig0All,
                    icm42688::encode_accel_config0(settings.rate, range));
      return ConfigurationTable<kEntries>{joined(entries(settings), std::array{accelerometer})};
    } else {
      return ConfigurationTable<kEntries>{entries(settings)};
    }
  }

  static constexpr std::array<ConfigurationEntry, kGyroEntries> entries(const Chosen& settings) {
    using namespace icm42688;
    namespace b = icm42688::bits;
    const bool is_fifo = settings.mode == Mode::fifo;
    const unsigned watermark_bytes = settings.fifo_watermark * kPacketBytes;
    if constexpr (kHasAccelerometer) ZERORATE_ASSERT(watermark_bytes <= kFifoBytes);
    constexpr unsigned kSensors =
        b::kFifoConfig1GyroEn | (kHasAccelerometer ? b::kFifoConfig1AccelEn : 0U);
    constexpr std::uint8_t kFilters =
        b::kGyroUiFiltBw | (kHasAccelerometer ? b::kAccelUiFiltBw : 0U);
    constexpr std::uint8_t kPower =
        b::kPwrMgmt0GyroLowNoise | (kHasAccelerometer ? b::kPwrMgmt0AccelLowNoise : 0U);
    const std::uint8_t packet =
        is_fifo ? b::kFifoConfig1WmGtTh | b::kFifoConfig1TempEn | kSensors : std::uint8_t{0};
    return {{
        configure(kRegBankSel, b::kRegBankSelBank, 0),
        // Count in bytes, not held at the last value, big-endian: its ones and zeros show a line
        // that is stuck either way.
        configure(kIntfConfig0, b::kIntfConfig0Data,
                  b::kIntfConfig0FifoCountBigEndian | b::kIntfConfig0SensorDataBigEndian),
        // Adaptive full-scale off: with it, chips were seen to stall for 1 to 2 ms above 100 deg/s.
        configure(kIntfConfig1, b::kIntfConfig1Afsr, b::kIntfConfig1AfsrOff),
        configure(kIntConfig, b::kIntConfigInt1,
                  b::kIntConfigInt1PushPull | b::kIntConfigInt1ActiveHigh),
        // The register's description: "For proper INT1 and INT2 pin operation".
        configure(kIntConfig1, b::kIntConfig1AsyncReset, 0),
        configure(kIntSource0, b::kIntSource0All,
                  is_fifo ? b::kIntSource0FifoThs : b::kIntSource0UiDrdy),
        // Half the output rate: what is above it would fold into the white noise.
        configure(kGyroAccelConfig0, kFilters, 0),
        configure(kFifoConfig1, b::kFifoConfig1All, packet),
        configure(kFifoConfig2, 0xFF, static_cast<std::uint8_t>(watermark_bytes & 0xFFU)),
        configure(kFifoConfig3, b::kFifoConfig3Wm,
                  static_cast<std::uint8_t>(watermark_bytes >> 8U)),
        configure(kFifoConfig, b::kFifoConfigMode, is_fifo ? b::kFifoModeStream : std::uint8_t{0}),
        configure(kGyroConfig0, b::kGyroConfig0All,
                  encode_gyro_config0(settings.rate, settings.full_scale)),
        // Last: for 200 us after it no register may be written. Temperature on.
        configure(kPwrMgmt0, b::kPwrMgmt0All, kPower),
    }};
  }

  core::Result<void, DriverError> check_identity() {
    std::array<std::uint8_t, 2> identity_and_bank{};
    if (const auto done = read_registers(bus_, icm42688::kWhoAmI, identity_and_bank); !done) {
      return done;
    }
    const unsigned bank = identity_and_bank[1];
    if (bank > 0 && bank <= icm42688::bits::kRegBankSelBank) {
      if (const auto done = write_register(bus_, icm42688::kRegBankSel, 0); !done) return done;
      return refused(DriverErrorCode::not_ready, icm42688::kRegBankSel.address);
    }
    if (identity_and_bank[0] != static_cast<std::uint8_t>(settings_.part)) {
      return refused(DriverErrorCode::wrong_identity, icm42688::kWhoAmI.address);
    }
    return {};
  }

  core::Result<void, DriverError> begin_reset(core::Instant now) {
    constexpr std::uint8_t kReset = icm42688::bits::kDeviceConfigSoftReset;
    if (const auto done = write_register(bus_, icm42688::kDeviceConfig, kReset); !done) return done;
    reset_at_ = now;
    stage_ = Stage::resetting;
    return refused(DriverErrorCode::not_ready, icm42688::kDeviceConfig.address);
  }

  core::Result<void, DriverError> finish_start(core::Instant now) {
    if (const auto done = configuration_.apply(bus_); !done) return done;
    settled_at_ = now + icm42688::settling_time(sample_period());
    sample_clock_.restart(now, sample_period());
    stage_ = Stage::running;
    return {};
  }

  core::Result<std::size_t, DriverError> read_latest(core::Instant now, GyroSample& out) {
    const auto outputs = read_settled_outputs();
    if (!outputs) return core::Unexpected{outputs.error()};
    if (!is_new(*outputs) || now < settled_at_) return std::size_t{0};
    const auto temperature =
        icm42688::decode_temperature(decode_int16((*outputs)[1], (*outputs)[0]));
    if (!make_sample(now, gyro_of(*outputs), temperature, out)) return std::size_t{0};
    if constexpr (kHasAccelerometer) {
      set_acceleration(out, raw_of(acceleration_of(*outputs)), scale_);
    }
    return std::size_t{1};
  }

  /// Temperature, accelerometer, gyro, the time of FSYNC, and INT_STATUS.
  using Outputs = std::array<std::uint8_t, 17>;

  static constexpr bool is_new(const Outputs& outputs) {
    return (outputs.back() & icm42688::bits::kIntStatusDataRdy) != 0;
  }
  static constexpr std::span<const std::uint8_t, 6> gyro_of(const Outputs& outputs) {
    return std::span<const std::uint8_t, 6>{&outputs[8], 6};
  }
  static constexpr std::span<const std::uint8_t, 6> acceleration_of(const Outputs& outputs) {
    return std::span<const std::uint8_t, 6>{&outputs[2], 6};
  }

  /// Data-ready falls when it is read. So it is read behind the data, in one burst, where it also
  /// shows that the line is not stuck. A conversion may fall into the burst: a sample counts when a
  /// second burst repeats it, and is dropped when it changed without data-ready.
  /// @return outputs that are not new: there is no sample
  core::Result<Outputs, DriverError> read_settled_outputs() {
    constexpr int kMostBursts = 4;  // a slow bus may meet a conversion in each of them
    auto outputs = read_outputs();
    for (int burst = 1; burst < kMostBursts && outputs && is_new(*outputs); ++burst) {
      const auto again = read_outputs();
      if (!again) return again;
      if constexpr (kHasAccelerometer) spoil_unless_equal(*outputs, *again);
      if (!is_new(*again))
        return std::ranges::equal(gyro_of(*outputs), gyro_of(*again)) ? outputs : again;
      outputs = again;
    }
    return outputs;
  }

  /// An acceleration that the second burst does not repeat is none.
  static constexpr void spoil_unless_equal(Outputs& outputs, const Outputs& again) {
    if (std::ranges::equal(acceleration_of(outputs), acceleration_of(again))) return;
    outputs[2] = static_cast<std::uint8_t>(static_cast<std::uint16_t>(icm42688::kInvalidRaw) >> 8U);
    outputs[3] = 0;
  }

  core::Result<Outputs, DriverError> read_outputs() {
    Outputs bytes{};
    if (const auto done = read_registers(bus_, icm42688::kTempData1, bytes); !done) {
      return core::Unexpected{done.error()};
    }
    if ((bytes.back() & icm42688::bits::kIntStatusAlwaysZero) != 0) {
      return refused(DriverErrorCode::corrupt_data, icm42688::kIntStatus.address);
    }
    return bytes;
  }

  core::Result<std::size_t, DriverError> read_fifo(core::Instant now, std::span<GyroSample> out) {
    const auto packets = read_fifo_level();
    if (!packets) return core::Unexpected{packets.error()};
    if (*packets == 0) return std::size_t{0};
    std::array<std::uint8_t, 2> bytes{};
    if (const auto done = read_registers(bus_, icm42688::kTempData1, bytes); !done) {
      return core::Unexpected{done.error()};
    }
    sample_clock_.begin_batch(now, *packets);
    return drain(*packets, out, icm42688::decode_temperature(decode_int16(bytes[1], bytes[0])));
  }

  core::Result<std::uint16_t, DriverError> read_fifo_level() {
    std::array<std::uint8_t, 3> bytes{};
    if (const auto done = read_registers(bus_, icm42688::kIntStatus, bytes); !done) {
      return core::Unexpected{done.error()};
    }
    const auto status = icm42688::decode_fifo_status<kPacketBytes>(bytes[0], bytes[1], bytes[2]);
    if (!status.is_plausible) {
      return refused(DriverErrorCode::corrupt_data, icm42688::kIntStatus.address);
    }
    if (overrun_report_.is_due(status.is_full)) {
      sample_clock_.lose_count();
      return refused(DriverErrorCode::fifo_overrun, icm42688::kIntStatus.address);
    }
    return status.packets;
  }

  core::Result<std::size_t, DriverError> drain(std::size_t packets, std::span<GyroSample> out,
                                               core::Temperature temperature) {
    const auto decode = [&](std::span<const std::uint8_t, kPacketBytes> packet,
                            GyroSample& sample) {
      if (!is_our_header(packet[0])) return Frame::corrupt;
      const core::Instant time = sample_clock_.next();
      if (time < settled_at_) return Frame::no_sample;
      constexpr std::size_t kGyroAt = kHasAccelerometer ? 7 : 1;
      const auto gyro = packet.template subspan<kGyroAt, 6>();
      if (!make_sample(time, gyro, temperature, sample)) return Frame::no_sample;
      if constexpr (kHasAccelerometer) {
        set_acceleration(sample, raw_of(packet.template subspan<1, 6>()), scale_);
      }
      return Frame::sample;
    };
    return drain_fifo<kPacketBytes>(bus_, icm42688::kFifoData, packets, out, decode);
  }

  static constexpr bool is_our_header(std::uint8_t header) {
    return kHasAccelerometer ? icm42688::is_header_of_both(header)
                             : icm42688::is_gyro_header(header);
  }

  static constexpr std::array<std::int16_t, 3> raw_of(std::span<const std::uint8_t, 6> bytes) {
    return {decode_int16(bytes[1], bytes[0]), decode_int16(bytes[3], bytes[2]),
            decode_int16(bytes[5], bytes[4])};
  }

  /// False if the chip reports that it has no sample.
  bool make_sample(core::Instant time, std::span<const std::uint8_t, 6> bytes,
                   core::Temperature temperature, GyroSample& out) const {
    const std::array raw = raw_of(bytes);
    if (std::ranges::find(raw, icm42688::kInvalidRaw) != raw.end()) return false;
    out.time = time;
    out.temperature = temperature;
    out.has_temperature = true;
    set_rates(out, raw, lsb_, icm42688::kHighestRaw, icm42688::kLowestRaw);
    return true;
  }

  Bus bus_;
  Chosen settings_;
  core::AngularRate lsb_;
  ConfigurationTable<kEntries> configuration_;
  SampleClock sample_clock_;
  OverrunReport overrun_report_;
  core::Instant reset_at_;
  core::Instant settled_at_;
  Stage stage_ = Stage::off;
  [[no_unique_address]] Scale scale_;
};

}  // namespace zerorate::drivers
