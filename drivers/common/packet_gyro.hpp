/// @file
/// Common part of the drivers of gyros whose FIFO has packets with a header, as TDK's newer ones.
#pragma once

#include <algorithm>
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
#include "drivers/common/gyro_source.hpp"
#include "drivers/common/register_access.hpp"
#include "drivers/common/sample_clock.hpp"

namespace zerorate::drivers {

/// Content of a packet as its header has it: message, accelerometer, gyro, 20 bits. The other bits
/// mark time stamps and changes of rate.
inline constexpr std::uint8_t kPacketContent = 0xF0;

/// True for the header of a packet with gyro data alone, 16 bits.
[[nodiscard]] constexpr bool is_gyro_header(std::uint8_t header) {
  constexpr std::uint8_t kGyroAlone = 0x20;
  return (header & kPacketContent) == kGyroAlone;
}
/// True for the header of a packet with data of both sensors, 16 bits.
[[nodiscard]] constexpr bool is_header_of_both(std::uint8_t header) {
  constexpr std::uint8_t kAccelAndGyro = 0x60;
  return (header & kPacketContent) == kAccelAndGyro;
}

/// "Packet 2": header, six bytes of gyro, one of temperature.
inline constexpr unsigned kShortPacketBytes = 8;
/// "Packet 3": header, six bytes of accelerometer, six of gyro, one of temperature, two of time.
inline constexpr unsigned kLongPacketBytes = 16;

using RawAxes = std::array<std::int16_t, 3>;

/// Stands for "no sample".
inline constexpr std::int16_t kInvalidRaw = -32768;

/// Content of the data registers.
struct RawOutputs {
  bool is_new = false;  ///< they came since they were read last
  RawAxes gyro{};
  RawAxes acceleration{};
  std::int16_t temperature = 0;
};

/// State of the FIFO at a reading.
struct PacketFifoState {
  std::uint16_t packets = 0;  ///< complete packets that wait
  bool is_full = false;       ///< samples may be lost
  std::int16_t temperature = 0;
};

/// How a driver waits for the chip.
enum class PacketGyroStage : std::uint8_t { off, resetting, waking, running };

/// A GyroSource but for its constructors.
///
/// Not thread-safe, not for interrupts. Cortex-M0+: about 0.5 KiB of stack in read(), without the
/// back end's.
/// @tparam Map  what differs between families of chips, all of it static:
/// - `Chosen`, the settings; `AccelerationRange`; `is_fifo(chosen)`
/// - `kReset`, `kResetCommand`, `kResetTime`; `kFifoData`, `kStatus`; `kPower` for errors
/// - `check_identity(bus, chosen)`
/// - `prepare(bus)` after a reset, before the configuration
/// - `entries<has_accelerometer>(chosen, range)` in the order in which they are written, the last
///   `kAwakeEntries<has_accelerometer>` after the sensors have been on for `kWakeTime`
/// - `read_outputs<has_accelerometer>(bus)`, `read_fifo_state<packet_bytes>(bus)`
/// - `kKeepsNewest`: a full FIFO drops the oldest packets. Else it is emptied by `flush(bus)`, and
///   also where the place in it may be lost.
/// - `axes(bytes)`, the byte order of the packets
/// - `lsb(chosen)`, `acceleration_lsb(range)`, `temperature(raw)`, `sample_period(chosen)`,
///   `settling_time(period)`, `kHighestRaw`, `kLowestRaw`
/// @tparam kAccelerometer  whether samples carry the acceleration, which is measured at the gyro's
///         rate. A sample of the FIFO takes 16 bytes then, not 8: half as many fit.
template <class Map, RegisterBus Bus, Accelerometer kAccelerometer>
class PacketGyro {
  using Chosen = typename Map::Chosen;
  using AccelerationRange = typename Map::AccelerationRange;
  using Stage = PacketGyroStage;

 public:
  static constexpr bool kHasAccelerometer = kAccelerometer == Accelerometer::on;
  static constexpr std::size_t kAxes = 3;

