#include "hal/sim/lsm6dso.hpp"

#include <bit>
#include <cmath>

#include "hal/sim/conversion.hpp"

namespace zerorate::hal::sim {
namespace {

// Written from the datasheet apart from the driver's tables, so that each checks the other.
enum Address : std::uint8_t {
  func_cfg_access = 0x01,
  fifo_ctrl1 = 0x07,
  fifo_ctrl2 = 0x08,
  fifo_ctrl3 = 0x09,
  fifo_ctrl4 = 0x0A,
  int1_ctrl = 0x0D,
  who_am_i = 0x0F,
  ctrl1_xl = 0x10,
  ctrl2_g = 0x11,
  ctrl3_c = 0x12,
  ctrl4_c = 0x13,
  ctrl8_xl = 0x17,
  ctrl9_xl = 0x18,
  ctrl10_c = 0x19,
  status_reg = 0x1E,
  out_temp_l = 0x20,
  outx_l_a = 0x28,
  outz_h_a = 0x2D,
  fifo_status1 = 0x3A,
  fifo_status2 = 0x3B,
  timestamp0 = 0x40,
  timestamp2 = 0x42,
  internal_freq_fine = 0x63,
  fifo_data_out_tag = 0x78,
  fifo_data_out_z_h = 0x7E,
};

constexpr core::Duration kResetTime = core::Duration::microseconds(50);
constexpr core::Duration kBootTime = core::Duration::milliseconds(10);
constexpr std::uint8_t kBoot = 0x80;  // bit of CTRL3_C

// The registers of the user bank that may be written (DS12140, chapter 8).
bool is_writable(std::uint8_t address) {
  return address == 0x01 || address == 0x02 || (address >= 0x07 && address <= 0x0E) ||
         (address >= 0x10 && address <= 0x19) || (address >= 0x56 && address <= 0x5F) ||
         address == 0x62 || (address >= 0x6F && address <= 0x75);
}

bool is_read_only(std::uint8_t address) {
  return address == who_am_i || (address >= 0x1A && address <= 0x1E) ||
         (address >= 0x20 && address <= 0x2D) || (address >= 0x35 && address <= 0x37) ||
         (address >= 0x39 && address <= 0x3B) || (address >= 0x40 && address <= 0x43) ||
         address == internal_freq_fine || address >= fifo_data_out_tag;
}

double dps_per_lsb(std::uint8_t ctrl2, bool has_4000_dps) {
  if (has_4000_dps && (ctrl2 & 0x01U) != 0) return 0.14;
  if ((ctrl2 & 0x02U) != 0) return 0.004375;
  constexpr std::array kByRange{0.00875, 0.0175, 0.035, 0.07};
  return kByRange[(ctrl2 >> 2U) & 3U];
}

// Code 1 is 16 g; with XL_FS_MODE, 2 g.
double g_per_lsb(std::uint8_t ctrl1, bool has_new_meaning) {
  constexpr std::array kByRange{0.061e-3, 0.488e-3, 0.122e-3, 0.244e-3};
  const unsigned code = (ctrl1 >> 2U) & 3U;
  return has_new_meaning && code == 1 ? kByRange[0] : kByRange.at(code);
}

constexpr core::Duration kAccelerometerTurnOn = core::Duration::milliseconds(20);

}  // namespace

void SimulatedStModule::reset_data() {
  outputs_ = {};
  fifo_.clear();
  has_overwritten_ = false;
  is_overrun_latched_ = false;
  time_slot_ = 0;
}

bool SimulatedStModule::is_settling() const {
  return clock_->now() - powered_at_ < data_path_.turn_on_time;
}

void SimulatedStModule::convert(const std::array<core::AngularRate, 3>& rate,
                                core::Temperature temperature, double dps_per_lsb) {
  outputs_[0].value = to_counts((static_cast<double>(temperature.degc()) - 25.0) * 256.0);
  const double transient_dps =
      start_up_transient_dps(clock_->now() - powered_at_, data_path_.turn_on_time);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    outputs_[axis + 1].value = to_counts((in_deg_per_s(rate[axis]) + transient_dps) / dps_per_lsb);
  }
}

