#include "hal/sim/lsm6dsl.hpp"

#include "hal/sim/conversion.hpp"

namespace zerorate::hal::sim {
namespace {

enum Address : std::uint8_t {
  fifo_ctrl1 = 0x06,
  fifo_ctrl2 = 0x07,
  fifo_ctrl3 = 0x08,
  fifo_ctrl4 = 0x09,
  fifo_ctrl5 = 0x0A,
  fifo_status1 = 0x3A,
  fifo_status2 = 0x3B,
  fifo_status3 = 0x3C,
  fifo_status4 = 0x3D,
  fifo_data_out_l = 0x3E,
  fifo_data_out_h = 0x3F,
  wake_up_dur = 0x5C,
};

constexpr std::size_t kCapacity = 2046;  // whole sets of three words in 4 kbyte
constexpr unsigned kBypass = 0;
constexpr unsigned kFifoMode = 1;
constexpr unsigned kContinuous = 6;

}  // namespace

unsigned SimulatedLsm6dsl::fifo_mode() const {
  return registers_[fifo_ctrl5] & 0x07U;
}

std::size_t SimulatedLsm6dsl::watermark() const {
  return registers_[fifo_ctrl1] | ((registers_[fifo_ctrl2] & 0x07U) << 8U);
}

void SimulatedLsm6dsl::clear_fifo() {
  words_.clear();
  has_lost_words_ = false;
}

void SimulatedLsm6dsl::cycle_power() {
  SimulatedLsm6dso::cycle_power();
  clear_fifo();
  drive_watermark();
}

void SimulatedLsm6dsl::measure(const std::array<core::AngularRate, 3>& rate,
                               core::Temperature temperature) {
  if (!is_powered()) return;
  SimulatedLsm6dso::measure(rate, temperature);
  batch();
  drive_watermark();
}

/// One set of the pattern. Of the time stamp the upper 16 bits come first.
void SimulatedLsm6dsl::batch() {
  const bool has_rate = (registers_[fifo_ctrl5] & 0x78U) != 0;
  if (!has_rate || (fifo_mode() != kFifoMode && fifo_mode() != kContinuous)) return;
  std::uint8_t place = 0;
  const auto push_all = [&](const std::array<std::int16_t, 3>& values) {
    for (const std::int16_t value : values) push({.value = value, .place = place++});
  };
  if ((registers_[fifo_ctrl3] & 0x38U) != 0) push_all(rates());
  if ((registers_[fifo_ctrl3] & 0x07U) != 0 && has_acceleration()) push_all(accelerations());
  if ((registers_[fifo_ctrl2] & 0x80U) != 0 && (registers_[fifo_ctrl4] & 0x38U) != 0) {
    const bool is_fine = (registers_[wake_up_dur] & 0x10U) != 0;  // 25 us, else 6.4 ms
    const std::uint32_t ticks = is_fine ? timestamp() : timestamp() / 256U;
    push_all({static_cast<std::int16_t>((ticks >> 8U) & 0xFFFFU),
              static_cast<std::int16_t>((ticks & 0xFFU) << 8U), 0});
  }
}

void SimulatedLsm6dsl::push(const Word& word) {
  if (words_.size() >= kCapacity) {
    has_lost_words_ = true;
    if (fifo_mode() == kFifoMode) return;
    words_.pop_front();
  }
  words_.push_back(word);
}

void SimulatedLsm6dsl::drive_watermark() {
  has_reached_other_watermark_ = watermark() > 0 && words_.size() >= watermark();
  drive_int1();
}

std::uint8_t SimulatedLsm6dsl::flags_and_level() const {
  auto status = static_cast<unsigned>(words_.size() >> 8U);
  if (has_reached_other_watermark_) status |= 0x80U;
  if (has_lost_words_) status |= 0x40U;
  if (words_.size() >= kCapacity) status |= 0x20U;
  if (words_.empty()) status |= 0x10U;
  return static_cast<std::uint8_t>(status);
}

std::uint8_t SimulatedLsm6dsl::read_fifo(std::uint8_t address) {
  if (words_.empty()) return 0;
  const std::int16_t value = words_.front().value;
  if (address == fifo_data_out_l) return low_byte(value);
  words_.pop_front();
  has_lost_words_ = false;
  drive_watermark();
  return high_byte(value);
}

std::uint8_t SimulatedLsm6dsl::read_register(std::uint8_t address) {
  address &= 0x7FU;
  if (shows_other_bank()) return SimulatedLsm6dso::read_register(address);
  switch (address) {
    case fifo_status1:
      return static_cast<std::uint8_t>(words_.size() & 0xFFU);
    case fifo_status2:
      return flags_and_level();
    case fifo_status3:
      return words_.empty() ? std::uint8_t{0} : words_.front().place;
    case fifo_status4:
      return 0;
    case fifo_data_out_l:
    case fifo_data_out_h:
      return read_fifo(address);
    default:
      constexpr std::uint8_t kTaggedWords = 0x78;  // data register of the LSM6DSO
      return address >= kTaggedWords ? std::uint8_t{0} : SimulatedLsm6dso::read_register(address);
  }
}

/// FIFO_CTRL1 and what has to do with sensors outside are memory here, and not in the LSM6DSO.
void SimulatedLsm6dsl::write_register(std::uint8_t address, std::uint8_t value) {
  address &= 0x7FU;
  const bool is_memory = (address >= 0x04 && address <= 0x06) || address == 0x1A;
  const bool is_reserved = address == 0x02 || address == 0x0C || address == 0x56 ||
                           address == 0x57 || (address >= 0x62 && address <= 0x72);
  if (shows_other_bank() || !(is_reserved || is_memory)) {
    SimulatedLsm6dso::write_register(address, value);
  } else if (is_reserved) {
    ++reserved_writes_;
  } else {
    registers_.at(address) = value;
  }
  if (is_resetting() || fifo_mode() == kBypass) clear_fifo();
  drive_watermark();
}

std::uint8_t SimulatedLsm6dsl::next_address(std::uint8_t address) const {
  const std::uint8_t next = SimulatedLsm6dso::next_address(address);
  return address == fifo_data_out_h && next != address ? std::uint8_t{fifo_data_out_l} : next;
}

}  // namespace zerorate::hal::sim
