#include "hal/sim/adis16475.hpp"

#include "hal/sim/conversion.hpp"

namespace zerorate::hal::sim {
namespace {

// Written apart from the driver's tables, so that each checks the other.
enum Address : std::uint8_t {
  diag_stat = 0x02,
  x_gyro_out = 0x06,
  x_accl_out = 0x12,
  temp_out = 0x1C,
  data_cntr = 0x22,
  rang_mdl = 0x5E,
  msc_ctrl = 0x60,
  dec_rate = 0x64,
  glob_cmd = 0x68,
  prod_id = 0x72,
  serial_num = 0x74,
};

constexpr core::Duration kPowerOnTime = core::Duration::milliseconds(250);
constexpr core::Duration kResetTime = core::Duration::milliseconds(200);
/// End of the error of a gyro that has started, and of an accelerometer.
constexpr core::Duration kSettling = core::Duration::milliseconds(120);
constexpr std::uint16_t kSpiError = 0x0008;
constexpr std::uint16_t kWrite = 0x8000;
constexpr std::uint16_t kBurstCommand = 0x6800;

/// Bias corrections, FILT_CTRL, MSC_CTRL to GLOB_CMD, scratch.
bool is_writable(std::uint8_t address) {
  return (address >= 0x40 && address <= 0x57) || address == 0x5C || address == 0x5D ||
         (address >= msc_ctrl && address <= glob_cmd + 1) || (address >= 0x76 && address <= 0x7B);
}

/// DIAG_STAT, outputs and increments, identity.
bool is_read_only(std::uint8_t address) {
  return (address >= diag_stat && address <= 0x3B) || address == rang_mdl ||
         address == rang_mdl + 1 || (address >= 0x6C && address <= serial_num + 1) ||
         (address >= 0x7C && address <= 0x7F);
}

}  // namespace

void SimulatedAdis16475::reset_registers() {
  registers_.fill(0);
  // The chip measures while it starts; the warmth alone is modelled.
  set_word(temp_out, 250);
  set_word(rang_mdl, part_.model);
  set_word(msc_ctrl, 0x00C1);
  set_word(0x66, 0x070A);  // NULL_CNFG
  set_word(prod_id, part_.product);
  set_word(serial_num, 0x1234);
  burst_.fill(0);
  burst_at_ = kNoBurst;
  reply_ = 0;
  status_ = 0;
  interrupt_.drive(false, clock_->now());
}

void SimulatedAdis16475::cycle_power() {
  reset_registers();
  reset_until_ = clock_->now() + kPowerOnTime;
}

core::Duration SimulatedAdis16475::sample_period() const {
  return core::Duration::microseconds(500) * (std::int64_t{word_at(dec_rate)} + 1);
}

std::uint16_t SimulatedAdis16475::word_at(std::uint8_t address) const {
  return static_cast<std::uint16_t>(registers_.at(address) | (registers_.at(address + 1U) << 8U));
}

void SimulatedAdis16475::set_word(std::uint8_t address, std::uint16_t value) {
  registers_.at(address) = static_cast<std::uint8_t>(value & 0xFFU);
  registers_.at(address + 1U) = static_cast<std::uint8_t>(value >> 8U);
}

void SimulatedAdis16475::measure(const std::array<core::AngularRate, 3>& rate,
                                 core::Temperature temperature) {
  if (is_resetting()) return;
  const core::Duration age = clock_->now() - reset_until_;
  const Counts force = convert_force(1.0 / part_.counts_per_g, age, kSettling);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double dps = in_deg_per_s(rate[axis]) + start_up_transient_dps(age, kSettling);
    const auto offset = static_cast<std::uint8_t>(4 * axis);
    set_word(static_cast<std::uint8_t>(x_gyro_out + offset),
             static_cast<std::uint16_t>(to_counts(dps * part_.counts_per_dps)));
    set_word(static_cast<std::uint8_t>(x_accl_out + offset),
             static_cast<std::uint16_t>(force.at(axis)));
  }
  const double warmth = static_cast<double>(temperature.degc()) * 10.0;
  set_word(temp_out, static_cast<std::uint16_t>(to_counts(warmth)));
  set_word(data_cntr, static_cast<std::uint16_t>(word_at(data_cntr) + 1U));
  const bool is_active_high = (registers_[msc_ctrl] & 1U) != 0;
  interrupt_.drive(!is_active_high, clock_->now());  // while the outputs change
  interrupt_.drive(is_active_high, clock_->now());
}

std::uint16_t SimulatedAdis16475::reply() {
  if (is_resetting()) return 0;
  if (burst_at_ < kBurstWords) return burst_.at(burst_at_++);
  return reply_;
}

void SimulatedAdis16475::take(std::uint16_t word) {
  if (is_resetting() || burst_at_ != kNoBurst) return;  // the input is not heard in a burst
  reply_ = 0;
  const auto address = static_cast<std::uint8_t>((word >> 8U) & 0x7FU);
  if (word == kBurstCommand) {
    load_burst();
  } else if ((word & kWrite) != 0) {
    write(address, static_cast<std::uint8_t>(word & 0xFFU));
  } else {
    reply_ = read(static_cast<std::uint8_t>(address & 0x7EU));
  }
}

void SimulatedAdis16475::refuse_clocks() {
  if (!is_resetting()) status_ |= kSpiError;
}

std::uint16_t SimulatedAdis16475::read(std::uint8_t address) {
  if (address != diag_stat) return word_at(address);
  const std::uint16_t status = status_;
  status_ = 0;
  return status;
}

void SimulatedAdis16475::write(std::uint8_t address, std::uint8_t value) {
  if (is_read_only(address)) return;
  if (!is_writable(address)) {
    ++reserved_writes_;
    return;
  }
  registers_.at(address) = value;
  if (address != glob_cmd + 1) return;
  const bool is_reset = (registers_[glob_cmd] & 0x80U) != 0;
  set_word(glob_cmd, 0);
  if (!is_reset) return;
  reset_registers();
  reset_until_ = clock_->now() + kResetTime;
}

void SimulatedAdis16475::load_burst() {
  const auto output = [&](unsigned first, unsigned axis) {
    return word_at(static_cast<std::uint8_t>(first + 4 * axis));
  };
  burst_ = {read(diag_stat),       output(x_gyro_out, 0), output(x_gyro_out, 1),
            output(x_gyro_out, 2), output(x_accl_out, 0), output(x_accl_out, 1),
            output(x_accl_out, 2), word_at(temp_out),     word_at(data_cntr)};
  unsigned sum = 0;
  for (const std::uint16_t word : burst_) sum += (word >> 8U) + (word & 0xFFU);
  burst_.back() = static_cast<std::uint16_t>(sum);
  burst_at_ = 0;
}

}  // namespace zerorate::hal::sim
