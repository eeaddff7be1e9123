#include "hal/sim/bmi088.hpp"

#include <algorithm>
#include <cmath>

#include "hal/sim/conversion.hpp"

namespace zerorate::hal::sim {
namespace {

// Written apart from the driver's tables, so that each checks the other.
enum Address : std::uint8_t {
  gyro_chip_id = 0x00,
  rate_x_lsb = 0x02,
  rate_z_msb = 0x07,
  gyro_int_stat_1 = 0x0A,
  fifo_status = 0x0E,
  gyro_range = 0x0F,
  gyro_bandwidth = 0x10,
  gyro_lpm1 = 0x11,
  gyro_softreset = 0x14,
  gyro_int_ctrl = 0x15,
  int3_int4_io_conf = 0x16,
  int3_int4_io_map = 0x18,
  fifo_wm_enable = 0x1E,
  gyro_self_test = 0x3C,
  fifo_config_0 = 0x3D,
  fifo_config_1 = 0x3E,
  fifo_data = 0x3F,
};

enum AccAddress : std::uint8_t {
  acc_chip_id = 0x00,
  acc_x_lsb = 0x12,
  acc_fifo_length_0 = 0x24,
  acc_fifo_length_1 = 0x25,
  acc_fifo_data = 0x26,
  acc_conf = 0x40,
  acc_range = 0x41,
  acc_fifo_config_0 = 0x48,
  acc_fifo_config_1 = 0x49,
  acc_pwr_conf = 0x7C,
  acc_pwr_ctrl = 0x7D,
  acc_softreset = 0x7E,
};

constexpr core::Duration kResetTime = core::Duration::milliseconds(30);
constexpr core::Duration kTurnOnTime = core::Duration::milliseconds(30);
constexpr core::Duration kDataReadyTime = core::Duration::microseconds(340);  // 280 to 400
constexpr std::size_t kFifoFrames = 100;

constexpr std::array<std::uint8_t, 12> kWritable{
    gyro_range,     gyro_bandwidth,    gyro_lpm1,        gyro_softreset,
    gyro_int_ctrl,  int3_int4_io_conf, int3_int4_io_map, fifo_wm_enable,
    gyro_self_test, fifo_config_0,     fifo_config_1,    0x34};

constexpr core::Duration kAccResetTime = core::Duration::milliseconds(1);
constexpr core::Duration kAccTurnOnTime = core::Duration::milliseconds(50);
constexpr std::size_t kAccFifoBytes = 1024;

constexpr std::array<std::uint8_t, 14> kAccWritable{
    acc_conf, acc_range, 0x45, 0x46, 0x47,         acc_fifo_config_0, acc_fifo_config_1,
    0x53,     0x54,      0x58, 0x6D, acc_pwr_conf, acc_pwr_ctrl,      acc_softreset};

bool is_read_only(std::uint8_t address) {
  return address <= fifo_status || address == fifo_data;
}

}  // namespace

void SimulatedBmi088::reset_registers() {
  registers_.fill(0);
  registers_[gyro_chip_id] = 0x0F;
  registers_[gyro_bandwidth] = 0x80;
  registers_[int3_int4_io_conf] = 0x0F;
  registers_[fifo_wm_enable] = 0x08;
  clear_fifo();
}

void SimulatedBmi088::clear_fifo() {
  fifo_.clear();
  fifo_cursor_ = 0;
  is_overrun_ = false;
}

bool SimulatedBmi088::is_powered() const {
  return !is_resetting() && (registers_[gyro_lpm1] & 0xA0U) == 0;
}

core::Duration SimulatedBmi088::sample_period() const {
  constexpr std::array kHz{2000.0, 2000.0, 1000.0, 400.0, 200.0, 100.0, 200.0, 100.0};
  if (!is_powered()) return {};
  return core::Duration::nanoseconds(std::llround(1e9 / kHz[registers_[gyro_bandwidth] & 7U]));
}

void SimulatedBmi088::measure(const std::array<core::AngularRate, 3>& rate,
                              core::Temperature /*temperature*/) {
  if (!is_powered()) return;
  const double dps_per_lsb = 2000.0 / std::exp2(15.0 + (registers_[gyro_range] & 7U));
  const double transient_dps = start_up_transient_dps(clock_->now() - reset_until_, kTurnOnTime);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto counts = to_counts((in_deg_per_s(rate[axis]) + transient_dps) / dps_per_lsb);
    registers_[rate_x_lsb + 2 * axis] = low_byte(counts);
    registers_[rate_x_lsb + 2 * axis + 1] = high_byte(counts);
  }
  measured_at_ = clock_->now();
  registers_[gyro_int_stat_1] = 0x80;
  push_frame();
  drive_int3(true);
}

