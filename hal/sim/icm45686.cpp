#include "hal/sim/icm45686.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hal/sim/conversion.hpp"

namespace zerorate::hal::sim {
namespace {

// Written apart from the driver's tables, so that each checks the other.
enum Address : std::uint8_t {
  accel_data_x = 0x00,
  gyro_data_x = 0x06,
  temp_data = 0x0C,
  pwr_mgmt0 = 0x10,
  fifo_count_0 = 0x12,
  fifo_count_1 = 0x13,
  fifo_data = 0x14,
  int1_config0 = 0x16,
  int1_config2 = 0x18,
  int1_status0 = 0x19,
  int1_status1 = 0x1A,
  accel_config0 = 0x1B,
  gyro_config0 = 0x1C,
  fifo_config0 = 0x1D,
  fifo_config1_0 = 0x1E,
  fifo_config1_1 = 0x1F,
  fifo_config2 = 0x20,
  fifo_config3 = 0x21,
  fifo_config4 = 0x22,
  drive_config0 = 0x32,
  int2_config0 = 0x56,
  int2_config2 = 0x58,
  who_am_i = 0x72,
  ireg_addr_15_8 = 0x7C,
  ireg_addr_7_0 = 0x7D,
  ireg_data = 0x7E,
  reg_misc2 = 0x7F,
  // Behind the window.
  sreg_ctrl = 0x80,
  ipreg_sys1_reg_172 = 0x81,
  ipreg_sys2_reg_131 = 0x82,
  smc_control_0 = 0x83,
};

constexpr core::Duration kResetTime = core::Duration::milliseconds(1);
constexpr core::Duration kFlushTime = core::Duration::microseconds(20);  // assumed
constexpr core::Duration kTurnOnTime = core::Duration::milliseconds(60);
constexpr core::Duration kAccelerometerTurnOn = core::Duration::milliseconds(10);
/// Until the registers of the signal path have a clock.
constexpr core::Duration kClockTime = core::Duration::microseconds(200);

bool is_within(std::uint8_t address, std::uint8_t first, std::uint8_t last) {
  return address >= first && address <= last;
}

bool is_writable(std::uint8_t address) {
  return address == pwr_mgmt0 || is_within(address, int1_config0, int1_config2) ||
         is_within(address, accel_config0, 0x2E) || is_within(address, 0x30, 0x35) ||
         is_within(address, int2_config0, int2_config2) ||
         is_within(address, ireg_addr_15_8, reg_misc2);
}

bool is_read_only(std::uint8_t address) {
  return address < pwr_mgmt0 || is_within(address, fifo_count_0, fifo_data) ||
         is_within(address, int1_status0, int1_status1) || address == 0x2F || address == who_am_i;
}

std::optional<std::uint8_t> register_behind_window(unsigned address) {
  switch (address) {
    case 0xA267:
      return sreg_ctrl;
    case 0xA4AC:
      return ipreg_sys1_reg_172;
    case 0xA583:
      return ipreg_sys2_reg_131;
    case 0xA258:
      return smc_control_0;
    default:
      return {};
  }
}

double dps_per_lsb(std::uint8_t config) {
  return 4000.0 / std::exp2(15.0 + (config >> 4U));
}

double g_per_lsb(std::uint8_t config) {
  return 32.0 / std::exp2(15.0 + ((config >> 4U) & 7U));
}

}  // namespace

void SimulatedIcm45686::reset_registers() {
  registers_.fill(0);
  for (std::size_t word = accel_data_x; word < pwr_mgmt0 - 2U; word += 2) set_word(word, -32768);
  registers_[int1_config0] = 0x80;
  registers_[int2_config0] = 0x80;
  registers_[int1_config2] = 0x04;
  registers_[int2_config2] = 0x04;
  registers_[int1_status0] = 0x80;  // RESET_DONE
  registers_[accel_config0] = 0x06;
  registers_[gyro_config0] = 0x06;
  registers_[fifo_config2] = 0x20;
  registers_[who_am_i] = 0xE9;
  registers_[ipreg_sys1_reg_172] = 0x80;
  fifo_.clear();
  count_ = 0;
  shown_ = 0;
  is_window_busy_ = false;
  flushed_at_ = clock_->now();
}

bool SimulatedIcm45686::is_powered() const {
  return !is_resetting() && (registers_[pwr_mgmt0] & 0x0CU) == 0x0CU;  // low-noise mode
}

bool SimulatedIcm45686::is_accelerometer_powered() const {
  return !is_resetting() && (registers_[pwr_mgmt0] & 0x03U) == 0x03U;
}

core::Duration SimulatedIcm45686::sample_period() const {
  if (!is_powered()) return {};
  const double rate_hz = 6400.0 * std::exp2(3.0 - (registers_[gyro_config0] & 0x0FU));
  return core::Duration::nanoseconds(std::llround(1e9 / rate_hz));
}

/// SREG_CTRL tells which byte is first.
void SimulatedIcm45686::set_word(std::size_t address, std::int16_t value) {
  const bool is_big_endian = (registers_[sreg_ctrl] & 0x02U) != 0;
  registers_.at(address) = is_big_endian ? high_byte(value) : low_byte(value);
  registers_.at(address + 1U) = is_big_endian ? low_byte(value) : high_byte(value);
}

void SimulatedIcm45686::measure(const std::array<core::AngularRate, 3>& rate,
                                core::Temperature temperature) {
  if (!is_powered()) return;
  const bool has_thermometer = (registers_[smc_control_0] & 0x08U) == 0;  // TEMP_DIS
  const auto degc = static_cast<double>(temperature.degc());
  if (has_thermometer) set_word(temp_data, to_counts((degc - 25.0) * 128.0));
  const double transient_dps = start_up_transient_dps(clock_->now() - powered_at_, kTurnOnTime);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double counts =
        (in_deg_per_s(rate.at(axis)) + transient_dps) / dps_per_lsb(registers_[gyro_config0]);
    // -32768 is reserved for "no sample"; the end above it is taken as the ICM-42688-P's.
    set_word(gyro_data_x + 2 * axis, to_counts(counts, -32766, 32767));
  }
  measure_acceleration();
  raise_status(0x04U);  // DRDY
  push_packet(temperature);
  pulse_int1();
}

