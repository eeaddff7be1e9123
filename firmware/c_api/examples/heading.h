/**
 * @file
 * Example: a heading integrator that learns the bias of its gyro at standstill (ZARU).
 */
#ifndef ZERORATE_EXAMPLE_HEADING_H
#define ZERORATE_EXAMPLE_HEADING_H

#include <zerorate.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Heading about the vertical axis of one gyro, without what is turned while no rate comes. Static
 * storage; nothing is allocated.
 */
typedef struct heading {
  zerorate_node gyro;
  int64_t newest_ns;
  float heading_rad;
  float
      sigma_rad; /**< of its error, if the errors of the bias agreed all the time: an upper bound */
  bool has_sample;
} heading;

/** The model must be of a gyro whose z axis points up. */
zerorate_result heading_init(heading* self, const zerorate_model* model);

/**
 * One sample and what the vehicle says of itself.
 * @param stands the wheels do not turn: the heading does not change, and the gyro shows its bias
 */
zerorate_result heading_step(heading* self, const zerorate_measurement* measured, bool stands);

#ifdef __cplusplus
}
#endif

#endif /* ZERORATE_EXAMPLE_HEADING_H */
