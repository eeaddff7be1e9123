/// @file
/// An LSM6DSO or a relative at the level of its registers, fed with physical values, and what it
/// has in common with ST's younger modules.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "hal/sim/accelerometer.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::hal::sim {

/// Data path that ST's modules have in common, at the same addresses: outputs with block data
/// update, FIFO of tagged words, INT1, bursts.
class SimulatedStModule : public SimulatedRegisters<128>, public SimulatedAccelerometer {
 public:
  [[nodiscard]] std::uint8_t next_address(std::uint8_t address) const;

 protected:
  /// Figures in which the modules' data paths differ.
  struct DataPath {
    std::size_t fifo_words;           ///< 0: the FIFO has no tags and is not this one
    std::uint8_t watermark_high_bit;  ///< bit of FIFO_CTRL2; 0: the watermark has eight bits
    core::Duration turn_on_time;
  };

  SimulatedStModule(const SimulatedClock& clock, const DataPath& data_path)
      : SimulatedRegisters(clock), data_path_(data_path) {}

  /// Clears outputs, FIFO and time slot, as power-on does. The registers stay.
  void reset_data();
  /// One conversion: rounds to the LSB, saturates at 16 bits. The gyro settles since powered_at_.
  void convert(const std::array<core::AngularRate, 3>& rate, core::Temperature temperature,
               double dps_per_lsb);
  /// One conversion of the accelerometer, which settles since accelerometer_powered_at_.
  void convert_acceleration(double g_per_lsb);
  /// Newest counts of x, y and z.
  [[nodiscard]] std::array<std::int16_t, 3> rates() const;
  [[nodiscard]] std::array<std::int16_t, 3> accelerations() const;
  [[nodiscard]] bool is_settling() const;

  /// False if the FIFO is off, or full and keeps what it has.
  bool push_fifo_word(unsigned tag, const std::array<std::int16_t, 3>& values);
  [[nodiscard]] bool is_batched() const;
  [[nodiscard]] bool is_acceleration_batched() const;
  [[nodiscard]] std::size_t fifo_words() const { return fifo_.size(); }
  [[nodiscard]] std::size_t fifo_capacity() const;
  /// True from the loss of the oldest word to the next reading of a word.
  [[nodiscard]] bool has_overwritten() const { return has_overwritten_; }
  /// FIFO_STATUS2, which forgets FIFO_OVR_LATCHED.
  /// @param is_overrun FIFO_OVR_IA
  std::uint8_t take_fifo_status2(bool is_overrun);

  /// Byte of an output or of the FIFO; nullopt for any other register.
  std::optional<std::uint8_t> read_data(std::uint8_t address);
  /// Empties the FIFO if the register was FIFO_CTRL4 and selects bypass; drives INT1.
  void end_write(std::uint8_t address);
  void drive_int1();

  bool has_reached_other_watermark_ = false;  ///< level of a FIFO without tags
  core::Instant powered_at_;
  core::Instant accelerometer_powered_at_;
  std::uint8_t time_slot_ = 0;  ///< TAG_CNT

 private:
  using FifoWord = std::array<std::uint8_t, 7>;

  /// A 16-bit output; with block data update, reading the low byte holds the pair until the high
  /// byte is read.
  struct Output {
    std::int16_t value = 0;
    std::optional<std::int16_t> held;
  };

  std::uint8_t read_output(std::uint8_t address);
  std::uint8_t read_fifo_byte(std::uint8_t address);
  [[nodiscard]] std::size_t watermark() const;
  [[nodiscard]] bool is_at_watermark() const;

  DataPath data_path_;
  std::array<Output, 7> outputs_{};  // temperature, rates, accelerations: as their addresses
  std::deque<FifoWord> fifo_;
  bool has_overwritten_ = false;
  bool is_overrun_latched_ = false;  // FIFO_OVR_LATCHED
};

/// The chip (ST DS12140) as a gyro that has an accelerometer beside it: identity, reset values,
/// software reset, power-up transients, rounding and saturation, block data update, data-ready,
/// FIFO with tags, watermark and overrun, time stamps (read and batched with every sample),
/// temperature, oscillator trim, INT1, data-ready mask, the banks of the embedded functions and of
/// the sensor hub as memory. Of the relatives their identity and their range of 4000 deg/s; what
/// they lack is there all the same.
///
/// Not modelled: the accelerometer without the gyro or at another rate (it converts with the gyro),
/// its user offsets, low-pass and high-pass filters, FIFO compression, batching at less
/// than the output rate, batched temperature, the FIFO modes with triggers (they behave as bypass),
/// embedded functions and sensor hub.
///
/// The chip has no oscillator of its own: each call of measure() is one conversion, at the time of
/// the clock, so that a recording of any rate can be sent through it. For a chip that samples by
/// itself, advance the clock by sample_period() before each call.
class SimulatedLsm6dso : public SimulatedStModule {
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
  [[nodiscard]] bool is_accelerometer_powered() const;
  /// Nominal period of the configured rate, trim included; zero when powered down.
  [[nodiscard]] core::Duration sample_period() const;

  /// Interrupted supply: everything is as after power-on.
  void cycle_power();

  // The bus's side (RegisterChip).
  std::uint8_t read_register(std::uint8_t address);
  void write_register(std::uint8_t address, std::uint8_t value);

 protected:
  static constexpr std::size_t kFifoWords = 512;  // 3 kbyte of data, six bytes a word

  SimulatedLsm6dso(const SimulatedClock& clock, std::int8_t trim, std::uint8_t identity,
                   std::size_t fifo_words = kFifoWords)
      : SimulatedStModule(clock, {.fifo_words = fifo_words,
                                  .watermark_high_bit = 0x01,
                                  .turn_on_time = core::Duration::milliseconds(70)}),
        trim_(trim),
        identity_(identity) {
    reset_registers();
  }

  /// Counts of 25 us since the time stamps were switched on or reset.
  [[nodiscard]] std::uint32_t timestamp() const;
  /// Whether another bank than the chip's own registers is addressed (FUNC_CFG_ACCESS).
  [[nodiscard]] bool shows_other_bank() const;
  /// Whether the newest conversion has an acceleration.
  [[nodiscard]] bool has_acceleration() const { return has_acceleration_; }

 private:
  static constexpr std::uint8_t kIdentity = 0x6C;
  static constexpr std::uint8_t kIdentityWith4000Dps = 0x6B;

  void reset_registers();
  void note_time_of(std::uint8_t address, std::uint8_t value);
  void batch();
  void push_tagged(unsigned sensor, const std::array<std::int16_t, 3>& values);
  std::array<std::uint8_t, 128>& other_bank();
  [[nodiscard]] bool is_masked() const;

  std::int8_t trim_;
  std::uint8_t identity_;
  bool has_acceleration_ = false;
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

/// LSM6DSO with 4000 deg/s, for games. Answers as the ISM330DHCX does.
class SimulatedLsm6dsr : public SimulatedLsm6dso {
 public:
  static constexpr std::string_view kName = "lsm6dsr";
  explicit SimulatedLsm6dsr(const SimulatedClock& clock, std::int8_t trim = 0)
      : SimulatedLsm6dso(clock, trim, 0x6B) {}
};

/// An LSM6DSO with a core for machine learning, which is not modelled. Answers as that does.
class SimulatedLsm6dsox : public SimulatedLsm6dso {
 public:
  static constexpr std::string_view kName = "lsm6dsox";
  explicit SimulatedLsm6dsox(const SimulatedClock& clock, std::int8_t trim = 0)
      : SimulatedLsm6dso(clock, trim) {}
};

}  // namespace zerorate::hal::sim
