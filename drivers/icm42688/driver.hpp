/// @file
/// Driver of the gyro, and on demand of the accelerometer, in TDK's ICM-42688-P and its relatives,
/// over SPI or I2C, polled by data-ready or through the FIFO.
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
#include "drivers/icm42688/codec.hpp"
#include "drivers/icm42688/configuration.hpp"
#include "drivers/icm42688/registers.hpp"

namespace zerorate::drivers {

namespace icm42688 {

/// Facts of the family for PacketGyro.
struct Map {
  using Chosen = icm42688::Chosen;
  using AccelerationRange = icm42688::AccelerationRange;
  static constexpr auto kReset = kDeviceConfig;
  static constexpr std::uint8_t kResetCommand = bits::kDeviceConfigSoftReset;
  static constexpr core::Duration kResetTime = icm42688::kResetTime;
  static constexpr core::Duration kWakeTime{};
  static constexpr auto kFifoData = icm42688::kFifoData;
  static constexpr auto kStatus = kIntStatus;
  static constexpr auto kPower = kPwrMgmt0;
  static constexpr bool kKeepsNewest = true;
  static constexpr std::int16_t kHighestRaw = icm42688::kHighestRaw;
  static constexpr std::int16_t kLowestRaw = icm42688::kLowestRaw;
  template <bool kHasAccelerometer>
  static constexpr std::size_t kAwakeEntries = 0;

  static constexpr bool is_fifo(const Chosen& chosen) { return chosen.mode == Mode::fifo; }
  static constexpr core::AngularRate lsb(const Chosen& chosen) {
    return icm42688::lsb(chosen.full_scale);
  }
  static constexpr core::Acceleration acceleration_lsb(AccelerationRange range) {
    return icm42688::acceleration_lsb(range);
  }
  static constexpr core::Temperature temperature(std::int16_t raw) {
    return decode_temperature(raw);
  }
  static constexpr core::Duration sample_period(const Chosen& chosen) {
    return icm42688::sample_period(chosen.rate);
  }
  static constexpr core::Duration settling_time(core::Duration period) {
    return icm42688::settling_time(period);
  }
  template <bool kHasAccelerometer>
  static constexpr auto entries(const Chosen& chosen, AccelerationRange range) {
    return configuration<kHasAccelerometer>(chosen, range);
  }
  static constexpr RawAxes axes(std::span<const std::uint8_t, 6> bytes) {
    return {decode_int16(bytes[1], bytes[0]), decode_int16(bytes[3], bytes[2]),
            decode_int16(bytes[5], bytes[4])};
  }

  /// A chip that was left in another register bank is brought back, which takes one call more.
  template <RegisterBus Bus>
  static core::Result<void, DriverError> check_identity(Bus& bus, const Chosen& chosen) {
    std::array<std::uint8_t, 2> identity_and_bank{};
    if (const auto done = read_registers(bus, kWhoAmI, identity_and_bank); !done) return done;
    const unsigned bank = identity_and_bank[1];
    if (bank > 0 && bank <= bits::kRegBankSelBank) {
      if (const auto done = write_register(bus, kRegBankSel, 0); !done) return done;
      return refused(DriverErrorCode::not_ready, kRegBankSel.address);
    }
    if (identity_and_bank[0] != static_cast<std::uint8_t>(chosen.part)) {
      return refused(DriverErrorCode::wrong_identity, kWhoAmI.address);
    }
    return {};
  }

  /// Data-ready falls when it is read. So it is read behind the data, in one burst, where it also
  /// shows that the line is not stuck. A conversion may fall into the burst: a sample counts when a
  /// second burst repeats it, and is dropped when it changed without data-ready. The acceleration
  /// is dropped unless the second burst repeats it.
  template <bool kHasAccelerometer, RegisterBus Bus>
  static core::Result<RawOutputs, DriverError> read_outputs(Bus& bus) {
    constexpr int kMostBursts = 4;  // a slow bus may meet a conversion in each of them
    auto outputs = read_burst(bus);
    for (int burst = 1; burst < kMostBursts && outputs && outputs->is_new; ++burst) {
      const auto again = read_burst(bus);
      if (!again) return again;
      if (kHasAccelerometer && outputs->acceleration != again->acceleration) {
        outputs->acceleration[0] = kInvalidRaw;
      }
      if (!again->is_new) return outputs->gyro == again->gyro ? outputs : again;
      outputs = again;
    }
    return outputs;
  }

