/* The example at the top of zerorate.h; a test compares both. */
#include "firmware/c_api/examples/first_steps.h"

static zerorate_node gyro;  // no heap: the storage is yours
float heading_rad;
bool is_trusted = true;

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
  static int64_t newest_ns;
  zerorate_rate rate;
  measured.time_ns = now_ns();
  if (zerorate_sample(&gyro, &measured, &rate) != ZERORATE_OK) return;  // there is no rate
  const int64_t since_ns = rate.time_ns - newest_ns;
  newest_ns = rate.time_ns;
  if (!rate.health.calibrated || since_ns > 100000000) return;
  heading_rad += rate.corrected_rad_s[2] * 1e-9F * (float)since_ns;
  is_trusted = is_trusted && rate.health.usable;
}
