#include "hal/sim/icm20948.hpp"

#include <algorithm>
#include <cmath>

#include "hal/sim/conversion.hpp"

namespace zerorate::hal::sim {
namespace {

// Written apart from the driver's tables, so that each checks the other.
enum Address : std::uint8_t {
  who_am_i = 0x00,
  user_ctrl = 0x03,
  lp_config = 0x05,
  pwr_mgmt_1 = 0x06,
  pwr_mgmt_2 = 0x07,
  int_pin_cfg = 0x0F,
  int_enable_1 = 0x11,
  int_enable_2 = 0x12,
  int_enable_3 = 0x13,
  int_status = 0x19,
  int_status_1 = 0x1A,
  int_status_2 = 0x1B,
  int_status_3 = 0x1C,
  accel_xout_h = 0x2D,
  gyro_xout_h = 0x33,
  temp_out_h = 0x39,
  ext_slv_sens_data_23 = 0x52,
  fifo_en_1 = 0x66,
  fifo_en_2 = 0x67,
  fifo_rst = 0x68,
  fifo_mode = 0x69,
  fifo_count_h = 0x70,
  fifo_count_l = 0x71,
  fifo_r_w = 0x72,
  data_rdy_status = 0x74,
  fifo_cfg = 0x76,
  reg_bank_sel = 0x7F,
  // Bank 2.
  gyro_smplrt_div = 0x80,
  gyro_config_1 = 0x81,
  xg_offs_usrh = 0x83,
  odr_align_en = 0x89,
  accel_smplrt_div_1 = 0x90,
  accel_config = 0x94,
  accel_config_2 = 0x95,
  fsync_config = 0xD2,
  mod_ctrl_usr = 0xD4,
};

constexpr std::size_t kFifoBytes = 512;
constexpr core::Duration kResetTime = core::Duration::milliseconds(100);
constexpr core::Duration kGyroStart = core::Duration::milliseconds(35);
constexpr core::Duration kAccelerometerStart = core::Duration::milliseconds(20);

bool is_within(std::uint8_t address, std::uint8_t first, std::uint8_t last) {
  return address >= first && address <= last;
}

/// Registers of bank 0, and of bank 2 with bit 7.
bool is_writable(std::uint8_t address) {
  return address == user_ctrl || is_within(address, lp_config, pwr_mgmt_2) ||
         is_within(address, int_pin_cfg, int_enable_3) ||
         is_within(address, fifo_en_1, fifo_mode) || address == fifo_r_w || address == fifo_cfg ||
         is_within(address, gyro_smplrt_div, odr_align_en) ||
         is_within(address, accel_smplrt_div_1, accel_config_2) ||
         is_within(address, fsync_config, mod_ctrl_usr);
}

bool is_read_only(std::uint8_t address) {
  return address == who_am_i || is_within(address, 0x17, int_status_3) ||
         is_within(address, 0x28, ext_slv_sens_data_23) ||
         is_within(address, fifo_count_h, fifo_count_l) || address == data_rdy_status;
}

}  // namespace

void SimulatedIcm20948::reset_registers() {
  registers_.fill(0);
  registers_[who_am_i] = 0xEA;
  registers_[lp_config] = 0x40;
  registers_[pwr_mgmt_1] = 0x41;
  registers_[gyro_config_1] = 0x01;
  registers_[accel_config] = 0x01;
  fifo_.clear();
  powered_at_ = clock_->now();
  accelerometer_powered_at_ = clock_->now();
  drive_int(false);
}

unsigned SimulatedIcm20948::bank() const {
  return (registers_[reg_bank_sel] >> 4U) & 3U;
}

bool SimulatedIcm20948::is_awake() const {
  return !is_resetting() && (registers_[pwr_mgmt_1] & 0x40U) == 0;
}

bool SimulatedIcm20948::is_powered() const {
  return is_awake() && (registers_[pwr_mgmt_2] & 0x07U) != 0x07U;
}

bool SimulatedIcm20948::is_accelerometer_powered() const {
  return is_awake() && (registers_[pwr_mgmt_2] & 0x38U) != 0x38U;
}

core::Duration SimulatedIcm20948::sample_period() const {
  if (!is_awake()) return {};
  const bool is_filtered = (registers_[gyro_config_1] & 0x01U) != 0;
  const double rate_hz = is_filtered ? 1125.0 / (1.0 + registers_[gyro_smplrt_div]) : 9000.0;
  return core::Duration::nanoseconds(std::llround(1e9 / rate_hz));
}

void SimulatedIcm20948::set_word(std::size_t address, std::int16_t value) {
  registers_.at(address) = high_byte(value);
  registers_.at(address + 1U) = low_byte(value);
}

/// One LSB of the offset registers is one of the output at 1000 deg/s, in every range.
double SimulatedIcm20948::offset_dps(std::size_t axis) const {
  const unsigned high = registers_.at(xg_offs_usrh + 2 * axis);
  const unsigned low = registers_.at(xg_offs_usrh + 2 * axis + 1);
  return static_cast<std::int16_t>(static_cast<std::uint16_t>((high << 8U) | low)) * 1000.0 /
         32768.0;
}

void SimulatedIcm20948::measure(const std::array<core::AngularRate, 3>& rate,
                                core::Temperature temperature) {
  if (!is_awake()) return;
  const bool has_thermometer = (registers_[pwr_mgmt_1] & 0x08U) == 0;
  if (has_thermometer) {
    set_word(temp_out_h, to_counts((static_cast<double>(temperature.degc()) - 21.0) * 333.87));
  }
  measure_rates(rate);
  measure_acceleration();
  registers_[int_status_1] |= 0x01U;
  const unsigned overflow_before = registers_[int_status_2];
  push_sample();
  const bool has_overflown = registers_[int_status_2] != overflow_before;
  announce((registers_[int_enable_1] & 0x01U) != 0 ||
           (has_overflown && (registers_[int_enable_2] & 0x01U) != 0));
}

void SimulatedIcm20948::measure_rates(const std::array<core::AngularRate, 3>& rate) {
  const unsigned range = (registers_[gyro_config_1] >> 1U) & 3U;
  const double dps_per_lsb = 250.0 * std::exp2(range) / 32768.0;
  const double transient_dps = start_up_transient_dps(clock_->now() - powered_at_, kGyroStart);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool is_on = is_powered() && (registers_[pwr_mgmt_2] & (4U >> axis)) == 0;
    const double dps = in_deg_per_s(rate.at(axis)) + offset_dps(axis) + transient_dps;
    set_word(gyro_xout_h + 2 * axis, is_on ? to_counts(dps / dps_per_lsb) : std::int16_t{0});
  }
}

