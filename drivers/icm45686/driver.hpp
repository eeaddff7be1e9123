/// @file
/// Driver of the gyro, and on demand of the accelerometer, in TDK's ICM-45686, over SPI or I2C,
/// polled by data-ready or through the FIFO.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/gyro_source.hpp"
#include "drivers/common/packet_gyro.hpp"
#include "drivers/common/register_access.hpp"
#include "drivers/icm45686/codec.hpp"
#include "drivers/icm45686/configuration.hpp"
#include "drivers/icm45686/indirect_registers.hpp"
#include "drivers/icm45686/registers.hpp"

namespace zerorate::drivers {

namespace icm45686 {

/// Facts of the chip for PacketGyro.
struct Map {
  using Chosen = Settings;
  using AccelerationRange = icm45686::AccelerationRange;
  static constexpr auto kReset = kRegMisc2;
  static constexpr std::uint8_t kResetCommand = bits::kRegMisc2SoftReset;
  static constexpr core::Duration kResetTime = icm45686::kResetTime;
  static constexpr core::Duration kWakeTime = icm45686::kWakeTime;
  static constexpr auto kFifoData = icm45686::kFifoData;
  static constexpr auto kStatus = kInt1Status0;
  static constexpr auto kPower = kPwrMgmt0;
  static constexpr bool kKeepsNewest = false;
  static constexpr std::int16_t kHighestRaw = icm45686::kHighestRaw;
  static constexpr std::int16_t kLowestRaw = icm45686::kLowestRaw;
  template <bool kHasAccelerometer>
  static constexpr std::size_t kAwakeEntries = icm45686::kAwakeEntries +
                                               (kHasAccelerometer ? 1 : 0);

  static constexpr bool is_fifo(const Chosen& chosen) { return chosen.mode == Mode::fifo; }
  static constexpr core::AngularRate lsb(const Chosen& chosen) {
    return icm45686::lsb(chosen.full_scale);
  }
  static constexpr core::Acceleration acceleration_lsb(AccelerationRange range) {
    return icm45686::acceleration_lsb(range);
  }
  static constexpr core::Temperature temperature(std::int16_t raw) {
    return decode_temperature(raw);
  }
  static constexpr core::Duration sample_period(const Chosen& chosen) {
    return icm45686::sample_period(chosen.rate);
  }
  static constexpr core::Duration settling_time(core::Duration period) {
    return icm45686::settling_time(period);
  }
  template <bool kHasAccelerometer>
  static constexpr auto entries(const Chosen& chosen, AccelerationRange range) {
    return configuration<kHasAccelerometer>(chosen, range);
  }
  static constexpr RawAxes axes(std::span<const std::uint8_t, 6> bytes) {
    return {decode_int16(bytes[0], bytes[1]), decode_int16(bytes[2], bytes[3]),
            decode_int16(bytes[4], bytes[5])};
  }

  template <RegisterBus Bus>
  static core::Result<void, DriverError> check_identity(Bus& bus, const Chosen& /*unused*/) {
    const auto identity = read_register(bus, kWhoAmI);
    if (!identity) return core::Unexpected{identity.error()};
    if (*identity == kWhoAmI.reset) return {};
    return refused(DriverErrorCode::wrong_identity, kWhoAmI.address);
  }

  /// The pin is set while no interrupt is enabled, and the depth while the FIFO is closed.
  template <RegisterBus Bus>
  static core::Result<void, DriverError> prepare(Bus& bus) {
    if (const auto done = write_register(bus, kInt1Config0, 0); !done) return done;
    return write_register(bus, kFifoConfig0, bits::kFifoDepth2k);
  }

  /// Status, data, and the status again, which is 0 where the data are of one instant: no burst
  /// can have both, because FIFO_DATA lies between them, where a burst would stay.
  template <bool kHasAccelerometer, RegisterBus Bus>
  static core::Result<RawOutputs, DriverError> read_outputs(Bus& bus) {
    constexpr int kMostReadings = 3;  // a slow bus may meet a conversion in each of them
    auto status = read_status(bus);
    RawOutputs outputs;
    for (int i = 0; i < kMostReadings && status && (status->int1 & bits::kInt1Drdy) != 0; ++i) {
      if (const auto done = read_data(bus, outputs); !done) return core::Unexpected{done.error()};
      status = read_status(bus);
    }
    if (!status) return core::Unexpected{status.error()};
    return outputs;
  }