  /// First call: identity, then software reset, then always not_ready. Later calls: not_ready until
  /// the chip's time has passed, then identity, configuration and success; a chip of which some
  /// registers need a running sensor takes one more such step. When it runs, or after any other
  /// error, a call begins anew.
  core::Result<void, DriverError> start(core::Instant now) {
    const Stage stage = stage_;
    if (is_waiting(now)) return refused(DriverErrorCode::not_ready, Map::kReset.address);
    stage_ = Stage::off;
    if (const auto known = Map::check_identity(bus_, settings_); !known) return known;
    switch (stage) {
      case Stage::resetting:
        return configure_asleep(now);
      case Stage::waking:
        return finish_start(now);
      default:
        return wait_after(write_register(bus_, Map::kReset, Map::kResetCommand), now,
                          Stage::resetting);
    }
  }

  /// Samples of the first time after power-up are dropped (README). Errors: not_ready before
  /// start() succeeded; fifo_overrun once for each gap; corrupt_data.
  core::Result<std::size_t, DriverError> read(core::Instant now, std::span<GyroSample> out) {
    if (stage_ != Stage::running) return refused(DriverErrorCode::not_ready, Map::kPower.address);
    if (out.empty()) return std::size_t{0};
    return is_batched() ? read_fifo(now, out) : read_latest(now, out[0]);
  }

  /// Does not stop the driver: whether to start again is the application's choice.
  core::Result<void, DriverError> verify_next() {
    if (stage_ != Stage::running) return refused(DriverErrorCode::not_ready, Map::kPower.address);
    return configuration_.verify_next(bus_);
  }

  /// Nominal: the trim of the chip's clock is not read.
  [[nodiscard]] constexpr core::Duration sample_period() const {
    return Map::sample_period(settings_);
  }
  [[nodiscard]] constexpr core::AngularRate lsb() const { return lsb_; }
  [[nodiscard]] constexpr bool is_batched() const { return Map::is_fifo(settings_); }

 protected:
  constexpr PacketGyro(const Chosen& settings, AccelerationRange range, Bus bus)
      : bus_(bus),
        settings_(settings),
        lsb_(Map::lsb(settings)),
        configuration_(Map::template entries<kHasAccelerometer>(settings, range)),
        scale_(scale(range)) {}

 private:
  static constexpr std::size_t kEntries =
      Map::template entries<kHasAccelerometer>(Chosen{}, AccelerationRange{}).size();
  static constexpr std::size_t kAwake = Map::template kAwakeEntries<kHasAccelerometer>;
  static constexpr std::size_t kPacketBytes =
      kHasAccelerometer ? kLongPacketBytes : kShortPacketBytes;
  using Scale = MemberWith<kAccelerometer, AccelerationScale>;

  static constexpr Scale scale(AccelerationRange range) {
    if constexpr (kHasAccelerometer) {
      return {.lsb = Map::acceleration_lsb(range),
              .highest_raw = Map::kHighestRaw,
              .lowest_raw = Map::kLowestRaw};
    } else {
      return {};
    }
  }

  [[nodiscard]] bool is_waiting(core::Instant now) const {
    const core::Duration passed = now - commanded_at_;
    return (stage_ == Stage::resetting && passed < Map::kResetTime) ||
           (stage_ == Stage::waking && passed < Map::kWakeTime);
  }

  core::Result<void, DriverError> wait_after(const core::Result<void, DriverError>& written,
                                             core::Instant now, Stage stage) {
    if (!written) return written;
    commanded_at_ = now;
    stage_ = stage;
    return refused(DriverErrorCode::not_ready, Map::kReset.address);
  }

  core::Result<void, DriverError> configure_asleep(core::Instant now) {
    if constexpr (kAwake == 0) {
      return finish_start(now);
    } else {
      if (const auto done = Map::prepare(bus_); !done) return done;
      return wait_after(configuration_.apply(bus_, 0, kEntries - kAwake), now, Stage::waking);
    }
  }

  core::Result<void, DriverError> finish_start(core::Instant now) {
    constexpr std::size_t kFirst = kAwake == 0 ? 0 : kEntries - kAwake;
    if (const auto done = configuration_.apply(bus_, kFirst, kEntries); !done) return done;
    settled_at_ = now + Map::settling_time(sample_period());
    sample_clock_.restart(now, sample_period());
    is_place_lost_ = false;
    stage_ = Stage::running;
    return {};
  }

