/* The example at the top of zerorate.h; a test compares both. */
#include "firmware/c_api/examples/first_steps.h"

static zerorate_node gyro;  // no heap: the storage is yours
float turn_rad;             // since the vehicle drove off, about z
bool is_trusted;            // within 3 deg, with a probability of 95 %

static int64_t now_ns(void) {  // a counter of 32 bits wraps, its differences do not
  static int64_t us;
  us += (uint32_t)(micros() - (uint32_t)us);
  return us * 1000;
}

void start_gyro(void) {  // my_sensor: made by zerorate export --c
  zerorate_config config = zerorate_default_config();
  config.standstill = ZERORATE_BY_WORD;
  (void)zerorate_init(&gyro, &my_sensor, &config);
}

void take_word(bool wheels_are_still) {  // no word for a second: it counts as moving
  (void)zerorate_zero_velocity(&gyro, now_ns(), wheels_are_still);
}

void take_sample(zerorate_measurement measured) {
  zerorate_rate rate;
  measured.time_ns = now_ns();
  is_trusted = zerorate_sample(&gyro, &measured, &rate) == ZERORATE_OK && rate.health.usable &&
               1.96F * rate.turn_sigma_rad[2] < 0.052F;
  if (is_trusted) turn_rad = rate.turn_rad[2];
}
