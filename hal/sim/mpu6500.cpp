#include "hal/sim/mpu6500.hpp"

#include <algorithm>
#include <cmath>

#include "hal/sim/conversion.hpp"

namespace zerorate::hal::sim {
namespace {

// Written apart from the driver's tables, so that each checks the other.
enum Address : std::uint8_t {
  xg_offs_tc = 0x00,
  xg_offset_h = 0x13,
  smplrt_div = 0x19,
  config = 0x1A,
  gyro_config = 0x1B,
  accel_config = 0x1C,
  fifo_en = 0x23,
  i2c_slv0_addr = 0x25,
  i2c_slv0_reg = 0x26,
  i2c_slv0_ctrl = 0x27,
  i2c_mst_status = 0x36,
  int_pin_cfg = 0x37,
  int_enable = 0x38,
  int_status = 0x3A,
  accel_xout_h = 0x3B,
  temp_out_h = 0x41,
  gyro_xout_h = 0x43,
  gyro_zout_l = 0x48,
  ext_sens_data_00 = 0x49,
  signal_path_reset = 0x68,
  user_ctrl = 0x6A,
  pwr_mgmt_1 = 0x6B,
  pwr_mgmt_2 = 0x6C,
  i2c_if = 0x70,
  fifo_count_h = 0x72,
  fifo_count_l = 0x73,
  fifo_r_w = 0x74,
  who_am_i = 0x75,
};

constexpr core::Duration kResetTime = core::Duration::milliseconds(100);
constexpr core::Duration kTurnOnTime = core::Duration::milliseconds(35);
constexpr core::Duration kAccelerometerTurnOn = core::Duration::milliseconds(20);

// Bits of INT_STATUS and INT_ENABLE.
constexpr unsigned kDataReady = 0x01;
constexpr unsigned kOverflow = 0x10;

// Self-test, offsets, configuration, the I2C master, power, accelerometer offsets.
bool is_writable(std::uint8_t address) {
  return address <= 0x02 || (address >= 0x06 && address <= 0x0F) ||
         (address >= xg_offset_h && address <= 0x34 && address != 0x21 && address != 0x22) ||
         address == int_pin_cfg || address == int_enable ||
         (address >= 0x63 && address <= pwr_mgmt_2) || address == fifo_r_w ||
         (address >= 0x77 && address <= 0x7E);
}

bool is_read_only(std::uint8_t address) {
  return address == 0x35 || address == 0x36 || (address >= int_status && address <= 0x61) ||
         address == fifo_count_h || address == fifo_count_l || address == who_am_i;
}

double dps_per_lsb(std::uint8_t gyro) {
  return 250.0 * std::exp2((gyro >> 3U) & 3U) / 32768.0;
}

double g_per_lsb(std::uint8_t accel) {
  return 2.0 * std::exp2((accel >> 3U) & 3U) / 32768.0;
}

std::uint8_t byte_of_magnetometer(unsigned address) {
  if (address == 0x00) return 0x48;                    // WIA
  if (address >= 0x10 && address <= 0x12) return 128;  // ASAX to ASAZ: a factor of 1
  return 0;
}

}  // namespace

void SimulatedMpu6500::reset_registers() {
  registers_.fill(0);
  registers_[pwr_mgmt_1] = is_mpu6050() ? 0x40 : (is_icm20602() || is_icm20689() ? 0x41 : 0x01);
  if (is_icm20602()) registers_[config] = 0x80;
  if (is_mpu6050()) registers_[xg_offs_tc] = 0x01;  // OTP_BNK_VLD
  registers_[who_am_i] = identity_;
  fifo_.clear();
  last_fifo_byte_ = 0;
  latched_count_l_ = 0;
  powered_at_ = clock_->now();
  accelerometer_powered_at_ = clock_->now();
  drive_int(false);
}

bool SimulatedMpu6500::is_awake() const {
  return !is_resetting() && (registers_[pwr_mgmt_1] & 0x60U) == 0;  // SLEEP, CYCLE
}

bool SimulatedMpu6500::is_powered() const {
  const bool is_standing_by = !is_mpu6050() && (registers_[pwr_mgmt_1] & 0x10U) != 0;
  return is_awake() && !is_standing_by && (registers_[pwr_mgmt_2] & 0x07U) != 0x07U;
}

bool SimulatedMpu6500::is_accelerometer_powered() const {
  return is_awake() && (registers_[pwr_mgmt_2] & 0x38U) != 0x38U;
}

core::Duration SimulatedMpu6500::sample_period() const {
  if (!is_awake()) return {};
  const unsigned low_pass = registers_[config] & 0x07U;
  const bool is_bypassed = !is_mpu6050() && (registers_[gyro_config] & 0x03U) != 0;
  const std::int64_t divider = 1 + std::int64_t{registers_[smplrt_div]};
  if (is_bypassed) return core::Duration::nanoseconds(31'250);
  if (low_pass >= 1 && low_pass <= 6) return core::Duration::milliseconds(1) * divider;
  // 8 kHz inside, which the MPU-6500 does not divide.
  return core::Duration::microseconds(125) * (is_mpu6050() ? divider : 1);
}

void SimulatedMpu6500::set_word(std::uint8_t address, std::int16_t value) {
  registers_.at(address) = high_byte(value);
  registers_.at(address + 1U) = low_byte(value);
}

/// One LSB of the offset registers is one of the output at 1000 deg/s, in every range.
double SimulatedMpu6500::offset_dps(std::size_t axis) const {
  const unsigned high = registers_.at(xg_offset_h + 2 * axis);
  const unsigned low = registers_.at(xg_offset_h + 2 * axis + 1);
  return static_cast<std::int16_t>(static_cast<std::uint16_t>((high << 8U) | low)) * 1000.0 /
         32768.0;
}

void SimulatedMpu6500::measure(const std::array<core::AngularRate, 3>& rate,
                               core::Temperature temperature) {
  if (!is_awake()) return;
  const unsigned told = registers_[int_status] & kOverflow;
  const auto degc = static_cast<double>(temperature.degc());
  const bool has_thermometer = (registers_[pwr_mgmt_1] & 0x08U) == 0;  // TEMP_DIS
  if (has_thermometer) set_word(temp_out_h, to_counts(temperature_counts(degc)));
  const double transient_dps = start_up_transient_dps(clock_->now() - powered_at_, kTurnOnTime);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool is_on = is_powered() && (registers_[pwr_mgmt_2] & (4U >> axis)) == 0;
    const double dps = in_deg_per_s(rate[axis]) + offset_dps(axis) + transient_dps;
    const double counts = is_on ? dps / dps_per_lsb(registers_[gyro_config]) : 0.0;
    set_word(static_cast<std::uint8_t>(gyro_xout_h + 2 * axis), to_counts(counts));
  }
  measure_acceleration();
  registers_[int_status] |= kDataReady;
  push_sample();
  announce(kDataReady | (registers_[int_status] & kOverflow & ~told));
}

void SimulatedMpu6500::measure_acceleration() {
  const Counts counts =
      convert_force(g_per_lsb(registers_[accel_config]), clock_->now() - accelerometer_powered_at_,
                    kAccelerometerTurnOn);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool is_on =
        is_accelerometer_powered() && (registers_[pwr_mgmt_2] & (0x20U >> axis)) == 0;
    set_word(static_cast<std::uint8_t>(accel_xout_h + 2 * axis),
             is_on ? counts.at(axis) : std::int16_t{0});
  }
}