  /// The count is read twice, and the second one counts (README).
  template <std::size_t kPacketBytes, RegisterBus Bus>
  static core::Result<PacketFifoState, DriverError> read_fifo_state(Bus& bus) {
    // Temperature, time, power, a reserved one, and the count.
    std::array<std::uint8_t, 8> bytes{};
    if (const auto done = read_registers(bus, kTempData, bytes); !done) {
      return core::Unexpected{done.error()};
    }
    if (!is_power_plausible(bytes[4])) return corrupt(kPwrMgmt0.address);
    std::array<std::uint8_t, 2> level{};
    if (const auto done = read_registers(bus, kFifoCount0, level); !done) {
      return core::Unexpected{done.error()};
    }
    const FifoCount count = decode_fifo_count(level[0], level[1], kPacketBytes);
    if (!count.is_plausible) return corrupt(kFifoCount0.address);
    const auto status = read_status(bus);
    if (!status) return core::Unexpected{status.error()};
    if (status->is_flushing) return PacketFifoState{};
    const bool was_full = (status->int1 & bits::kInt1FifoFull) != 0;
    return PacketFifoState{.packets = count.packets,
                           .is_full = was_full || count.is_full,
                           .temperature = decode_int16(bytes[0], bytes[1])};
  }

  /// Two transactions. It ends by itself; until then the FIFO counts as empty.
  template <RegisterBus Bus>
  static core::Result<void, DriverError> flush(Bus& bus) {
    const auto config = read_register(bus, kFifoConfig2);
    if (!config) return core::Unexpected{config.error()};
    return write_register(bus, kFifoConfig2,
                          static_cast<std::uint8_t>(*config | bits::kFifoConfig2Flush));
  }

 private:
  static core::Unexpected<DriverError> corrupt(std::uint8_t address) {
    return refused(DriverErrorCode::corrupt_data, address);
  }

  struct Status {
    std::uint8_t int1;  ///< INT1_STATUS0, which falls when it is read
    bool is_flushing;   ///< the FIFO is being emptied
  };

  /// FIFO_CONFIG2 ends the burst and shows whether the line lives.
  template <RegisterBus Bus>
  static core::Result<Status, DriverError> read_status(Bus& bus) {
    std::array<std::uint8_t, kFifoConfig2.address - kInt1Status0.address + 1U> bytes{};
    if (const auto done = read_registers(bus, kInt1Status0, bytes); !done) {
      return core::Unexpected{done.error()};
    }
    if (!is_fifo_config2_plausible(bytes.back())) return corrupt(kFifoConfig2.address);
    return Status{bytes[0], (bytes.back() & bits::kFifoConfig2Flush) != 0};
  }

  /// Accelerometer, gyro, temperature, time; PWR_MGMT0 ends the burst and shows that the line
  /// lives.
  template <RegisterBus Bus>
  static core::Result<void, DriverError> read_data(Bus& bus, RawOutputs& outputs) {
    constexpr std::size_t kSize = 17;
    std::array<std::uint8_t, kSize> bytes{};
    if (const auto done = read_registers(bus, kAccelDataX, bytes); !done) return done;
    if (!is_power_plausible(bytes.back())) return corrupt(kPwrMgmt0.address);
    const auto all = std::span<const std::uint8_t, kSize>{bytes};
    outputs = {.is_new = true,
               .gyro = axes(all.template subspan<6, 6>()),
               .acceleration = axes(all.template first<6>()),
               .temperature = decode_int16(bytes[12], bytes[13])};
    return {};
  }
};

}  // namespace icm45686

/// A GyroSource (packet_gyro.hpp). Bus is SpiRegisters<...> or I2cRegisters<...>. SPI mode 0 or 3,
/// up to 24 MHz. Errors of a register behind the window have bit 7 set in DriverError::reg.
///
/// read(), data-ready mode: three transactions if there is a sample (five or seven where the chip
/// measures in between), one if not. FIFO mode: three, and one for every 16 samples; a FIFO that
/// was full is emptied. verify_next(): one, or four and more behind the window. Samples of the
/// first 70 ms and more after power-up are dropped.
/// @tparam kAccelerometer  with it a watermark is at most 127 samples
template <BurstBus Bus, Accelerometer kAccelerometer = Accelerometer::off>
class Icm45686
    : public PacketGyro<icm45686::Map, icm45686::IndirectRegisters<Bus>, kAccelerometer> {
  using Base = PacketGyro<icm45686::Map, icm45686::IndirectRegisters<Bus>, kAccelerometer>;

 public:
  constexpr explicit Icm45686(Bus bus, icm45686::Settings settings = {})
      : Base(settings, icm45686::AccelerationRange::g_4, icm45686::IndirectRegisters<Bus>{bus}) {}
  constexpr Icm45686(Bus bus, icm45686::Settings settings,
                     icm45686::AccelerationRange range) requires(kAccelerometer ==
                                                                 Accelerometer::on)
      : Base(settings, range, icm45686::IndirectRegisters<Bus>{bus}) {}
};

}  // namespace zerorate::drivers