void SimulatedIcm45686::measure_acceleration() {
  const Counts counts = convert_force_if(
      is_accelerometer_powered(), g_per_lsb(registers_[accel_config0]),
      clock_->now() - accelerometer_powered_at_, kAccelerometerTurnOn, -32766, 32767);
  for (std::size_t axis = 0; axis < 3; ++axis) set_word(accel_data_x + 2 * axis, counts.at(axis));
}

std::size_t SimulatedIcm45686::fifo_bytes() const {
  return std::size_t{256} * ((registers_[fifo_config0] & 0x1FU) + 1U);
}

std::size_t SimulatedIcm45686::watermark() const {
  return registers_[fifo_config1_0] + std::size_t{256} * registers_[fifo_config1_1];
}

void SimulatedIcm45686::push_packet(core::Temperature temperature) {
  const unsigned mode = registers_[fifo_config0] >> 6U;
  const unsigned content = registers_[fifo_config3];
  const bool is_compressed = (registers_[fifo_config4] & 0x04U) != 0;
  const bool is_open = (content & 0x05U) == 0x05U;  // the interface and the gyro
  if (mode == 0 || !is_open || (content & 0x38U) != 0 || is_compressed || is_flushing()) return;
  const bool has_acceleration = (content & 0x02U) != 0;
  const std::size_t size = has_acceleration ? 16 : 8;
  constexpr unsigned kStream = 1;
  while (mode == kStream && fifo_.bytes() + size > fifo_bytes()) fifo_.drop_oldest();
  if (fifo_.bytes() + size <= fifo_bytes()) {
    const bool has_time = (registers_[fifo_config4] & 0x02U) != 0;
    const unsigned header = (has_acceleration ? 0x60U : 0x20U) | (has_time ? 0x08U : 0U);
    std::optional<PacketFifo::Axes> acceleration;
    if (has_acceleration) acceleration = PacketFifo::axes_at(registers_, accel_data_x);
    const double counts = (static_cast<double>(temperature.degc()) - 25.0) * 2.0;
    fifo_.push(PacketFifo::sample(static_cast<std::uint8_t>(header), acceleration,
                                  PacketFifo::axes_at(registers_, gyro_data_x),
                                  low_byte(to_counts(counts, -127, 127))));
  }
  const bool is_full = fifo_.bytes() + size > fifo_bytes();
  const unsigned reached = (is_full ? 0x01U : 0U) | (fifo_.packets() >= watermark() ? 0x02U : 0U);
  raise_status(reached);
}

/// A bit shows only where its interrupt is enabled.
void SimulatedIcm45686::raise_status(unsigned bits) {
  registers_[int1_status0] =
      static_cast<std::uint8_t>(registers_[int1_status0] | (registers_[int1_config0] & bits));
}

/// The count is that of the reading before.
std::uint8_t SimulatedIcm45686::read_count_low() {
  shown_ = count_;
  count_ = is_flushing() ? 0 : fifo_.packets();
  return static_cast<std::uint8_t>(shown_ & 0xFFU);
}

/// Another register than those that are known reads as 0.
std::uint8_t SimulatedIcm45686::read_window() {
  if (is_window_busy_) ++reserved_writes_;
  const unsigned address = 256U * registers_[ireg_addr_15_8] + registers_[ireg_addr_7_0];
  const auto behind = register_behind_window(address);
  if (!behind) return 0;
  is_window_busy_ = true;  // it fetches the one that follows
  return registers_.at(*behind);
}

