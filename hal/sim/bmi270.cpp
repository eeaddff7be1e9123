#include "hal/sim/bmi270.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hal/sim/conversion.hpp"

namespace zerorate::hal::sim {
namespace {

// Written apart from the driver's tables, so that each checks the other.
enum Address : std::uint8_t {
  chip_id = 0x00,
  err_reg = 0x02,
  status = 0x03,
  acc_data = 0x0C,
  gyr_data = 0x12,
  gyr_data_end = 0x17,
  internal_status_0 = 0x21,
  temperature_0 = 0x22,
  fifo_length_0 = 0x24,
  fifo_length_1 = 0x25,
  fifo_data = 0x26,
  feat_page = 0x2F,
  gyr_cas = 0x3C,
  acc_conf = 0x40,
  acc_range = 0x41,
  gyr_conf = 0x42,
  gyr_range = 0x43,
  fifo_downs = 0x45,
  fifo_wtm_0 = 0x46,
  fifo_wtm_1 = 0x47,
  fifo_config_0 = 0x48,
  fifo_config_1 = 0x49,
  int1_io_ctrl = 0x53,
  int_map_data = 0x58,
  init_ctrl = 0x59,
  init_addr_0 = 0x5B,
  init_addr_1 = 0x5C,
  init_data = 0x5E,
  pwr_conf = 0x7C,
  pwr_ctrl = 0x7D,
  cmd = 0x7E,
};

constexpr std::size_t kFifoBytes = 2048;
constexpr std::uint8_t kSumOfFile = 0xA5;
constexpr core::Duration kResetTime = core::Duration::milliseconds(2);
constexpr core::Duration kJudgement = core::Duration::milliseconds(20);
/// Start-up times (BST-BMI270-DS000): end of the error of a gyro that was switched on, and of an
/// accelerometer.
constexpr core::Duration kGyroStart = core::Duration::milliseconds(45);
constexpr core::Duration kAccelerometerStart = core::Duration::milliseconds(2);

bool is_writable(std::uint8_t address) {
  return (address >= feat_page && address <= 0x4F) ||
         (address >= int1_io_ctrl && address <= 0x5C && address != 0x5A) || address == init_data ||
         (address >= 0x68 && address <= 0x77) || (address >= pwr_conf && address <= cmd);
}

bool is_read_only(std::uint8_t address) {
  return address == chip_id || (address >= err_reg && address <= fifo_data);
}

std::uint8_t sum_of(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint8_t>(std::accumulate(bytes.begin(), bytes.end(), 0U));
}

}  // namespace

std::span<const std::uint8_t> SimulatedBmi270::config_file() {
  static const std::array<std::uint8_t, 600> file = [] {
    std::array<std::uint8_t, 600> bytes{};
    unsigned state = 1;
    for (std::uint8_t& byte : bytes) {
      state = (state * 1103515245U + 12345U) & 0x7FFFFFFFU;
      byte = static_cast<std::uint8_t>(state >> 16U);
    }
    bytes.back() = static_cast<std::uint8_t>(kSumOfFile - sum_of(std::span{bytes}.first(599)));
    return bytes;
  }();
  return file;
}

std::span<const std::uint8_t> SimulatedBmi270::loaded() const {
  const auto* const gap = std::ranges::find(is_loaded_, false);
  return std::span{image_}.first(static_cast<std::size_t>(gap - is_loaded_.begin()));
}

void SimulatedBmi270::reset_registers() {
  registers_.fill(0);
  registers_[chip_id] = 0x24;
  registers_[status] = 0x10;             // cmd_rdy
  registers_[temperature_0 + 1] = 0x80;  // invalid
  registers_[acc_conf] = 0xA8;
  registers_[acc_range] = 0x02;
  registers_[gyr_conf] = 0xA9;
  registers_[fifo_downs] = 0x88;
  registers_[fifo_wtm_1] = 0x02;
  registers_[fifo_config_0] = 0x02;
  registers_[fifo_config_1] = 0x10;
  registers_[pwr_conf] = 0x03;
  is_loaded_.fill(false);
  is_file_good_ = false;
  place_ = 0;
  judged_at_ = clock_->now();
  fifo_.clear();
  gyro_on_at_ = clock_->now();
  accelerometer_on_at_ = clock_->now();
  drive_int1();
}

/// Message 0: not initialised, 1: the file was taken, 2: it was not.
std::uint8_t SimulatedBmi270::internal_status() const {
  const bool is_asked = (registers_[init_ctrl] & 0x01U) != 0;
  if (!is_asked || clock_->now() < judged_at_) return 0x00;
  return is_file_good_ ? 0x01 : 0x02;
}

bool SimulatedBmi270::is_powered() const {
  return is_initialised() && (registers_[pwr_ctrl] & 0x02U) != 0;
}

bool SimulatedBmi270::is_accelerometer_powered() const {
  return is_initialised() && (registers_[pwr_ctrl] & 0x04U) != 0;
}

core::Duration SimulatedBmi270::sample_period() const {
  if (!is_powered()) return {};
  const double rate_hz = 100.0 * std::exp2((registers_[gyr_conf] & 0x0FU) - 8.0);
  return core::Duration::nanoseconds(std::llround(1e9 / rate_hz));
}

void SimulatedBmi270::set_words(std::uint8_t address, const std::array<std::int16_t, 3>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    registers_.at(address + 2 * i) = low_byte(values.at(i));
    registers_.at(address + 2 * i + 1) = high_byte(values.at(i));
  }
}

