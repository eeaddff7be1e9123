#include "hal/sim/l3gd20h.hpp"

#include <cmath>

#include "hal/sim/conversion.hpp"

namespace zerorate::hal::sim {
namespace {

// Written apart from the driver's tables, so that each checks the other.
enum Address : std::uint8_t {
  who_am_i = 0x0F,
  ctrl1 = 0x20,
  ctrl3 = 0x22,
  ctrl4 = 0x23,
  ctrl5 = 0x24,
  out_temp = 0x26,
  status = 0x27,
  out_x_l = 0x28,
  out_z_h = 0x2D,
  fifo_ctrl = 0x2E,
  fifo_src = 0x2F,
  low_odr = 0x39,
};

constexpr unsigned kRegister = 0x3F;   // bits of an address that name a register
constexpr unsigned kIncrement = 0xC0;  // bit 6 over SPI, bit 7 over I2C
constexpr std::size_t kFifoFrames = 32;
constexpr core::Duration kBootTime = core::Duration::milliseconds(5);
constexpr core::Duration kTurnOnTime = core::Duration::milliseconds(250);

bool is_writable(std::uint8_t address, bool has_low_odr) {
  return (address >= ctrl1 && address <= 0x25) || address == fifo_ctrl || address == 0x30 ||
         (address >= 0x32 && address <= 0x38) || (has_low_odr && address == low_odr);
}

bool is_read_only(std::uint8_t address) {
  return address == who_am_i || (address >= out_temp && address <= out_z_h) ||
         address == fifo_src || address == 0x31;
}

double dps_per_lsb(std::uint8_t value) {
  constexpr std::array kByRange{0.00875, 0.0175, 0.07, 0.07};
  return kByRange[(value >> 4U) & 3U];
}

}  // namespace

void SimulatedL3gd20h::reset_registers() {
  registers_.fill(0);
  registers_[who_am_i] = identity_;
  registers_[ctrl1] = 0x07;
  fifo_.clear();
  newest_ = {};
  has_overwritten_ = false;
  drive_int2();
}

bool SimulatedL3gd20h::is_powered() const {
  const unsigned value = registers_[ctrl1];
  return !is_resetting() && (value & 0x08U) != 0 && (value & 0x07U) != 0;
}

core::Duration SimulatedL3gd20h::sample_period() const {
  if (!is_powered()) return {};
  double rate_hz = std::exp2(registers_[ctrl1] >> 6U);
  rate_hz *= identity_ == kIdentityL3gd20 ? 95.0 : 100.0;
  if ((registers_[low_odr] & 0x01U) != 0) rate_hz /= 8.0;
  return core::Duration::nanoseconds(static_cast<std::int64_t>(1e9 / rate_hz));
}

bool SimulatedL3gd20h::is_fifo_on() const {
  const unsigned mode = registers_[fifo_ctrl] >> 5U;
  return (registers_[ctrl5] & 0x40U) != 0 && (mode == 1 || mode == 2);
}

void SimulatedL3gd20h::measure(const std::array<core::AngularRate, 3>& rate,
                               core::Temperature temperature) {
  if (!is_powered()) return;
  // A count a degree, downwards; the zero is of our choosing.
  registers_[out_temp] = low_byte(to_counts(25.0 - static_cast<double>(temperature.degc())));
  const double transient_dps = start_up_transient_dps(clock_->now() - powered_at_, kTurnOnTime);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool is_on = (registers_[ctrl1] & (1U << axis)) != 0;
    const double dps = in_deg_per_s(rate[axis]) + transient_dps;
    newest_[axis] = is_on ? to_counts(dps / dps_per_lsb(registers_[ctrl4])) : std::int16_t{0};
  }
  const unsigned unread = registers_[status] & 0x0FU;
  registers_[status] = static_cast<std::uint8_t>(registers_[status] | (unread << 4U) | 0x0FU);
  if (is_fifo_on()) push(newest_);
  drive_int2();
}

