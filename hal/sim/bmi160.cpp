#include "hal/sim/bmi160.hpp"

#include <cmath>

#include "hal/sim/conversion.hpp"

namespace zerorate::hal::sim {
namespace {

// Written apart from the driver's tables, so that each checks the other.
enum Address : std::uint8_t {
  chip_id = 0x00,
  pmu_status = 0x03,
  gyr_data = 0x0C,
  acc_data = 0x12,
  acc_data_end = 0x17,
  status = 0x1B,
  temperature_0 = 0x20,
  fifo_length_0 = 0x22,
  fifo_length_1 = 0x23,
  fifo_data = 0x24,
  acc_conf = 0x40,
  acc_range = 0x41,
  gyr_conf = 0x42,
  gyr_range = 0x43,
  fifo_config_0 = 0x46,
  fifo_config_1 = 0x47,
  int_en_1 = 0x51,
  int_out_ctrl = 0x53,
  int_map_1 = 0x56,
  cmd = 0x7E,
};

constexpr std::size_t kFifoBytes = 1024;
constexpr core::Duration kResetTime = core::Duration::milliseconds(1);
constexpr core::Duration kGyroStart = core::Duration::milliseconds(80);
constexpr core::Duration kAccelerometerStart = core::Duration::microseconds(3800);
/// End of the error of a gyro that has started, and of an accelerometer.
constexpr core::Duration kSettling = core::Duration::milliseconds(20);

bool is_writable(std::uint8_t address) {
  return (address >= acc_conf && address <= fifo_config_1) ||
         (address >= 0x4B && address <= 0x6D) || (address >= 0x70 && address <= 0x7A) ||
         address == cmd;
}

bool is_read_only(std::uint8_t address) {
  return address == chip_id || address == 0x02 || (address >= pmu_status && address <= fifo_data) ||
         address == 0x7F;
}

double g_per_lsb(std::uint8_t range) {
  switch (range & 0x0FU) {
    case 0x05:
      return 4.0 / 32768.0;
    case 0x08:
      return 8.0 / 32768.0;
    case 0x0C:
      return 16.0 / 32768.0;
    default:
      return 2.0 / 32768.0;
  }
}

}  // namespace

void SimulatedBmi160::reset_registers() {
  registers_.fill(0);
  registers_[chip_id] = 0xD1;
  registers_[status] = 0x11;             // nvm_rdy, and the reserved bit 0
  registers_[temperature_0 + 1] = 0x80;  // invalid
  registers_[acc_conf] = 0x28;
  registers_[acc_range] = 0x03;
  registers_[gyr_conf] = 0x28;
  registers_[0x44] = 0x0B;
  registers_[0x45] = 0x88;
  registers_[fifo_config_0] = 0x80;
  registers_[fifo_config_1] = 0x10;
  fifo_.clear();
  is_gyro_on_ = false;
  is_accelerometer_on_ = false;
  drive_int1(false);
}

bool SimulatedBmi160::is_powered() const {
  return is_gyro_on_ && clock_->now() >= gyro_at_;
}

bool SimulatedBmi160::is_accelerometer_powered() const {
  return is_accelerometer_on_ && clock_->now() >= accelerometer_at_;
}

core::Duration SimulatedBmi160::sample_period() const {
  if (!is_powered()) return {};
  const double rate_hz = 100.0 * std::exp2((registers_[gyr_conf] & 0x0FU) - 8.0);
  return core::Duration::nanoseconds(std::llround(1e9 / rate_hz));
}

void SimulatedBmi160::set_words(std::uint8_t address, const std::array<std::int16_t, 3>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    registers_.at(address + 2 * i) = low_byte(values.at(i));
    registers_.at(address + 2 * i + 1) = high_byte(values.at(i));
  }
}

void SimulatedBmi160::measure(const std::array<core::AngularRate, 3>& rate,
                              core::Temperature temperature) {
  if (!is_powered()) return;
  const std::int16_t warmth = to_counts((static_cast<double>(temperature.degc()) - 23.0) * 512.0);
  registers_[temperature_0] = low_byte(warmth);
  registers_[temperature_0 + 1] = high_byte(warmth);
  const double dps_per_lsb = 2000.0 / std::exp2(15.0 + (registers_[gyr_range] & 0x07U));
  const double transient_dps = start_up_transient_dps(clock_->now() - gyro_at_, kSettling);
  Counts counts{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    counts[axis] = to_counts((in_deg_per_s(rate[axis]) + transient_dps) / dps_per_lsb);
  }
  set_words(gyr_data, counts);
  registers_[status] |= 0x40U;
  if (is_accelerometer_powered()) {
    set_words(acc_data, convert_force(g_per_lsb(registers_[acc_range]),
                                      clock_->now() - accelerometer_at_, kSettling));
    registers_[status] |= 0x80U;
  }
  push_frame();
  drive_int1(false);
  drive_int1(true);
}

