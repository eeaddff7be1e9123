/* Ten minutes of a gyro that lies still, and what the node makes of them: docs/examples/library in
 * C. */

#include <stdint.h>
#include <stdio.h>

#include <zerorate.h>

#define SAMPLE_PERIOD_NS INT64_C(10000000)
#define RAD_S_PER_DEG_S 0.0174532925F

/* As `zerorate export --c` writes it, shortened to one mode of the slow noise. */
static const zerorate_model kModel = {
    .sample_period_ns = SAMPLE_PERIOD_NS,
    .tick_ns = INT64_C(500000000),
    .is_stationary = true,
    .white_variance_rad2_s2 = 2.4e-7F,
    .turn_on_variance_rad2_s2 = ZERORATE_UNKNOWN_VARIANCE,
    .decaying = {{.one_minus_phi = 0.0951626F,
                  .noise_variance = 7.25e-11F,
                  .initial_variance = 4e-10F}},
};

static zerorate_node gyro;

int main(void) {
  zerorate_rate newest = {0};
  if (zerorate_init(&gyro, &kModel, NULL) != ZERORATE_OK) {
    return 2;
  }
  for (int i = 0; i < 60000; ++i) {
    zerorate_measurement measured = {.time_ns = i * SAMPLE_PERIOD_NS};
    for (int axis = 0; axis < ZERORATE_AXES; ++axis) {
      measured.rate_rad_s[axis] = 0.002F * RAD_S_PER_DEG_S;
    }
    /* zerorate_pulse(&gyro, when) for each pulse of the odometer */
    if (zerorate_sample(&gyro, &measured, &newest) != ZERORATE_OK) {
      return 2;
    }
  }
  printf("bias %.4f +- %.4f deg/s\n", (double)(newest.bias_rad_s[2] / RAD_S_PER_DEG_S),
         (double)(newest.sigma_rad_s[2] / RAD_S_PER_DEG_S));
  return newest.health.calibrated ? 0 : 1;
}