void SimulatedStModule::convert_acceleration(double g_per_lsb) {
  const core::Duration age = clock_->now() - accelerometer_powered_at_;
  const Counts counts = convert_force(g_per_lsb, age, kAccelerometerTurnOn);
  for (std::size_t axis = 0; axis < 3; ++axis) outputs_[axis + 4].value = counts[axis];
}

std::array<std::int16_t, 3> SimulatedStModule::accelerations() const {
  return {outputs_[4].value, outputs_[5].value, outputs_[6].value};
}

std::array<std::int16_t, 3> SimulatedStModule::rates() const {
  return {outputs_[1].value, outputs_[2].value, outputs_[3].value};
}

std::size_t SimulatedStModule::watermark() const {
  const bool is_high = (registers_[fifo_ctrl2] & data_path_.watermark_high_bit) != 0;
  return registers_[fifo_ctrl1] + (is_high ? 256U : 0U);
}

bool SimulatedStModule::is_at_watermark() const {
  return watermark() > 0 && fifo_.size() >= watermark();
}

std::size_t SimulatedStModule::fifo_capacity() const {
  const bool stops_on_watermark = (registers_[fifo_ctrl2] & 0x80U) != 0;
  return stops_on_watermark ? watermark() : data_path_.fifo_words;
}

bool SimulatedStModule::is_batched() const {
  return (registers_[fifo_ctrl3] & 0xF0U) != 0;
}

bool SimulatedStModule::is_acceleration_batched() const {
  return (registers_[fifo_ctrl3] & 0x0FU) != 0;
}

bool SimulatedStModule::push_fifo_word(unsigned tag, const std::array<std::int16_t, 3>& values) {
  constexpr unsigned kFifoMode = 1;
  constexpr unsigned kContinuous = 6;
  const unsigned mode = registers_[fifo_ctrl4] & 0x07U;
  if (data_path_.fifo_words == 0 || (mode != kFifoMode && mode != kContinuous)) return false;
  if (fifo_.size() >= fifo_capacity()) {
    has_overwritten_ = true;
    is_overrun_latched_ = true;
    if (mode == kFifoMode) return false;
    fifo_.pop_front();
  }
  FifoWord word{static_cast<std::uint8_t>(tag)};
  for (std::size_t i = 0; i < 6; ++i) {
    const std::int16_t value = values.at(i / 2);
    word.at(i + 1) = i % 2 == 1 ? high_byte(value) : low_byte(value);
  }
  fifo_.push_back(word);
  return true;
}

std::uint8_t SimulatedStModule::read_output(std::uint8_t address) {
  const std::size_t offset = static_cast<std::size_t>(address) - out_temp_l;
  Output& output = outputs_.at(offset / 2);
  const bool is_high = offset % 2 == 1;
  const bool is_blocked = (registers_[ctrl3_c] & 0x40U) != 0;
  const std::int16_t value = output.held.value_or(output.value);
  if (is_high) {
    output.held.reset();
    constexpr std::array<std::uint8_t, 3> kKept{0xFB, 0xFD, 0xFE};  // TDA, GDA, XLDA fall
    registers_[status_reg] &= kKept.at(offset < 2 ? 0 : (address < outx_l_a ? 1 : 2));
  } else if (is_blocked) {
    output.held = value;
  }
  return is_high ? high_byte(value) : low_byte(value);
}

std::uint8_t SimulatedStModule::read_fifo_byte(std::uint8_t address) {
  if (fifo_.empty()) return 0;
  const std::uint8_t byte = fifo_.front().at(static_cast<std::size_t>(address) - fifo_data_out_tag);
  if (address == fifo_data_out_z_h) {
    fifo_.pop_front();
    has_overwritten_ = false;
  }
  return byte;
}

std::optional<std::uint8_t> SimulatedStModule::read_data(std::uint8_t address) {
  if (address >= out_temp_l && address <= outz_h_a) return read_output(address);
  if (address >= fifo_data_out_tag && address <= fifo_data_out_z_h) return read_fifo_byte(address);
  return std::nullopt;
}

std::uint8_t SimulatedStModule::take_fifo_status2(bool is_overrun) {
  auto status = static_cast<unsigned>(fifo_.size() >> 8U);
  if (is_at_watermark()) status |= 0x80U;
  if (is_overrun) status |= 0x40U;
  if (fifo_.size() + 1 >= fifo_capacity()) status |= 0x20U;
  if (is_overrun_latched_) status |= 0x08U;
  is_overrun_latched_ = false;
  return static_cast<std::uint8_t>(status);
}

