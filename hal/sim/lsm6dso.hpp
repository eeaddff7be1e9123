/// @file
/// An LSM6DSO or a relative at the level of its registers, fed with physical values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::hal::sim {

/// The gyro half of the chip (ST DS12140): identity, reset values, software reset, power-up
/// transient, rounding and saturation, block data update, data-ready, FIFO with tags, watermark and
/// overrun, time stamps (read and batched with every sample), temperature, oscillator trim, INT1,
/// data-ready mask, the banks of the embedded functions and of the sensor hub as memory. Of the
/// relatives their identity and their range of 4000 deg/s; what they lack is there all the same.
///
/// Not modelled: accelerometer, low-pass and high-pass filters, FIFO compression, batching at less
/// than the output rate, batched temperature, the FIFO modes with triggers (they behave as bypass),
/// embedded functions and sensor hub.
///
/// The chip has no oscillator of its own: each call of measure() is one conversion, at the time of
/// the clock, so that a recording of any rate can be sent through it. For a chip that samples by
/// itself, advance the clock by sample_period() before each call.
class SimulatedLsm6dso : public SimulatedRegisters<128> {
 public:
  static constexpr std::string_view kName = "lsm6dso";

  /// @param clock the simulation's time; must outlive the chip
  /// @param trim INTERNAL_FREQ_FINE: the oscillator is 0.15 % faster for each count
  explicit SimulatedLsm6dso(const SimulatedClock& clock, std::int8_t trim = 0)
      : SimulatedLsm6dso(clock, trim, kIdentity) {}

  /// One conversion: rounds to the LSB, saturates at 16 bits, raises data-ready, fills the FIFO.
  /// Does nothing while the gyro is powered down or in reset.
  void measure(const std::array<core::AngularRate, 3>& rate, core::Temperature temperature);

  [[nodiscard]] bool is_powered() const;
  /// Nominal period of the configured rate, trim included; zero when powered down.
  [[nodiscard]] core::Duration sample_period() const;

  /// Interrupted supply: everything is as after power-on.
  void cycle_power();

  // The bus's side (RegisterChip).
  std::uint8_t read_register(std::uint8_t address);
  void write_register(std::uint8_t address, std::uint8_t value);
  [[nodiscard]] std::uint8_t next_address(std::uint8_t address) const;

 protected:
  SimulatedLsm6dso(const SimulatedClock& clock, std::int8_t trim, std::uint8_t identity)
      : SimulatedRegisters(clock), trim_(trim), identity_(identity) {
    reset_registers();
  }

 private:
  static constexpr std::uint8_t kIdentity = 0x6C;
  static constexpr std::size_t kFifoCapacity = 512;  // 3 kbyte of data, six bytes a word
  using FifoWord = std::array<std::uint8_t, 7>;

  /// A 16-bit output; with block data update, reading the low byte holds the pair until the high
  /// byte is read.
  struct Output {
    std::int16_t value = 0;
    std::optional<std::int16_t> held;
  };

  void reset_registers();
  [[nodiscard]] std::int16_t quantize(core::AngularRate rate) const;
  std::uint8_t read_output(std::uint8_t address);
  std::uint8_t read_fifo_byte(std::uint8_t address);
  std::uint8_t read_fifo_status2();
  void note_time_of(std::uint8_t address, std::uint8_t value);
  void batch();
  void push_fifo_word(std::uint8_t sensor, const std::array<std::int16_t, 3>& values);
  std::array<std::uint8_t, 128>* other_bank();
  [[nodiscard]] std::uint32_t timestamp() const;
  [[nodiscard]] bool is_masked() const;
  [[nodiscard]] std::size_t watermark() const;
  [[nodiscard]] std::size_t fifo_capacity() const;
  void drive_int1();

  std::int8_t trim_;
  std::uint8_t identity_;
  std::array<Output, 4> outputs_{};  // temperature, x, y, z: the order of their addresses
  std::deque<FifoWord> fifo_;
  bool is_fifo_overrun_ = false;          // FIFO_OVR_IA
  bool is_fifo_overrun_latched_ = false;  // FIFO_OVR_LATCHED
  std::uint8_t time_slot_ = 0;            // TAG_CNT
  core::Instant powered_at_;
  core::Instant boot_until_;
  core::Instant timestamp_zero_;
  std::array<std::array<std::uint8_t, 128>, 2> other_banks_{};
};
static_assert(RegisterChip<SimulatedLsm6dso>);

class SimulatedIsm330dhcx : public SimulatedLsm6dso {
 public:
  static constexpr std::string_view kName = "ism330dhcx";
  explicit SimulatedIsm330dhcx(const SimulatedClock& clock, std::int8_t trim = 0)
      : SimulatedLsm6dso(clock, trim, 0x6B) {}
};

/// Answers as the ISM330DHCX does.
class SimulatedAsm330lhh : public SimulatedLsm6dso {
 public:
  static constexpr std::string_view kName = "asm330lhh";
  explicit SimulatedAsm330lhh(const SimulatedClock& clock, std::int8_t trim = 0)
      : SimulatedLsm6dso(clock, trim, 0x6B) {}
};

}  // namespace zerorate::hal::sim