void SimulatedBmi088::push_frame() {
  const unsigned mode = registers_[fifo_config_1] >> 6U;
  if (mode == 0) return;
  if (fifo_.size() == kFifoFrames) {
    is_overrun_ = true;
    constexpr unsigned kStopOnFull = 1;
    if (mode == kStopOnFull) return;
    fifo_.pop_front();
  }
  Frame frame{};
  std::copy_n(&registers_[rate_x_lsb], frame.size(), frame.begin());
  fifo_.push_back(frame);
}

std::uint8_t SimulatedBmi088::read_fifo_byte() {
  if (fifo_.empty()) return 0;
  const std::uint8_t byte = fifo_.front().at(fifo_cursor_++);
  if (fifo_cursor_ == fifo_.front().size()) {
    fifo_.pop_front();
    fifo_cursor_ = 0;
  }
  return byte;
}

std::uint8_t SimulatedBmi088::read_register(std::uint8_t address) {
  address &= 0x3FU;
  std::uint8_t value = registers_.at(address);
  if (address == fifo_data) {
    value = read_fifo_byte();
  } else if (address == fifo_status) {
    value = static_cast<std::uint8_t>(fifo_.size() | (is_overrun_ ? 0x80U : 0U));
  } else if (address == gyro_int_stat_1 && clock_->now() - measured_at_ >= kDataReadyTime) {
    value = 0;
  }
  drive_int3(false);
  return value;
}

void SimulatedBmi088::write_register(std::uint8_t address, std::uint8_t value) {
  address &= 0x3FU;
  if (is_resetting() || is_read_only(address)) return;
  if (std::ranges::find(kWritable, address) == kWritable.end()) {
    ++reserved_writes_;
    return;
  }
  if (address == gyro_softreset) {
    if (value != 0xB6) return;
    reset_registers();
    reset_until_ = clock_->now() + kResetTime;
    return;
  }
  registers_.at(address) = value;
  if (address == gyro_bandwidth) registers_.at(address) |= 0x80U;  // reads as one
  if (address == fifo_config_0 || address == fifo_config_1) clear_fifo();
  drive_int3(false);
}

std::uint8_t SimulatedBmi088::next_address(std::uint8_t address) const {
  return address == fifo_data ? address : static_cast<std::uint8_t>((address + 1U) & 0x3FU);
}

/// The watermark's interrupt is a level. That of new data is high for some 0.3 ms, and low again
/// before anybody looks at it.
void SimulatedBmi088::drive_int3(bool is_new_sample) {
  const unsigned map = registers_[int3_int4_io_map];
  const unsigned enabled = registers_[gyro_int_ctrl];
  const unsigned watermark = registers_[fifo_config_0] & 0x7FU;
  const bool is_watermark_on =
      (map & 0x04U) != 0 && (enabled & 0x40U) != 0 && (registers_[fifo_wm_enable] & 0x80U) != 0;
  const bool is_data_on = (map & 0x01U) != 0 && (enabled & 0x80U) != 0;
  const bool is_at_watermark = is_watermark_on && fifo_.size() > watermark;
  interrupt_.drive(is_at_watermark || (is_data_on && is_new_sample), clock_->now());
  interrupt_.drive(is_at_watermark, clock_->now());
}

