/* Arduino's I2C with an MPU-6050 on it: RM-MPU-6000A-00 rev. 4.2. */
#pragma once

#include <stddef.h>
#include <stdint.h>

class TwoWire {
 public:
  void begin() {}
  void beginTransmission(uint8_t address) {
    is_present_ = address == 0x68;
    count_ = 0;
  }
  size_t write(uint8_t byte);
  uint8_t endTransmission(bool stop = true);
  uint8_t requestFrom(uint8_t address, uint8_t count);
  int read() { return registers_[at_++ & 0x7F]; }

 private:
  void measure();

  bool is_present_ = false;
  int count_ = 0;
  uint8_t at_ = 0;
  uint8_t registers_[128] = {};
};
extern TwoWire Wire;