void SimulatedIcm20948::measure_acceleration() {
  const unsigned range = (registers_[accel_config] >> 1U) & 3U;
  const Counts counts =
      convert_force(2.0 * std::exp2(range) / 32768.0, clock_->now() - accelerometer_powered_at_,
                    kAccelerometerStart);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool is_on =
        is_accelerometer_powered() && (registers_[pwr_mgmt_2] & (0x20U >> axis)) == 0;
    set_word(accel_xout_h + 2 * axis, is_on ? counts.at(axis) : std::int16_t{0});
  }
}

/// Puts into the FIFO what is enabled, in the order of the registers.
void SimulatedIcm20948::push_sample() {
  const bool is_on = (registers_[user_ctrl] & 0x40U) != 0 && (registers_[fifo_rst] & 0x1FU) == 0;
  if (!is_on) return;
  const unsigned enabled = registers_[fifo_en_2];
  if ((enabled & 0x10U) != 0) push_registers(accel_xout_h, 6);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if ((enabled & (0x02U << axis)) != 0) push_registers(gyro_xout_h + 2 * axis, 2);
  }
  if ((enabled & 0x01U) != 0) push_registers(temp_out_h, 2);
}

/// A full FIFO loses its oldest bytes, or, in snapshot mode, what comes.
void SimulatedIcm20948::push_registers(std::size_t first, std::size_t count) {
  const bool stops = (registers_[fifo_mode] & 0x01U) != 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (fifo_.size() == kFifoBytes) {
      registers_[int_status_2] |= 0x01U;
      if (stops) return;
      fifo_.pop_front();
    }
    fifo_.push_back(registers_.at(first + i));
  }
}