void SimulatedStModule::end_write(std::uint8_t address) {
  const bool is_bypass = (registers_[fifo_ctrl4] & 0x07U) == 0;
  if (address == fifo_ctrl4 && is_bypass) fifo_.clear();
  drive_int1();
}

std::uint8_t SimulatedStModule::next_address(std::uint8_t address) const {
  const bool increments = (registers_[ctrl3_c] & 0x04U) != 0;
  if (!increments) return address;
  if (address == fifo_data_out_z_h) return fifo_data_out_tag;  // bursts of words
  return static_cast<std::uint8_t>((address + 1U) & 0x7FU);
}

void SimulatedStModule::drive_int1() {
  const unsigned routed = registers_[int1_ctrl];
  const bool is_ready = (registers_[status_reg] & 0x02U) != 0 && (routed & 0x02U) != 0;
  const bool is_filled = is_at_watermark() || has_reached_other_watermark_;
  interrupt_.drive(is_ready || (is_filled && (routed & 0x08U) != 0), clock_->now());
}

void SimulatedLsm6dso::reset_registers() {
  registers_.fill(0);
  for (auto& bank : other_banks_) bank.fill(0);
  registers_[0x02] = 0x3F;
  registers_[who_am_i] = identity_;
  registers_[ctrl3_c] = 0x04;
  registers_[ctrl9_xl] = 0xE0;
  registers_[internal_freq_fine] = static_cast<std::uint8_t>(trim_);
  reset_data();
  boot_until_ = clock_->now();
  drive_int1();
}

void SimulatedLsm6dso::cycle_power() {
  reset_registers();
}

bool SimulatedLsm6dso::is_powered() const {
  return !is_resetting() && (registers_[ctrl2_g] & 0xF0U) != 0;
}

bool SimulatedLsm6dso::is_accelerometer_powered() const {
  return !is_resetting() && (registers_[ctrl1_xl] & 0xF0U) != 0;
}

core::Duration SimulatedLsm6dso::sample_period() const {
  const unsigned code = registers_[ctrl2_g] >> 4U;
  if (code == 0) return {};
  const double rate_hz = 6667.0 * (1.0 + 0.0015 * trim_) / std::exp2(10.0 - code);
  return core::Duration::nanoseconds(std::llround(1e9 / rate_hz));
}

/// Bank that FUNC_CFG_ACCESS shows in the place of the user's: of the embedded functions or of the
/// sensor hub. Null: the user's.
bool SimulatedLsm6dso::shows_other_bank() const {
  return registers_[func_cfg_access] >> 6U != 0;
}

std::array<std::uint8_t, 128>& SimulatedLsm6dso::other_bank() {
  return other_banks_.at(registers_[func_cfg_access] >> 6U == 1 ? 1 : 0);
}

std::uint32_t SimulatedLsm6dso::timestamp() const {
  constexpr double kTick_ns = 25'000.0;
  if ((registers_[ctrl10_c] & 0x20U) == 0) return 0;
  const auto passed_ns = static_cast<double>((clock_->now() - timestamp_zero_).ns());
  return static_cast<std::uint32_t>(passed_ns * (1.0 + 0.0015 * trim_) / kTick_ns);
}

/// While the filters settle, DRDY_MASK holds data-ready back and marks what goes into the FIFO.
bool SimulatedLsm6dso::is_masked() const {
  return (registers_[ctrl4_c] & 0x08U) != 0 && is_settling();
}

void SimulatedLsm6dso::measure(const std::array<core::AngularRate, 3>& rate,
                               core::Temperature temperature) {
  if (!is_powered()) return;
  convert(rate, temperature, dps_per_lsb(registers_[ctrl2_g], identity_ == kIdentityWith4000Dps));
  unsigned ready = 0x06;  // GDA, TDA
  has_acceleration_ = is_accelerometer_powered() && !take_loss();
  if (has_acceleration_) {
    convert_acceleration(g_per_lsb(registers_[ctrl1_xl], (registers_[ctrl8_xl] & 0x02U) != 0));
    ready |= 0x01U;  // XLDA
  }
  if (!is_masked()) registers_[status_reg] |= static_cast<std::uint8_t>(ready);
  batch();
  drive_int1();
}

