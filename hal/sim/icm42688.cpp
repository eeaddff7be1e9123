#include "hal/sim/icm42688.hpp"

#include <algorithm>
#include <cmath>

#include "hal/sim/conversion.hpp"

namespace zerorate::hal::sim {
namespace {

// Written apart from the driver's tables, so that each checks the other.
enum Address : std::uint8_t {
  device_config = 0x11,
  fifo_config = 0x16,
  temp_data1 = 0x1D,
  accel_data_x1 = 0x1F,
  gyro_data_x1 = 0x25,
  gyro_data_z0 = 0x2A,
  int_status = 0x2D,
  fifo_counth = 0x2E,
  fifo_countl = 0x2F,
  fifo_data = 0x30,
  signal_path_reset = 0x4B,
  intf_config0 = 0x4C,
  pwr_mgmt0 = 0x4E,
  gyro_config0 = 0x4F,
  accel_config0 = 0x50,
  fifo_config1 = 0x5F,
  fifo_config2 = 0x60,
  fifo_config3 = 0x61,
  int_source0 = 0x65,
  who_am_i = 0x75,
  reg_bank_sel = 0x76,
};

constexpr core::Duration kResetTime = core::Duration::milliseconds(1);
constexpr core::Duration kTurnOnTime = core::Duration::milliseconds(30);
constexpr core::Duration kAccelerometerTurnOn = core::Duration::milliseconds(20);

constexpr std::array<std::uint8_t, 25> kWritable{
    device_config, 0x13, 0x14,         fifo_config,  signal_path_reset,
    intf_config0,  0x4D, pwr_mgmt0,    0x4F,         0x50,
    0x51,          0x52, 0x53,         0x54,         0x56,
    0x57,          0x5F, fifo_config2, fifo_config3, 0x62,
    0x63,          0x64, 0x65,         0x66,         reg_bank_sel};

bool is_read_only(std::uint8_t address) {
  return (address >= temp_data1 && address <= 0x38) || address == who_am_i;
}

double dps_per_lsb(std::uint8_t config) {
  return 2000.0 / std::exp2(15.0 + (config >> 5U));
}

double g_per_lsb(std::uint8_t config) {
  return 16.0 / std::exp2(15.0 + (config >> 5U));
}

double rate_hz(std::uint8_t config) {
  switch (config & 0x0FU) {
    case 15:
      return 500.0;
    case 6:
    case 5:
    case 4:
    case 3:
    case 2:
    case 1:
      return 1000.0 * std::exp2(6.0 - (config & 0x0FU));
    default:
      return 200.0 / std::exp2((config & 0x0FU) - 7.0);
  }
}

}  // namespace

void SimulatedIcm42688::reset_registers() {
  registers_.fill(0);
  registers_[0x13] = 0x05;
  for (std::size_t high = temp_data1; high < gyro_data_z0; high += 2) registers_[high] = 0x80;
  registers_[int_status] = 0x10;  // RESET_DONE
  registers_[intf_config0] = 0x30;
  registers_[0x4D] = 0x91;
  registers_[gyro_config0] = 0x06;
  registers_[0x50] = 0x06;
  registers_[0x51] = 0x16;
  registers_[0x52] = 0x11;
  registers_[0x53] = 0x0D;
  registers_[0x54] = 0x23;
  registers_[0x56] = 0x82;
  registers_[0x62] = 0x10;
  registers_[0x64] = 0x10;
  registers_[int_source0] = 0x10;
  registers_[who_am_i] = identity_;
  fifo_.clear();
  is_flushed_ = false;
}

bool SimulatedIcm42688::is_powered() const {
  return !is_resetting() && (registers_[pwr_mgmt0] & 0x0CU) == 0x0CU;  // low-noise mode
}

bool SimulatedIcm42688::is_accelerometer_powered() const {
  return !is_resetting() && (registers_[pwr_mgmt0] & 0x03U) == 0x03U;
}

core::Duration SimulatedIcm42688::sample_period() const {
  if (!is_powered()) return {};
  return core::Duration::nanoseconds(std::llround(1e9 / rate_hz(registers_[gyro_config0])));
}

void SimulatedIcm42688::set_word(std::uint8_t address, std::int16_t value) {
  registers_.at(address) = high_byte(value);
  registers_.at(address + 1U) = low_byte(value);
}

void SimulatedIcm42688::measure(const std::array<core::AngularRate, 3>& rate,
                                core::Temperature temperature) {
  if (!is_powered()) return;
  const bool has_thermometer = (registers_[pwr_mgmt0] & 0x20U) == 0;  // TEMP_DIS
  const auto degc = static_cast<double>(temperature.degc());
  if (has_thermometer) set_word(temp_data1, to_counts((degc - 25.0) * 132.48));
  const double transient_dps = start_up_transient_dps(clock_->now() - powered_at_, kTurnOnTime);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double counts =
        (in_deg_per_s(rate[axis]) + transient_dps) / dps_per_lsb(registers_[gyro_config0]);
    // -32768 is reserved for "no sample".
    set_word(static_cast<std::uint8_t>(gyro_data_x1 + 2 * axis), to_counts(counts, -32766, 32767));
  }
  measure_acceleration();
  registers_[int_status] |= 0x08U;  // DATA_RDY
  push_packet(temperature);
  pulse_int1();
}