double SimulatedMpu6500::temperature_counts(double degc) const {
  if (is_mpu6050()) return (degc - 36.53) * 340.0;
  if (is_icm20602() || is_icm20689()) return (degc - 25.0) * 326.8;
  return (degc - 21.0) * 333.87;
}

/// Registers that these relatives do not have: offsets of the older kind, the I2C master.
bool SimulatedMpu6500::is_reserved(std::uint8_t address) const {
  if (!is_icm20602() && !is_icm20689()) return false;
  return (address >= 0x24 && address <= 0x34) || (address >= 0x63 && address <= 0x67) ||
         (is_icm20689() && address == signal_path_reset);
}

std::size_t SimulatedMpu6500::fifo_capacity() const {
  if (is_icm20602()) return 1008;
  return is_mpu6050() ? 1024 : 512;
}

/// Puts into the FIFO what is enabled, in the order of the registers.
void SimulatedMpu6500::push_sample() {
  if ((registers_[user_ctrl] & 0x40U) == 0) return;
  const unsigned enabled = registers_[fifo_en];
  const std::span registers{registers_};
  if (is_icm20602()) {
    if ((enabled & 0x08U) != 0) push_bytes(registers.subspan(accel_xout_h, 6));
    if ((enabled & 0x10U) != 0) push_bytes(registers.subspan(temp_out_h, 8));
    return;
  }
  if ((enabled & 0x08U) != 0) push_bytes(registers.subspan(accel_xout_h, 6));
  if ((enabled & 0x80U) != 0) push_bytes(registers.subspan(temp_out_h, 2));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if ((enabled & (0x40U >> axis)) != 0) push_bytes(registers.subspan(gyro_xout_h + 2 * axis, 2));
  }
}

/// A full FIFO loses its oldest bytes, or, in FIFO_MODE of the MPU-6500, what comes.
void SimulatedMpu6500::push_bytes(std::span<const std::uint8_t> bytes) {
  const std::size_t capacity = fifo_capacity();
  const bool stops = !is_mpu6050() && (registers_[config] & 0x40U) != 0;
  for (const std::uint8_t byte : bytes) {
    if (fifo_.size() == capacity) {
      registers_[int_status] |= kOverflow;
      if (stops) return;
      fifo_.pop_front();
    }
    fifo_.push_back(byte);
  }
}

std::uint8_t SimulatedMpu6500::read_fifo_byte() {
  if (fifo_.empty()) return last_fifo_byte_;
  last_fifo_byte_ = fifo_.front();
  fifo_.pop_front();
  return last_fifo_byte_;
}