std::uint8_t SimulatedIcm20948::read_fifo_byte() {
  if (fifo_.empty()) return 0xFF;
  const std::uint8_t byte = fifo_.front();
  fifo_.pop_front();
  return byte;
}

std::uint8_t SimulatedIcm20948::take_status(std::uint8_t address) {
  const std::uint8_t status = registers_.at(address);
  registers_.at(address) = 0;
  drive_int(false);
  return status;
}

std::uint8_t SimulatedIcm20948::read_register(std::uint8_t address) {
  address &= 0x7FU;
  if (address == reg_bank_sel) return registers_[reg_bank_sel];
  if (bank() == 2) return registers_.at(0x80U | address);
  if (bank() != 0) return 0;
  if (is_within(address, int_status, int_status_3)) return take_status(address);
  if (address == fifo_r_w) return read_fifo_byte();
  if (address == fifo_count_h) return static_cast<std::uint8_t>(fifo_.size() >> 8U);
  if (address == fifo_count_l) return static_cast<std::uint8_t>(fifo_.size() & 0xFFU);
  return registers_.at(address);
}

void SimulatedIcm20948::write_register(std::uint8_t address, std::uint8_t value) {
  address &= 0x7FU;
  if (is_resetting()) return;
  if (address == reg_bank_sel) {
    registers_[reg_bank_sel] = value & 0x30U;
    return;
  }
  const auto in_bank = static_cast<std::uint8_t>(bank() == 2 ? 0x80U | address : address);
  if (bank() == 0 && is_read_only(address)) return;
  if (bank() % 2 != 0 || !is_writable(in_bank)) {
    ++reserved_writes_;
    return;
  }
  if (bank() == 2) {
    registers_.at(in_bank) = value;
  } else {
    write_bank_0(address, value);
  }
}

void SimulatedIcm20948::write_bank_0(std::uint8_t address, std::uint8_t value) {
  if (address == pwr_mgmt_1 && (value & 0x80U) != 0) {
    reset_registers();
    reset_until_ = clock_->now() + kResetTime;
    return;
  }
  if (address == fifo_r_w) return;
  const bool was_powered = is_powered();
  const bool was_accelerometer_powered = is_accelerometer_powered();
  registers_.at(address) = value;
  if (!was_powered && is_powered()) powered_at_ = clock_->now();
  if (!was_accelerometer_powered && is_accelerometer_powered()) {
    accelerometer_powered_at_ = clock_->now();
  }
  if (address == user_ctrl) registers_[user_ctrl] &= 0xF0U;  // resets, which clear themselves
  if (address == fifo_rst && (value & 0x1FU) != 0) fifo_.clear();
  if (address == int_pin_cfg) drive_int(false);
}

std::uint8_t SimulatedIcm20948::next_address(std::uint8_t address) const {
  const bool stays = bank() == 0 && (address & 0x7FU) == fifo_r_w;
  return stays ? address : static_cast<std::uint8_t>((address + 1U) & 0x7FU);
}

void SimulatedIcm20948::drive_int(bool is_active) {
  const bool is_active_low = (registers_[int_pin_cfg] & 0x80U) != 0;
  interrupt_.drive(is_active != is_active_low, clock_->now());
}

/// A pulse of 50 us is over long before anybody looks at the pin; latched, it waits for the status
/// to be read.
void SimulatedIcm20948::announce(bool is_enabled) {
  if (!is_enabled) return;
  const bool is_latched = (registers_[int_pin_cfg] & 0x20U) != 0;
  drive_int(true);
  if (!is_latched) drive_int(false);
}

}  // namespace zerorate::hal::sim