void SimulatedIcm42688::measure_acceleration() {
  const Counts counts = convert_force_if(
      is_accelerometer_powered(), g_per_lsb(registers_[accel_config0]),
      clock_->now() - accelerometer_powered_at_, kAccelerometerTurnOn, -32766, 32767);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    set_word(static_cast<std::uint8_t>(accel_data_x1 + 2 * axis), counts[axis]);
  }
}

std::size_t SimulatedIcm42688::watermark_bytes() const {
  return registers_[fifo_config2] + 256U * (registers_[fifo_config3] & 0x0FU);
}

void SimulatedIcm42688::push_packet(core::Temperature temperature) {
  const unsigned mode = registers_[fifo_config] >> 6U;
  const unsigned content = registers_[fifo_config1];
  const bool has_acceleration = (content & 0x01U) != 0;
  if (mode == 0 || (content & 0x12U) != 0x02U) return;  // 20 bits, or without the gyro
  const std::size_t size = has_acceleration ? 16 : 8;
  constexpr unsigned kStream = 1;
  while (fifo_.bytes() + size > kFifoBytes) {
    if (mode != kStream) return;
    fifo_.drop_oldest();
  }
  std::optional<PacketFifo::Axes> acceleration;
  if (has_acceleration) acceleration = PacketFifo::axes_at(registers_, accel_data_x1);
  const double counts = (static_cast<double>(temperature.degc()) - 25.0) * 2.07;
  fifo_.push(PacketFifo::sample(has_acceleration ? 0x60 : 0x20, acceleration,
                                PacketFifo::axes_at(registers_, gyro_data_x1),
                                low_byte(to_counts(counts, -128, 127))));
  if (fifo_.bytes() == kFifoBytes) registers_[int_status] |= 0x02U;         // FIFO_FULL
  if (fifo_.bytes() >= watermark_bytes()) registers_[int_status] |= 0x04U;  // THS
}

std::uint8_t SimulatedIcm42688::read_register(std::uint8_t address) {
  address &= 0x7FU;
  if (address == reg_bank_sel) return registers_[reg_bank_sel];
  if ((registers_[reg_bank_sel] & 7U) != 0) return 0;
  if (address == fifo_data) return fifo_.read_byte();
  // Without FIFO_RESUME_PARTIAL_RD a packet is read whole or again.
  if ((registers_[fifo_config1] & 0x40U) == 0) fifo_.rewind();
  const std::size_t level = is_flushed_ ? 0 : fifo_.bytes() - fifo_.cursor();
  if (address == fifo_countl) is_flushed_ = false;
  if (address == fifo_counth) return static_cast<std::uint8_t>(level >> 8U);
  if (address == fifo_countl) return static_cast<std::uint8_t>(level & 0xFFU);
  const std::uint8_t value = registers_.at(address);
  if (address == int_status) registers_[int_status] = 0;
  return value;
}

/// Begins the start-up of a sensor that this write may switch on.
void SimulatedIcm42688::note_power(std::uint8_t address) {
  if (address != pwr_mgmt0) return;
  if (!is_powered()) powered_at_ = clock_->now();
  if (!is_accelerometer_powered()) accelerometer_powered_at_ = clock_->now();
}

void SimulatedIcm42688::write_register(std::uint8_t address, std::uint8_t value) {
  address &= 0x7FU;
  if (is_resetting()) return;
  if (address != reg_bank_sel && (registers_[reg_bank_sel] & 7U) != 0) return;
  if (is_read_only(address)) return;
  if (std::ranges::find(kWritable, address) == kWritable.end()) {
    ++reserved_writes_;
    return;
  }
  if (address == device_config && (value & 0x01U) != 0) {
    reset_registers();
    reset_until_ = clock_->now() + kResetTime;
    return;
  }
  note_power(address);
  registers_.at(address) = value;
  const bool is_flush = address == signal_path_reset && (value & 0x02U) != 0;
  const bool is_bypass = (registers_[fifo_config] >> 6U) == 0;
  if (is_flush || is_bypass) fifo_.clear();
  is_flushed_ = is_flushed_ || is_flush;
  registers_[signal_path_reset] = 0;  // clears itself
}

std::uint8_t SimulatedIcm42688::next_address(std::uint8_t address) const {
  return address == fifo_data ? address : static_cast<std::uint8_t>((address + 1U) & 0x7FU);
}

/// In pulsed mode the pin is low again long before anybody looks at it.
void SimulatedIcm42688::pulse_int1() {
  const unsigned routed = registers_[int_source0];
  const bool is_at_watermark = watermark_bytes() > 0 && fifo_.bytes() >= watermark_bytes();
  const bool is_pulsed = (routed & 0x08U) != 0 || ((routed & 0x04U) != 0 && is_at_watermark);
  interrupt_.drive(is_pulsed, clock_->now());
  interrupt_.drive(false, clock_->now());
}

}  // namespace zerorate::hal::sim