void SimulatedBmi088Accelerometer::reset_registers() {
  registers_.fill(0);
  registers_[acc_chip_id] = 0x1E;
  registers_[acc_conf] = 0xA8;
  registers_[acc_range] = 0x01;
  registers_[acc_fifo_config_0] = 0x02;
  registers_[acc_fifo_config_1] = 0x10;
  registers_[acc_pwr_conf] = 0x03;
  fifo_.clear();
  fifo_cursor_ = 0;
}

bool SimulatedBmi088Accelerometer::is_powered() const {
  return !is_resetting() && registers_[acc_pwr_ctrl] == 0x04 && registers_[acc_pwr_conf] == 0x00;
}

void SimulatedBmi088Accelerometer::measure_force() {
  if (!is_powered() || take_loss()) return;
  const double g_per_lsb = 3.0 * std::exp2(registers_[acc_range] & 3U) / 32768.0;
  const Counts counts = convert_force(g_per_lsb, clock_->now() - powered_at_, kAccTurnOnTime);
  Frame frame{0x84};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    frame.at(1 + 2 * axis) = low_byte(counts.at(axis));
    frame.at(2 + 2 * axis) = high_byte(counts.at(axis));
  }
  std::copy_n(&frame[1], 6, &registers_[acc_x_lsb]);
  if ((registers_[acc_fifo_config_1] & 0x40U) == 0) return;
  const bool is_full = (fifo_.size() + 1) * frame.size() > kAccFifoBytes;
  const bool stops = (registers_[acc_fifo_config_0] & 0x01U) != 0;
  if (is_full && stops) return;
  if (is_full) fifo_.pop_front();
  if (is_full) fifo_cursor_ = 0;
  fifo_.push_back(frame);
}

/// Low and high byte of the level; 8000h where it is empty.
std::uint8_t SimulatedBmi088Accelerometer::length_byte(std::size_t byte) const {
  const std::size_t level = fifo_.empty() ? 0x8000 : fifo_.size() * sizeof(Frame);
  return static_cast<std::uint8_t>(level >> (8U * byte));
}

std::uint8_t SimulatedBmi088Accelerometer::read_register(std::uint8_t address) {
  address &= 0x7FU;
  if (address == acc_fifo_data) {
    if (fifo_.empty()) return 0x80;
    const std::uint8_t byte = fifo_.front().at(fifo_cursor_++);
    if (fifo_cursor_ == sizeof(Frame)) {
      fifo_.pop_front();
      fifo_cursor_ = 0;
    }
    return byte;
  }
  fifo_cursor_ = 0;  // a frame that was read in part comes again
  if (address == acc_fifo_length_0) return length_byte(0);
  if (address == acc_fifo_length_1) return length_byte(1);
  return registers_.at(address);
}

void SimulatedBmi088Accelerometer::write_register(std::uint8_t address, std::uint8_t value) {
  address &= 0x7FU;
  if (is_resetting() || address < acc_conf) return;
  if (std::ranges::find(kAccWritable, address) == kAccWritable.end()) {
    ++reserved_writes_;
    return;
  }
  if (address == acc_softreset) {
    if (value == 0xB0) fifo_.clear();
    if (value == 0xB0) fifo_cursor_ = 0;
    if (value != 0xB6) return;
    reset_registers();
    reset_until_ = clock_->now() + kAccResetTime;
    return;
  }
  const bool was_powered = is_powered();
  registers_.at(address) = value;
  if (!was_powered && is_powered()) powered_at_ = clock_->now();
}

std::uint8_t SimulatedBmi088Accelerometer::next_address(std::uint8_t address) const {
  return address == acc_fifo_data ? address : static_cast<std::uint8_t>((address + 1U) & 0x7FU);
}

}  // namespace zerorate::hal::sim
