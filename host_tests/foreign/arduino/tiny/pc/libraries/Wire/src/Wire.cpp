#include <Wire.h>

#include <cmath>
#include <random>

#include <board.h>

TwoWire Wire;

size_t TwoWire::write(uint8_t byte) {
  if (count_++ == 0) {
    at_ = byte;
  } else {
    registers_[at_++ & 0x7F] = byte;
  }
  return 1;
}

uint8_t TwoWire::endTransmission(bool) {
  return is_present_ ? 0 : 2;
}

uint8_t TwoWire::requestFrom(uint8_t address, uint8_t count) {
  // Asleep after power-on until PWR_MGMT_1 is written.
  if (address != 0x68 || registers_[0x6B] != 0x01 || registers_[0x1B] != 0x00) return 0;
  measure();
  return count;
}

void TwoWire::measure() {
  static std::mt19937 random{5};
  static std::normal_distribution<double> noise{0.0, 0.035};  // 0.005 deg/s/sqrt(Hz) behind 42 Hz
  const double bias_dps[3] = {-0.7, 0.3, 1.2};
  const double seconds = board_seconds();
  for (int axis = 0; axis < 3; ++axis) {
    const bool turns = axis == 2 && seconds >= 150.0 && seconds < 153.0;
    const double dps = bias_dps[axis] + noise(random) + (turns ? 30.0 : 0.0);
    const auto counts = static_cast<int16_t>(std::lround(131.0 * dps));
    registers_[0x43 + 2 * axis] = static_cast<uint8_t>(static_cast<uint16_t>(counts) >> 8);
    registers_[0x44 + 2 * axis] = static_cast<uint8_t>(counts & 0xFF);
  }
}