std::uint8_t SimulatedMpu6500::take_status() {
  const std::uint8_t status = registers_[int_status];
  registers_[int_status] = 0;
  drive_int(false);
  return status;
}

std::uint8_t SimulatedMpu6500::read_register(std::uint8_t address) {
  address &= 0x7FU;
  const bool clears_by_any = (registers_[int_pin_cfg] & 0x10U) != 0;
  std::uint8_t value = registers_.at(address);
  if (address == fifo_r_w) {
    value = read_fifo_byte();
  } else if (address == fifo_count_h) {
    latched_count_l_ = static_cast<std::uint8_t>(fifo_.size() & 0xFFU);
    value = static_cast<std::uint8_t>(fifo_.size() >> 8U);
  } else if (address == fifo_count_l) {
    value = latched_count_l_;
  }
  if (address == int_status || clears_by_any) take_status();
  return value;
}

/// Bits that ask for something and clear themselves.
void SimulatedMpu6500::reset_parts(std::uint8_t address, std::uint8_t value) {
  const bool is_all = address == user_ctrl && (value & 0x01U) != 0;  // SIG_COND_RST
  const unsigned paths = address == signal_path_reset ? value : 0U;
  if (is_all || (paths & 0x04U) != 0) std::fill_n(&registers_[gyro_xout_h], 6, std::uint8_t{0});
  if (is_all || (paths & 0x02U) != 0) std::fill_n(&registers_[accel_xout_h], 6, std::uint8_t{0});
  if (is_all || (paths & 0x01U) != 0) std::fill_n(&registers_[temp_out_h], 2, std::uint8_t{0});
  const bool is_fifo_on = (value & 0x40U) != 0;
  if (address == user_ctrl && (value & 0x04U) != 0 && !is_fifo_on) fifo_.clear();  // FIFO_RST
  if (address == signal_path_reset) registers_[signal_path_reset] = 0;
  if (address == user_ctrl) registers_[user_ctrl] &= 0xF0U;
}

void SimulatedMpu6500::write_register(std::uint8_t address, std::uint8_t value) {
  address &= 0x7FU;
  if (is_resetting() || is_read_only(address)) return;
  const bool is_i2c_if = is_icm20602() && address == i2c_if;
  if ((!is_writable(address) || is_reserved(address)) && !is_i2c_if) {
    ++reserved_writes_;
    return;
  }
  if (address == fifo_r_w) return push_bytes(std::span{&value, 1});
  if (address == pwr_mgmt_1 && (value & 0x80U) != 0) {
    reset_registers();
    reset_until_ = clock_->now() + kResetTime;
    return;
  }
  const bool was_powered = is_powered();
  const bool was_accelerometer_powered = is_accelerometer_powered();
  registers_.at(address) = value;
  if (!was_powered && is_powered()) powered_at_ = clock_->now();
  if (!was_accelerometer_powered && is_accelerometer_powered()) {
    accelerometer_powered_at_ = clock_->now();
  }
  reset_parts(address, value);
  if (address == int_pin_cfg) drive_int(false);
}

std::uint8_t SimulatedMpu6500::next_address(std::uint8_t address) const {
  return address == fifo_r_w ? address : static_cast<std::uint8_t>((address + 1U) & 0x7FU);
}

void SimulatedMpu6500::drive_int(bool is_active) {
  const bool is_active_low = (registers_[int_pin_cfg] & 0x80U) != 0;
  interrupt_.drive(is_active != is_active_low, clock_->now());
}

/// A pulse of 50 us is over long before anybody looks at the pin; latched, it waits for the status
/// to be read.
void SimulatedMpu6500::announce(unsigned events) {
  if ((events & registers_[int_enable]) == 0) return;
  const bool is_latched = (registers_[int_pin_cfg] & 0x20U) != 0;
  drive_int(true);
  if (!is_latched) drive_int(false);
}

void SimulatedMpu9250::write_register(std::uint8_t address, std::uint8_t value) {
  SimulatedMpu6500::write_register(address, value);
  if ((address & 0x7FU) == user_ctrl && (value & 0x20U) != 0) serve_first_slave();  // I2C_MST_EN
}

/// Whoever is not the magnetometer does not answer. What is written to it is forgotten.
void SimulatedMpu9250::serve_first_slave() {
  constexpr unsigned kMagnetometer = 0x0C;
  const unsigned address = registers_[i2c_slv0_addr];
  const unsigned control = registers_[i2c_slv0_ctrl];
  if ((control & 0x80U) == 0) return;
  const bool has_answered = (address & 0x7FU) == kMagnetometer;
  const bool is_reading = (address & 0x80U) != 0;
  registers_[i2c_mst_status] = has_answered ? 0x00 : 0x01;  // I2C_SLV0_NACK
  for (unsigned i = 0; has_answered && is_reading && i < (control & 0x0FU); ++i) {
    registers_.at(ext_sens_data_00 + i) = byte_of_magnetometer(registers_[i2c_slv0_reg] + i);
  }
}

}  // namespace zerorate::hal::sim