void SimulatedBmi270::measure(const std::array<core::AngularRate, 3>& rate,
                              core::Temperature temperature) {
  if (!is_powered()) return;
  if ((registers_[pwr_ctrl] & 0x08U) != 0) {
    const std::int16_t warmth = to_counts((static_cast<double>(temperature.degc()) - 23.0) * 512.0);
    registers_[temperature_0] = low_byte(warmth);
    registers_[temperature_0 + 1] = high_byte(warmth);
  }
  const double dps_per_lsb = 2000.0 / std::exp2(15.0 + (registers_[gyr_range] & 0x07U));
  const double transient_dps = start_up_transient_dps(clock_->now() - gyro_on_at_, kGyroStart);
  Counts counts{};
  const double of_z_dps = in_deg_per_s(rate[2]) * cross_counts_ / 512.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double cross_dps = axis == 0 ? of_z_dps : 0.0;
    counts[axis] = to_counts((in_deg_per_s(rate[axis]) + cross_dps + transient_dps) / dps_per_lsb);
  }
  set_words(gyr_data, counts);
  registers_[status] |= 0x40U;
  if (is_accelerometer_powered()) {
    const double g_per_lsb = 2.0 * std::exp2(registers_[acc_range] & 0x03U) / 32768.0;
    set_words(acc_data,
              convert_force(g_per_lsb, clock_->now() - accelerometer_on_at_, kAccelerometerStart));
    registers_[status] |= 0x80U;
  }
  push_frame();
  drive_int1();
}

std::size_t SimulatedBmi270::frame_bytes() const {
  const unsigned enabled = registers_[fifo_config_1];
  return ((enabled & 0x80U) != 0 ? 6U : 0U) + ((enabled & 0x40U) != 0 ? 6U : 0U);
}

/// A full FIFO loses its oldest frame, or what comes. With headers, which are not modelled, nothing
/// is kept.
void SimulatedBmi270::push_frame() {
  const unsigned enabled = registers_[fifo_config_1];
  if ((enabled & 0x10U) != 0 || frame_bytes() == 0) return;
  const bool stops = (registers_[fifo_config_0] & 0x01U) != 0;
  if (stops && fifo_.size() + frame_bytes() > kFifoBytes) return;
  while (fifo_.size() + frame_bytes() > kFifoBytes) {
    for (std::size_t i = 0; i < frame_bytes(); ++i) fifo_.pop_front();
  }
  const auto append = [&](std::size_t first) {
    for (std::size_t i = 0; i < 6; ++i) fifo_.push_back(registers_.at(first + i));
  };
  if ((enabled & 0x80U) != 0) append(gyr_data);
  if ((enabled & 0x40U) != 0) append(acc_data);
}

std::uint8_t SimulatedBmi270::read_fifo_byte() {
  if (fifo_.empty()) return 0x80;
  const std::uint8_t byte = fifo_.front();
  fifo_.pop_front();
  return byte;
}