std::size_t SimulatedBmi160::frame_bytes() const {
  const unsigned enabled = registers_[fifo_config_1];
  return ((enabled & 0x80U) != 0 ? 6U : 0U) + ((enabled & 0x40U) != 0 ? 6U : 0U);
}

/// A full FIFO loses its oldest frame. With headers, which are not modelled, nothing is kept.
void SimulatedBmi160::push_frame() {
  const unsigned enabled = registers_[fifo_config_1];
  if ((enabled & 0x10U) != 0 || frame_bytes() == 0) return;
  while (fifo_.size() + frame_bytes() > kFifoBytes) {
    for (std::size_t i = 0; i < frame_bytes(); ++i) fifo_.pop_front();
  }
  const auto append = [&](std::size_t first) {
    for (std::size_t i = 0; i < 6; ++i) fifo_.push_back(registers_.at(first + i));
  };
  if ((enabled & 0x80U) != 0) append(gyr_data);
  if ((enabled & 0x40U) != 0) append(acc_data);
}

std::uint8_t SimulatedBmi160::read_fifo_byte() {
  if (fifo_.empty()) return 0x80;
  const std::uint8_t byte = fifo_.front();
  fifo_.pop_front();
  return byte;
}

std::uint8_t SimulatedBmi160::read_register(std::uint8_t address) {
  address &= 0x7FU;
  std::uint8_t value = registers_.at(address);
  if (address == fifo_data) {
    value = read_fifo_byte();
  } else if (address == fifo_length_0) {
    value = static_cast<std::uint8_t>(fifo_.size() & 0xFFU);
  } else if (address == fifo_length_1) {
    value = static_cast<std::uint8_t>(fifo_.size() >> 8U);
  } else if (address == pmu_status) {
    value = static_cast<std::uint8_t>((is_powered() ? 0x04U : 0U) |
                                      (is_accelerometer_powered() ? 0x10U : 0U));
  } else if (address >= gyr_data && address < acc_data) {
    registers_[status] &= 0xBFU;  // drdy_gyr
  } else if (address >= acc_data && address <= acc_data_end) {
    registers_[status] &= 0x7FU;  // drdy_acc
  }
  drive_int1(false);
  return value;
}

void SimulatedBmi160::run(std::uint8_t command) {
  switch (command) {
    case 0x10:
      is_accelerometer_on_ = false;
      break;
    case 0x11:
      if (!is_accelerometer_on_) accelerometer_at_ = clock_->now() + kAccelerometerStart;
      is_accelerometer_on_ = true;
      break;
    case 0x14:
      is_gyro_on_ = false;
      break;
    case 0x15:
      if (!is_gyro_on_) gyro_at_ = clock_->now() + kGyroStart;
      is_gyro_on_ = true;
      break;
    case 0xB0:
      fifo_.clear();
      break;
    case 0xB6:
      reset_registers();
      reset_until_ = clock_->now() + kResetTime;
      break;
    default:
      break;
  }
}

void SimulatedBmi160::write_register(std::uint8_t address, std::uint8_t value) {
  address &= 0x7FU;
  if (is_resetting() || is_read_only(address)) return;
  if (!is_writable(address)) {
    ++reserved_writes_;
    return;
  }
  if (address == cmd) {
    run(value);
  } else {
    registers_.at(address) = value;
  }
  if (address == fifo_config_1) fifo_.clear();  // frames of another content
  drive_int1(false);
}

std::uint8_t SimulatedBmi160::next_address(std::uint8_t address) const {
  return (address & 0x7FU) == fifo_data ? address
                                        : static_cast<std::uint8_t>((address + 1U) & 0x7FU);
}

/// The watermark's interrupt is a level. That of new data is not latched: it ends by itself, before
/// anybody looks at it, whether or not the data are read.
void SimulatedBmi160::drive_int1(bool is_new_sample) {
  const unsigned enabled = registers_[int_en_1];
  const unsigned mapped = registers_[int_map_1];
  const bool is_output = (registers_[int_out_ctrl] & 0x08U) != 0;
  const bool is_active_high = (registers_[int_out_ctrl] & 0x02U) != 0;
  const std::size_t watermark = std::size_t{4} * registers_[fifo_config_0];
  const bool is_ready = is_new_sample && (enabled & 0x10U) != 0 && (mapped & 0x80U) != 0;
  const bool is_filled =
      fifo_.size() >= watermark && watermark > 0 && (enabled & 0x40U) != 0 && (mapped & 0x40U) != 0;
  interrupt_.drive(is_output && (is_ready || is_filled) == is_active_high, clock_->now());
}

}  // namespace zerorate::hal::sim
