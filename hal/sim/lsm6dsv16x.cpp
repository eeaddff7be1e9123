#include "hal/sim/lsm6dsv16x.hpp"

#include <cmath>

#include "hal/sim/conversion.hpp"

namespace zerorate::hal::sim {
namespace {

// Written apart from the driver's tables, so that each checks the other.
enum Address : std::uint8_t {
  fifo_ctrl1 = 0x07,
  fifo_ctrl2 = 0x08,
  fifo_ctrl3 = 0x09,
  fifo_ctrl4 = 0x0A,
  int1_ctrl = 0x0D,
  who_am_i = 0x0F,
  ctrl2 = 0x11,
  ctrl3 = 0x12,
  ctrl6 = 0x15,
  ctrl10 = 0x19,
  fifo_status1 = 0x1B,
  fifo_status2 = 0x1C,
  status_reg = 0x1E,
  out_temp_l = 0x20,
  outz_h_g = 0x27,
  internal_freq = 0x4F,
  fifo_data_out_tag = 0x78,
  fifo_data_out_z_h = 0x7E,
};

constexpr core::Duration kResetTime = core::Duration::microseconds(50);
constexpr core::Duration kTurnOnTime = core::Duration::milliseconds(30);

bool is_writable(std::uint8_t address) {
  return (address >= 0x01 && address <= 0x03) || (address >= 0x06 && address <= 0x0E) ||
         (address >= 0x10 && address <= ctrl10) || (address >= 0x50 && address <= 0x5F) ||
         (address >= 0x62 && address <= 0x75);
}

bool is_read_only(std::uint8_t address) {
  return address == who_am_i || (address >= 0x1A && address <= 0x4F) ||
         address >= fifo_data_out_tag;
}

double dps_per_lsb(std::uint8_t range) {
  const unsigned code = range & 0x0FU;
  return code == 0x0C ? 0.14 : 0.004375 * std::exp2(code);
}

}  // namespace

void SimulatedLsm6dsv16x::reset_registers() {
  registers_.fill(0);
  registers_[0x02] = 0x23;
  registers_[who_am_i] = 0x70;
  registers_[ctrl3] = 0x44;
  registers_[internal_freq] = static_cast<std::uint8_t>(trim_);
  outputs_ = {};
  fifo_.clear();
  is_fifo_overrun_latched_ = false;
  time_slot_ = 0;
  drive_int1();
}

bool SimulatedLsm6dsv16x::is_powered() const {
  const bool is_high_performance = (registers_[ctrl2] & 0x70U) == 0;
  return !is_resetting() && is_high_performance && (registers_[ctrl2] & 0x0FU) >= 2;
}

core::Duration SimulatedLsm6dsv16x::sample_period() const {
  if (!is_powered()) return {};
  const unsigned code = registers_[ctrl2] & 0x0FU;
  const double rate_hz = 7680.0 * (1.0 + 0.0013 * trim_) / std::exp2(12.0 - code);
  return core::Duration::nanoseconds(std::llround(1e9 / rate_hz));
}

void SimulatedLsm6dsv16x::measure(const std::array<core::AngularRate, 3>& rate,
                                  core::Temperature temperature) {
  if (!is_powered()) return;
  outputs_[0].value = to_counts((static_cast<double>(temperature.degc()) - 25.0) * 256.0);
  const double transient_dps = start_up_transient_dps(clock_->now() - powered_at_, kTurnOnTime);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    outputs_.at(axis + 1).value =
        to_counts((in_deg_per_s(rate.at(axis)) + transient_dps) / dps_per_lsb(registers_[ctrl6]));
  }
  registers_[status_reg] = 0x06;  // GDA, TDA
  push_fifo_word();
  drive_int1();
}

std::size_t SimulatedLsm6dsv16x::fifo_capacity() const {
  const bool stops_on_watermark = (registers_[fifo_ctrl2] & 0x80U) != 0;
  return stops_on_watermark ? registers_[fifo_ctrl1] : kFifoCapacity;
}

void SimulatedLsm6dsv16x::push_fifo_word() {
  constexpr unsigned kFifoMode = 1;
  constexpr unsigned kContinuous = 6;
  const unsigned mode = registers_[fifo_ctrl4] & 0x07U;
  const bool is_batched = (registers_[fifo_ctrl3] & 0xF0U) != 0;
  if (!is_batched || (mode != kFifoMode && mode != kContinuous)) return;
  if (fifo_.size() >= fifo_capacity()) {
    is_fifo_overrun_latched_ = true;
    if (mode == kFifoMode) return;
    fifo_.pop_front();
  }
  constexpr unsigned kGyro = 1;
  FifoWord word{static_cast<std::uint8_t>((kGyro << 3U) | (unsigned{time_slot_} << 1U))};
  time_slot_ = static_cast<std::uint8_t>((time_slot_ + 1U) & 3U);
  for (std::size_t i = 0; i < 6; ++i) {
    const std::int16_t value = outputs_.at(1 + i / 2).value;
    word.at(i + 1) = i % 2 == 1 ? high_byte(value) : low_byte(value);
  }
  fifo_.push_back(word);
}