std::uint8_t SimulatedBmi270::read_register(std::uint8_t address) {
  address &= 0x7FU;
  std::uint8_t value = registers_.at(address);
  if (address == fifo_data) {
    value = read_fifo_byte();
  } else if (address == fifo_length_0) {
    value = static_cast<std::uint8_t>(fifo_.size() & 0xFFU);
  } else if (address == fifo_length_1) {
    value = static_cast<std::uint8_t>(fifo_.size() >> 8U);
  } else if (address == internal_status_0) {
    value = internal_status();
  } else if (address == gyr_cas && registers_[feat_page] == 0) {
    value = is_initialised() ? static_cast<std::uint8_t>(cross_counts_ & 0x7F) : std::uint8_t{0};
  } else if (address >= gyr_data && address <= gyr_data_end) {
    registers_[status] &= 0xBFU;  // drdy_gyr
  } else if (address >= acc_data && address < gyr_data) {
    registers_[status] &= 0x7FU;  // drdy_acc
  }
  drive_int1();
  return value;
}

/// A byte of the file. In power save, and once the file is complete, none is taken.
void SimulatedBmi270::load(std::uint8_t value) {
  const bool is_saving = (registers_[pwr_conf] & 0x01U) != 0;
  const bool is_closed = (registers_[init_ctrl] & 0x01U) != 0;
  if (is_saving || is_closed || place_ >= kImageBytes) return;
  image_.at(place_) = value;
  is_loaded_.at(place_) = true;
  ++place_;
}

void SimulatedBmi270::finish_loading() {
  const auto bytes = static_cast<std::size_t>(std::ranges::count(is_loaded_, true));
  const bool has_gap = loaded().size() != bytes;
  is_file_good_ = bytes > 0 && !has_gap && sum_of(loaded()) == kSumOfFile;
  judged_at_ = clock_->now() + kJudgement;
}

void SimulatedBmi270::run(std::uint8_t command) {
  if (command == 0xB0) fifo_.clear();
  if (command == 0xB6) {
    reset_registers();
    reset_until_ = clock_->now() + kResetTime;
  }
}

void SimulatedBmi270::write_register(std::uint8_t address, std::uint8_t value) {
  address &= 0x7FU;
  if (is_resetting() || is_read_only(address)) return;
  if (!is_writable(address)) {
    ++reserved_writes_;
    return;
  }
  const std::uint8_t before = registers_.at(address);
  if (address == init_data) return load(value);
  if (address == cmd) {
    run(value);
  } else {
    registers_.at(address) = value;
    react(address, static_cast<std::uint8_t>(value & ~before));
  }
  drive_int1();
}

/// @param risen  bits of the register that became 1
void SimulatedBmi270::react(std::uint8_t address, std::uint8_t risen) {
  switch (address) {
    case init_addr_0:
    case init_addr_1:
      place_ = std::size_t{2} * (registers_[init_addr_0] % 16U + 16U * registers_[init_addr_1]);
      break;
    case init_ctrl:
      if ((risen & 0x01U) != 0) finish_loading();
      break;
    case pwr_ctrl:
      if ((risen & 0x02U) != 0) gyro_on_at_ = clock_->now();
      if ((risen & 0x04U) != 0) accelerometer_on_at_ = clock_->now();
      break;
    case fifo_config_1:
      fifo_.clear();  // frames of another content
      break;
    default:
      break;
  }
}

std::uint8_t SimulatedBmi270::next_address(std::uint8_t address) const {
  const unsigned register_address = address & 0x7FU;
  const bool stays = register_address == fifo_data || register_address == init_data;
  return stays ? address : static_cast<std::uint8_t>((address + 1U) & 0x7FU);
}

void SimulatedBmi270::drive_int1() {
  const unsigned mapped = registers_[int_map_data];
  const bool is_output = (registers_[int1_io_ctrl] & 0x08U) != 0;
  const bool is_active_high = (registers_[int1_io_ctrl] & 0x02U) != 0;
  const std::size_t watermark =
      registers_[fifo_wtm_0] | (static_cast<std::size_t>(registers_[fifo_wtm_1] & 0x1FU) << 8U);
  const bool is_ready = (registers_[status] & 0xC0U) != 0 && (mapped & 0x04U) != 0;
  const bool is_filled = fifo_.size() >= watermark && watermark > 0 && (mapped & 0x02U) != 0;
  interrupt_.drive(is_output && (is_ready || is_filled) == is_active_high, clock_->now());
}

}  // namespace zerorate::hal::sim
