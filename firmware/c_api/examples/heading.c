#include "firmware/c_api/examples/heading.h"

#define UP_AXIS 2U
#define SECONDS_PER_NS 1.0e-9F
#define LONGEST_GAP_NS 100000000 /* what was turned in a longer one is unknown */

zerorate_result heading_init(heading* self, const zerorate_model* model) {
  self->newest_ns = 0;
  self->heading_rad = 0.0F;
  self->sigma_rad = 0.0F;
  self->has_sample = false;
  return zerorate_init(&self->gyro, model, NULL);
}

/* Between two samples the vehicle turned by rate * dt. While it stands it did not, whatever the
 * gyro says: that is the update. */
static void integrate(heading* self, const zerorate_rate* rate, bool stands) {
  const int64_t elapsed_ns = rate->time_ns - self->newest_ns;
  const float dt_s = (float)elapsed_ns * SECONDS_PER_NS;
  if (elapsed_ns > LONGEST_GAP_NS) {
    self->has_sample = false;
  }
  if (self->has_sample && !stands && rate->health.calibrated) {
    self->heading_rad += rate->corrected_rad_s[UP_AXIS] * dt_s;
    self->sigma_rad += rate->sigma_rad_s[UP_AXIS] * dt_s;
  }
  self->newest_ns = rate->time_ns;
  self->has_sample = true;
}

zerorate_result heading_step(heading* self, const zerorate_measurement* measured, bool stands) {
  zerorate_rate rate;
  zerorate_result result = zerorate_zero_velocity(&self->gyro, measured->time_ns, stands);
  if (result == ZERORATE_OK) {
    result = zerorate_sample(&self->gyro, measured, &rate);
  }
  if (result == ZERORATE_OK) {
    integrate(self, &rate, stands);
  }
  return result;
}