  core::Result<std::size_t, DriverError> read_latest(core::Instant now, GyroSample& out) {
    const auto outputs = Map::template read_outputs<kHasAccelerometer>(bus_);
    if (!outputs) return core::Unexpected{outputs.error()};
    if (!outputs->is_new || now < settled_at_) return std::size_t{0};
    const auto temperature = Map::temperature(outputs->temperature);
    if (!make_sample(now, outputs->gyro, temperature, out)) return std::size_t{0};
    if constexpr (kHasAccelerometer) set_acceleration(out, outputs->acceleration, scale_);
    return std::size_t{1};
  }

  core::Result<std::size_t, DriverError> read_fifo(core::Instant now, std::span<GyroSample> out) {
    if constexpr (!Map::kKeepsNewest) {
      if (is_place_lost_) {
        if (const auto done = flush(); !done) return core::Unexpected{done.error()};
      }
    }
    const auto fifo = Map::template read_fifo_state<kPacketBytes>(bus_);
    if (!fifo) return core::Unexpected{fifo.error()};
    if (is_overrun(*fifo)) return report_overrun();
    if (fifo->packets == 0) return std::size_t{0};
    sample_clock_.begin_batch(now, fifo->packets);
    const auto count = drain(fifo->packets, out, Map::temperature(fifo->temperature));
    // After a burst that broke off the place in the FIFO is unknown.
    if constexpr (!Map::kKeepsNewest) is_place_lost_ = !count;
    return count;
  }

  [[nodiscard]] bool is_overrun(const PacketFifoState& fifo) {
    return Map::kKeepsNewest ? overrun_report_.is_due(fifo.is_full) : fifo.is_full;
  }

  core::Result<std::size_t, DriverError> report_overrun() {
    sample_clock_.lose_count();
    if constexpr (!Map::kKeepsNewest) {
      is_place_lost_ = true;
      if (const auto done = flush(); !done) return core::Unexpected{done.error()};
    }
    return refused(DriverErrorCode::fifo_overrun, Map::kStatus.address);
  }

  core::Result<void, DriverError> flush() requires(!Map::kKeepsNewest) {
    sample_clock_.lose_count();
    const auto done = Map::flush(bus_);
    if (done) is_place_lost_ = false;
    return done;
  }

  core::Result<std::size_t, DriverError> drain(std::size_t packets, std::span<GyroSample> out,
                                               core::Temperature temperature) {
    const auto decode = [&](std::span<const std::uint8_t, kPacketBytes> packet,
                            GyroSample& sample) {
      if (!is_our_header(packet[0])) return Frame::corrupt;
      const core::Instant time = sample_clock_.next();
      if (time < settled_at_) return Frame::no_sample;
      constexpr std::size_t kGyroAt = kHasAccelerometer ? 7 : 1;
      const RawAxes gyro = Map::axes(packet.template subspan<kGyroAt, 6>());
      if (!make_sample(time, gyro, temperature, sample)) return Frame::no_sample;
      if constexpr (kHasAccelerometer) {
        set_acceleration(sample, Map::axes(packet.template subspan<1, 6>()), scale_);
      }
      return Frame::sample;
    };
    return drain_fifo<kPacketBytes>(bus_, Map::kFifoData, packets, out, decode);
  }

  static constexpr bool is_our_header(std::uint8_t header) {
    return kHasAccelerometer ? is_header_of_both(header) : is_gyro_header(header);
  }

  /// False if the chip reports that it has no sample.
  bool make_sample(core::Instant time, const RawAxes& raw, core::Temperature temperature,
                   GyroSample& out) const {
    if (std::ranges::find(raw, kInvalidRaw) != raw.end()) return false;
    out.time = time;
    out.temperature = temperature;
    out.has_temperature = true;
    set_rates(out, raw, lsb_, Map::kHighestRaw, Map::kLowestRaw);
    return true;
  }

  Bus bus_;
  Chosen settings_;
  core::AngularRate lsb_;
  ConfigurationTable<kEntries> configuration_;
  SampleClock sample_clock_;
  OverrunReport overrun_report_;
  core::Instant commanded_at_;
  core::Instant settled_at_;
  bool is_place_lost_ = false;
  Stage stage_ = Stage::off;
  [[no_unique_address]] Scale scale_;
};

}  // namespace zerorate::drivers
