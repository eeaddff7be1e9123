#include "hal/sim/lsm6dsv16x.hpp"

#include <cmath>

namespace zerorate::hal::sim {
namespace {

// Written apart from the driver's tables, so that each checks the other.
enum Address : std::uint8_t {
  who_am_i = 0x0F,
  ctrl1 = 0x10,
  ctrl2 = 0x11,
  ctrl3 = 0x12,
  ctrl6 = 0x15,
  ctrl8 = 0x17,
  ctrl10 = 0x19,
  fifo_status1 = 0x1B,
  fifo_status2 = 0x1C,
  status_reg = 0x1E,
  internal_freq = 0x4F,
  fifo_data_out_tag = 0x78,
};

constexpr core::Duration kResetTime = core::Duration::microseconds(50);

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
  reset_data();
  drive_int1();
}

bool SimulatedLsm6dsv16x::is_accelerometer_powered() const {
  const bool is_high_performance = (registers_[ctrl1] & 0x70U) == 0;
  return !is_resetting() && is_high_performance && (registers_[ctrl1] & 0x0FU) >= 2;
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
  convert(rate, temperature, dps_per_lsb(registers_[ctrl6]));
  registers_[status_reg] |= 0x06U;  // GDA, TDA
  const bool has_acceleration = is_accelerometer_powered() && !take_loss();
  if (has_acceleration) {
    convert_acceleration(0.061e-3 * std::exp2(registers_[ctrl8] & 0x03U));
    registers_[status_reg] |= 0x01U;  // XLDA
  }
  batch(has_acceleration && is_acceleration_batched());
  drive_int1();
}

void SimulatedLsm6dsv16x::batch(bool has_acceleration) {
  constexpr unsigned kGyro = 1;
  constexpr unsigned kAccelerometer = 2;
  const unsigned slot = unsigned{time_slot_} << 1U;
  bool is_taken = false;
  if (is_batched()) is_taken |= push_fifo_word((kGyro << 3U) | slot, rates());
  if (has_acceleration) is_taken |= push_fifo_word((kAccelerometer << 3U) | slot, accelerations());
  if (is_taken) time_slot_ = static_cast<std::uint8_t>((time_slot_ + 1U) & 3U);
}

std::uint8_t SimulatedLsm6dsv16x::read_register(std::uint8_t address) {
  address &= 0x7FU;
  std::uint8_t value = registers_.at(address);
  if (const auto data = read_data(address)) {
    value = *data;
  } else if (address == fifo_status1) {
    value = static_cast<std::uint8_t>(fifo_words() & 0xFFU);
  } else if (address == fifo_status2) {
    value = take_fifo_status2(fifo_words() >= fifo_capacity());
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
  const bool was_accelerometer_powered = is_accelerometer_powered();
  registers_.at(address) = value;
  if (!was_powered && is_powered()) powered_at_ = clock_->now();
  if (!was_accelerometer_powered && is_accelerometer_powered()) {
    accelerometer_powered_at_ = clock_->now();
  }
  end_write(address);
}

}  // namespace zerorate::hal::sim
