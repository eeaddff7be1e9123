// Heading about the vertical with an MPU-6050 (breakout GY-521) on I2C: SDA, SCL, 3.3 V, GND, AD0 low.
//
// There is no odometer: the calm of the gyro decides what is rest. Let it lie still for ten seconds after power-on. A turn
// that is slow and steady cannot be distinguished from a bias; with wheels, set ZERORATE_BY_WORD and hand over their word
// (zerorate_zero_velocity()). The serial monitor shows heading and its standard deviation in degrees, once a second.

#include <Wire.h>
#include <zerorate.h>

#include "mpu6050_model.h"  // zerorate export mpu6050 --c --name mpu6050_model --sample-rate 100

// Registers: RM-MPU-6000A-00 rev. 4.2, sections 4.4, 4.5, 4.19 and 4.28.
static const uint8_t kAddress = 0x68;
static const uint8_t kConfig = 0x1A;
static const uint8_t kGyroConfig = 0x1B;
static const uint8_t kGyroOut = 0x43;
static const uint8_t kPowerManagement = 0x6B;
static const float kCountRad_s = 0.0174532925F / 131.0F;  // full scale 250 deg/s
static const int64_t kPeriod_us = 10000;

static zerorate_node gyro;

// micros() has 32 bits and wraps after 71 minutes; its differences do not. Call it more often than that.
static int64_t now_us() {
  static uint32_t newest = 0;
  static int64_t since_start = 0;
  const uint32_t now = micros();
  since_start += (uint32_t)(now - newest);
  newest = now;
  return since_start;
}

static void write_register(uint8_t at, uint8_t value) {
  Wire.beginTransmission(kAddress);
  Wire.write(at);
  Wire.write(value);
  Wire.endTransmission();
}

static bool read_rates(float rates_rad_s[3]) {
  Wire.beginTransmission(kAddress);
  Wire.write(kGyroOut);
  if (Wire.endTransmission(false) != 0 || Wire.requestFrom(kAddress, (uint8_t)6) != 6) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const uint8_t high = Wire.read();
    const uint8_t low = Wire.read();
    rates_rad_s[axis] = kCountRad_s * (float)(int16_t)((uint16_t)(high << 8) | low);
  }
  return true;
}

void setup() {
  Serial.begin(115200);
  Wire.begin();
  write_register(kPowerManagement, 0x01);  // awake, clock of the gyro
  write_register(kConfig, 0x03);           // low-pass at 42 Hz
  write_register(kGyroConfig, 0x00);       // 250 deg/s
  zerorate_config config = zerorate_default_config();
  config.standstill = ZERORATE_BY_GYRO;
  config.count_rad_s = kCountRad_s;
  if (zerorate_init(&gyro, &mpu6050_model, &config) != ZERORATE_OK) {
    Serial.println("zerorate: the model does not fit this build");
    while (true) delay(1000);
  }
}

// Between two samples the body turned by rate times time. The rate is integrated at rest, too: the calm of the gyro shows
// half a second late that rest has ended.
static float heading_rad = 0.0F;
static float sigma_rad = 0.0F;  // of its error by the bias, and an upper bound

static void integrate(const zerorate_rate& rate) {
  static int64_t newest_ns = 0;
  const float dt_s = 1e-9F * (float)(rate.time_ns - newest_ns);
  if (newest_ns != 0) {
    heading_rad += dt_s * rate.corrected_rad_s[2];
    sigma_rad += dt_s * rate.sigma_rad_s[2];
  }
  newest_ns = rate.time_ns;
}

void loop() {
  static int64_t next_us = 0;
  static int count = 0;
  if (now_us() < next_us) return;
  next_us = now_us() + kPeriod_us;

  zerorate_measurement measured = {};
  zerorate_rate rate;
  if (!read_rates(measured.rate_rad_s)) return;  // no sample is better than an invented one
  measured.time_ns = 1000 * now_us();
  const zerorate_result result = zerorate_sample(&gyro, &measured, &rate);
  const bool is_usable = result == ZERORATE_OK && rate.health.usable;
  if (is_usable) integrate(rate);
  if (++count % 100 != 0) return;
  if (is_usable) {
    const float degrees = 57.29578F;
    Serial.print(degrees * heading_rad);
    Serial.print(" deg +- ");
    Serial.println(degrees * sigma_rad);
  } else {
    Serial.println("let it lie still");
  }
}