void SimulatedL3gd20h::push(const Frame& frame) {
  constexpr unsigned kStops = 1;
  if (fifo_.size() == kFifoFrames) {
    has_overwritten_ = true;
    if (registers_[fifo_ctrl] >> 5U == kStops) return;
    fifo_.pop_front();
  }
  fifo_.push_back(frame);
}

/// With the FIFO on, the outputs are its oldest frame, which is gone when its last byte is read.
std::uint8_t SimulatedL3gd20h::read_output(std::uint8_t address) {
  const std::size_t offset = static_cast<std::size_t>(address) - out_x_l;
  const Frame frame = is_fifo_on() && !fifo_.empty() ? fifo_.front() : newest_;
  const std::int16_t value = frame.at(offset / 2);
  const bool is_high = offset % 2 == 1;
  if (is_high) {
    const unsigned axis = 0x11U << (offset / 2);  // ready and overrun
    registers_[status] &= static_cast<std::uint8_t>(~(axis | 0x88U));
  }
  if (address == out_z_h && is_fifo_on() && !fifo_.empty()) {
    fifo_.pop_front();
    has_overwritten_ = false;
  }
  return is_high ? high_byte(value) : low_byte(value);
}

std::uint8_t SimulatedL3gd20h::take_fifo_src() {
  const std::size_t level = fifo_.size();
  const std::size_t threshold = registers_[fifo_ctrl] & 0x1FU;
  unsigned value = static_cast<unsigned>(level < kFifoFrames ? level : kFifoFrames - 1);
  if (level >= threshold && level > 0) value |= 0x80U;
  if (level == kFifoFrames || has_overwritten_) value |= 0x40U;
  if (level == 0) value |= 0x20U;
  return static_cast<std::uint8_t>(value);
}

std::uint8_t SimulatedL3gd20h::read_register(std::uint8_t address) {
  address &= kRegister;
  std::uint8_t value = registers_.at(address);
  if (address >= out_x_l && address <= out_z_h) {
    value = read_output(address);
  } else if (address == fifo_src) {
    value = take_fifo_src();
  }
  drive_int2();
  return value;
}

void SimulatedL3gd20h::write_register(std::uint8_t address, std::uint8_t value) {
  address &= kRegister;
  if (is_resetting() || is_read_only(address)) return;
  const bool has_low_odr = identity_ == kIdentityL3gd20h;
  if (!is_writable(address, has_low_odr)) {
    ++reserved_writes_;
    return;
  }
  if (address == low_odr && (value & 0x04U) != 0) return reset_registers();  // SW_RES
  const bool was_powered = is_powered();
  if (address == ctrl5 && (value & 0x80U) != 0) {  // BOOT, which clears itself
    reset_until_ = clock_->now() + kBootTime;
    value &= 0x7FU;
  }
  registers_.at(address) = value;
  if (!was_powered && is_powered()) powered_at_ = clock_->now();
  if (!is_fifo_on()) {
    fifo_.clear();
    has_overwritten_ = false;
  }
  drive_int2();
}

std::uint8_t SimulatedL3gd20h::next_address(std::uint8_t address) const {
  const unsigned increment = address & kIncrement;
  if (increment == 0) return address;
  const unsigned here = address & kRegister;
  const unsigned next =
      here == out_z_h && is_fifo_on() ? unsigned{out_x_l} : (here + 1) & kRegister;
  return static_cast<std::uint8_t>(increment | next);
}

void SimulatedL3gd20h::drive_int2() {
  const unsigned routed = registers_[ctrl3];
  const bool is_ready = (registers_[status] & 0x08U) != 0 && (routed & 0x08U) != 0;
  const std::size_t threshold = registers_[fifo_ctrl] & 0x1FU;
  const bool is_filled = threshold > 0 && fifo_.size() >= threshold && (routed & 0x04U) != 0;
  interrupt_.drive(is_ready || is_filled, clock_->now());
}

}  // namespace zerorate::hal::sim