/// One time slot of the FIFO: the time stamp first, where it is batched, the gyro's word and the
/// accelerometer's.
void SimulatedLsm6dso::batch() {
  constexpr unsigned kGyro = 1;
  constexpr unsigned kAccelerometer = 2;
  constexpr unsigned kTimeStamp = 4;
  const bool has_acceleration = has_acceleration_ && is_acceleration_batched();
  if (!is_batched() && !has_acceleration) return;
  if ((registers_[fifo_ctrl4] & 0xC0U) == 0x40U && (registers_[ctrl10_c] & 0x20U) != 0) {
    const std::uint32_t ticks = timestamp();
    push_tagged(kTimeStamp, {static_cast<std::int16_t>(ticks & 0xFFFFU),
                             static_cast<std::int16_t>(ticks >> 16U), 0});
  }
  constexpr std::int16_t kInvalid = 0x7FFF;
  constexpr std::array kMasked{kInvalid, kInvalid, kInvalid};
  if (is_batched()) push_tagged(kGyro, is_masked() ? kMasked : rates());
  if (has_acceleration) push_tagged(kAccelerometer, is_masked() ? kMasked : accelerations());
  time_slot_ = static_cast<std::uint8_t>((time_slot_ + 1U) & 3U);
}

void SimulatedLsm6dso::push_tagged(unsigned sensor, const std::array<std::int16_t, 3>& values) {
  const unsigned tag = (sensor << 3U) | (unsigned{time_slot_} << 1U);
  // Parity: an even number of ones.
  push_fifo_word(tag | (static_cast<unsigned>(std::popcount(tag)) & 1U), values);
}

std::uint8_t SimulatedLsm6dso::read_register(std::uint8_t address) {
  address &= 0x7FU;
  if (address != func_cfg_access && shows_other_bank()) return other_bank().at(address);
  std::uint8_t value = registers_[address];
  if (const auto data = read_data(address)) {
    value = *data;
  } else if (address >= timestamp0 && address < timestamp0 + 4) {
    value = static_cast<std::uint8_t>(timestamp() >> (8U * (address - timestamp0)));
  } else if (address == fifo_status1) {
    value = static_cast<std::uint8_t>(fifo_words() & 0xFFU);
  } else if (address == fifo_status2) {
    value = take_fifo_status2(has_overwritten());
  } else if (address == ctrl3_c && is_resetting()) {
    value |= 0x01U;
  } else if (address == ctrl3_c && clock_->now() < boot_until_) {
    value |= kBoot;
  }
  drive_int1();
  return value;
}

/// Begins what takes time after a write: the reboot, the time stamps, the gyro's turn-on.
void SimulatedLsm6dso::note_time_of(std::uint8_t address, std::uint8_t value) {
  const core::Instant now = clock_->now();
  if (address == ctrl3_c && (value & kBoot) != 0) boot_until_ = now + kBootTime;
  if (address == ctrl10_c && (registers_[ctrl10_c] & 0x20U) == 0) timestamp_zero_ = now;
  if (address == ctrl2_g && !is_powered()) powered_at_ = now;
  if (address == ctrl1_xl && !is_accelerometer_powered()) accelerometer_powered_at_ = now;
}

void SimulatedLsm6dso::write_register(std::uint8_t address, std::uint8_t value) {
  address &= 0x7FU;
  if (is_resetting()) return;
  if (address != func_cfg_access && shows_other_bank()) {
    other_bank().at(address) = value;
    return;
  }
  if (address == timestamp2 && value == 0xAA) timestamp_zero_ = clock_->now();
  if (is_read_only(address)) return;
  if (!is_writable(address)) {
    ++reserved_writes_;
    return;
  }
  if (address == ctrl3_c && (value & 0x01U) != 0) {
    reset_registers();
    reset_until_ = clock_->now() + kResetTime;
    return;
  }
  note_time_of(address, value);
  if (address == ctrl3_c) value &= static_cast<std::uint8_t>(~kBoot);  // the chip clears it
  registers_[address] = value;
  end_write(address);
}

}  // namespace zerorate::hal::sim