void SimulatedIcm45686::write_window(std::uint8_t value) {
  const unsigned address = 256U * registers_[ireg_addr_15_8] + registers_[ireg_addr_7_0];
  const auto behind = register_behind_window(address);
  if (!behind) {
    ++reserved_writes_;
    return;
  }
  const bool is_in_signal_path = *behind == ipreg_sys1_reg_172 || *behind == ipreg_sys2_reg_131;
  const bool has_clock =
      (is_powered() && clock_->now() - powered_at_ >= kClockTime) ||
      (is_accelerometer_powered() && clock_->now() - accelerometer_powered_at_ >= kClockTime);
  if (!is_in_signal_path || has_clock) registers_.at(*behind) = value;
}

std::uint8_t SimulatedIcm45686::read_register(std::uint8_t address) {
  address &= 0x7FU;
  switch (address) {
    case fifo_data:
      return fifo_.read_byte();
    case fifo_count_0:
      return read_count_low();
    case fifo_count_1:
      return static_cast<std::uint8_t>(shown_ >> 8U);
    case ireg_data:
      return read_window();
    case reg_misc2: {
      const bool was_busy = is_window_busy_;
      is_window_busy_ = false;  // done when it is asked next
      return was_busy ? 0x00 : 0x01;
    }
    case fifo_config2:
      return static_cast<std::uint8_t>(registers_[fifo_config2] | (is_flushing() ? 0x80U : 0U));
    default:
      break;
  }
  const std::uint8_t value = registers_.at(address);
  if (address == int1_status0) registers_[int1_status0] = 0;
  return value;
}

/// Begins the start-up of a sensor that this write may switch on.
void SimulatedIcm45686::note_power(std::uint8_t address) {
  if (address != pwr_mgmt0) return;
  if (!is_powered()) powered_at_ = clock_->now();
  if (!is_accelerometer_powered()) accelerometer_powered_at_ = clock_->now();
}

/// A pin is set while its interrupts are off, depth and comparison while the FIFO is closed, and
/// it is opened after its mode.
bool SimulatedIcm45686::is_against_the_order(std::uint8_t address, std::uint8_t value) const {
  const bool is_closed = (registers_[fifo_config0] & 0xC0U) == 0;
  const unsigned changed = registers_.at(address) ^ value;
  switch (address) {
    case int1_config2:
      return registers_[int1_config0] != 0;
    case fifo_config0:
      return !is_closed && (changed & 0x3FU) != 0;
    case fifo_config2:
      return !is_closed && (changed & 0x08U) != 0;
    case fifo_config3:
      return is_closed && (value & 0x01U) != 0;
    default:
      return false;
  }
}

void SimulatedIcm45686::write_register(std::uint8_t address, std::uint8_t value) {
  address &= 0x7FU;
  if (is_resetting() || is_read_only(address)) return;
  if (!is_writable(address) || is_against_the_order(address, value)) ++reserved_writes_;
  if (!is_writable(address)) return;
  if (address == reg_misc2) {
    if ((value & 0x02U) == 0) return;
    reset_registers();
    reset_until_ = clock_->now() + kResetTime;
    return;
  }
  if (address == ireg_data) {
    write_window(value);
    return;
  }
  store(address, value);
}

void SimulatedIcm45686::store(std::uint8_t address, std::uint8_t value) {
  if (address == ireg_addr_15_8 && is_window_busy_) ++reserved_writes_;
  if (address == ireg_addr_7_0) is_window_busy_ = true;  // fetches, or writes what follows
  note_power(address);
  const bool is_flush = address == fifo_config2 && (value & 0x80U) != 0;
  registers_.at(address) = is_flush ? static_cast<std::uint8_t>(value & 0x7FU) : value;
  if (is_flush) flushed_at_ = clock_->now() + kFlushTime;
  if (is_flush || (registers_[fifo_config0] & 0xC0U) == 0) fifo_.clear();
}

/// A burst stays at the FIFO and at the window's value.
std::uint8_t SimulatedIcm45686::next_address(std::uint8_t address) const {
  const auto here = static_cast<std::uint8_t>(address & 0x7FU);
  return here == fifo_data || here == ireg_data ? here
                                                : static_cast<std::uint8_t>((here + 1U) & 0x7FU);
}

/// In pulsed mode the pin is low again long before anybody looks at it.
void SimulatedIcm45686::pulse_int1() {
  const unsigned enabled = registers_[int1_config0];
  const bool is_at_watermark = watermark() > 0 && fifo_.packets() >= watermark();
  const bool is_pulsed = (enabled & 0x04U) != 0 || ((enabled & 0x02U) != 0 && is_at_watermark);
  interrupt_.drive(is_pulsed, clock_->now());
  interrupt_.drive(false, clock_->now());
}

}  // namespace zerorate::hal::sim