  template <std::size_t kPacketBytes, RegisterBus Bus>
  static core::Result<PacketFifoState, DriverError> read_fifo_state(Bus& bus) {
    std::array<std::uint8_t, 3> bytes{};
    if (const auto done = read_registers(bus, kIntStatus, bytes); !done) {
      return core::Unexpected{done.error()};
    }
    const auto status = decode_fifo_status<kPacketBytes>(bytes[0], bytes[1], bytes[2]);
    if (!status.is_plausible) return refused(DriverErrorCode::corrupt_data, kIntStatus.address);
    PacketFifoState state{.packets = status.packets, .is_full = status.is_full};
    if (state.packets == 0) return state;
    std::array<std::uint8_t, 2> temperature{};
    if (const auto done = read_registers(bus, kTempData1, temperature); !done) {
      return core::Unexpected{done.error()};
    }
    state.temperature = decode_int16(temperature[1], temperature[0]);
    return state;
  }

 private:
  template <RegisterBus Bus>
  static core::Result<RawOutputs, DriverError> read_burst(Bus& bus) {
    // Temperature, accelerometer, gyro, the time of FSYNC, and INT_STATUS.
    constexpr std::size_t kSize = 17;
    std::array<std::uint8_t, kSize> bytes{};
    if (const auto done = read_registers(bus, kTempData1, bytes); !done) {
      return core::Unexpected{done.error()};
    }
    if ((bytes.back() & bits::kIntStatusAlwaysZero) != 0) {
      return refused(DriverErrorCode::corrupt_data, kIntStatus.address);
    }
    const auto all = std::span<const std::uint8_t, kSize>{bytes};
    return RawOutputs{.is_new = (bytes.back() & bits::kIntStatusDataRdy) != 0,
                      .gyro = axes(all.template subspan<8, 6>()),
                      .acceleration = axes(all.template subspan<2, 6>()),
                      .temperature = decode_int16(bytes[1], bytes[0])};
  }
};

}  // namespace icm42688

/// A GyroSource (packet_gyro.hpp). Bus is SpiRegisters<...> or I2cRegisters<...>. SPI mode 0 or 3,
/// up to 24 MHz.
///
/// start(): 42 transactions in all. read(), data-ready mode: two transactions if there is a sample
/// (three or four where the chip measures in between), one if not. FIFO mode: two, and one for
/// every 16 samples. verify_next(): one. Samples of the first 60 ms and more after power-up are
/// dropped.
/// @tparam kAccelerometer  with it a watermark is at most 128 samples
template <RegisterBus Bus, Accelerometer kAccelerometer = Accelerometer::off>
class Icm42688 : public PacketGyro<icm42688::Map, Bus, kAccelerometer> {
  using Base = PacketGyro<icm42688::Map, Bus, kAccelerometer>;

 public:
  constexpr explicit Icm42688(Bus bus, icm42688::Settings settings = {})
      : Base(icm42688::chosen(settings), icm42688::AccelerationRange::g_4, bus) {}
  /// A relative, by the type of its settings. One class drives them all: an image with two of them
  /// has its code once.
  template <icm42688::Part kPart>
  constexpr Icm42688(Bus bus, const icm42688::SettingsOf<kPart>& settings)
      : Base(icm42688::chosen(settings), icm42688::AccelerationRange::g_4, bus) {}
  template <icm42688::Part kPart>
  constexpr Icm42688(Bus bus, const icm42688::SettingsOf<kPart>& settings,
                     icm42688::AccelerationRange range) requires(kAccelerometer ==
                                                                 Accelerometer::on)
      : Base(icm42688::chosen(settings), range, bus) {}
};

}  // namespace zerorate::drivers