std::uint8_t SimulatedLsm6dsv16x::read_output(std::uint8_t address) {
  const std::size_t offset = static_cast<std::size_t>(address) - out_temp_l;
  Output& output = outputs_.at(offset / 2);
  const bool is_high = offset % 2 == 1;
  const bool is_blocked = (registers_[ctrl3] & 0x40U) != 0;
  const std::int16_t value = output.held.value_or(output.value);
  if (is_high) {
    output.held.reset();
    registers_[status_reg] &= offset < 2 ? 0xFBU : 0xFDU;  // TDA, GDA
  } else if (is_blocked) {
    output.held = value;
  }
  return is_high ? high_byte(value) : low_byte(value);
}

std::uint8_t SimulatedLsm6dsv16x::read_fifo_byte(std::uint8_t address) {
  if (fifo_.empty()) return 0;
  const std::uint8_t byte = fifo_.front().at(static_cast<std::size_t>(address) - fifo_data_out_tag);
  if (address == fifo_data_out_z_h) fifo_.pop_front();
  return byte;
}

std::uint8_t SimulatedLsm6dsv16x::read_fifo_status2() {
  const std::size_t words = fifo_.size();
  const std::size_t watermark = registers_[fifo_ctrl1];
  unsigned status = static_cast<unsigned>(words >> 8U) & 1U;
  if (watermark > 0 && words >= watermark) status |= 0x80U;
  if (words >= fifo_capacity()) status |= 0x40U;
  if (words + 1 >= fifo_capacity()) status |= 0x20U;
  if (is_fifo_overrun_latched_) status |= 0x08U;
  is_fifo_overrun_latched_ = false;
  return static_cast<std::uint8_t>(status);
}

std::uint8_t SimulatedLsm6dsv16x::read_register(std::uint8_t address) {
  address &= 0x7FU;
  std::uint8_t value = registers_.at(address);
  if (address >= out_temp_l && address <= outz_h_g) {
    value = read_output(address);
  } else if (address >= fifo_data_out_tag && address <= fifo_data_out_z_h) {
    value = read_fifo_byte(address);
  } else if (address == fifo_status1) {
    value = static_cast<std::uint8_t>(fifo_.size() & 0xFFU);
  } else if (address == fifo_status2) {
    value = read_fifo_status2();
  } else if (address == ctrl3 && is_resetting()) {
    value |= 0x01U;
  }
  drive_int1();
  return value;
}

void SimulatedLsm6dsv16x::write_register(std::uint8_t address, std::uint8_t value) {
  address &= 0x7FU;
  if (is_resetting() || is_read_only(address)) return;
  if (!is_writable(address)) {
    ++reserved_writes_;
    return;
  }
  if (address == ctrl3 && (value & 0x01U) != 0) {
    reset_registers();
    reset_until_ = clock_->now() + kResetTime;
    return;
  }
  const bool was_powered = is_powered();
  registers_.at(address) = value;
  if (!was_powered && is_powered()) powered_at_ = clock_->now();
  const bool is_bypass = (registers_[fifo_ctrl4] & 0x07U) == 0;
  if (address == fifo_ctrl4 && is_bypass) fifo_.clear();
  drive_int1();
}

std::uint8_t SimulatedLsm6dsv16x::next_address(std::uint8_t address) const {
  const bool increments = (registers_[ctrl3] & 0x04U) != 0;
  if (!increments) return address;
  if (address == fifo_data_out_z_h) return fifo_data_out_tag;  // bursts of words
  return static_cast<std::uint8_t>((address + 1U) & 0x7FU);
}

void SimulatedLsm6dsv16x::drive_int1() {
  const unsigned routed = registers_[int1_ctrl];
  const std::size_t watermark = registers_[fifo_ctrl1];
  const bool is_ready = (registers_[status_reg] & 0x02U) != 0 && (routed & 0x02U) != 0;
  const bool is_at_watermark = watermark > 0 && fifo_.size() >= watermark && (routed & 0x08U) != 0;
  interrupt_.drive(is_ready || is_at_watermark, clock_->now());
}

}  // namespace zerorate::hal::sim
