/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * References of the heading for vehicle firmware written in C: they teach the scale factor of the
 * gyro, and what its bias is in motion (docs/design/references.md).
 *
 *     void take_course(int64_t time_ns, float course_deg, float speed_mps) {
 *       if (speed_mps < 5.0F) return;  // a slow receiver has no course
 *       (void)zerorate_heading_reference(&gyro, time_ns, -course_deg * 0.0174533F, 0.012F);
 *     }
 *
 * Of an instance whose vertical is known: by `up_axis`, or by an accelerometer;
 * ZERORATE_BAD_ARGUMENT without. Not of one whose library was compiled with
 * ZERORATE_TAKES_REFERENCES=0: its program does not link.
 */
#ifndef ZERORATE_REFERENCES_H
#define ZERORATE_REFERENCES_H

#include "zerorate.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What references taught of the axis that points up or down. */
typedef struct zerorate_learnt_motion {
  zerorate_figure heading_rad;        /**< at the newest sample; sigma infinite: not known */
  zerorate_figure scale_factor_error; /**< 0.01: the sensor measures 1 % too much */
  zerorate_figure offset_rad_s;       /**< of the bias in motion, which rest does not show */
  float quality;       /**< 0: the scale factor is known as by the model; 1: it is known exactly */
  uint32_t references; /**< references that taught, those before the newest restore included */
  uint32_t drives;     /**< drives in which they did */
} zerorate_learnt_motion;

/**
 * The heading of the vehicle at a time, counter-clockwise seen from above (a compass heading is its
 * negative): a GNSS course in motion, two antennas, a map, a mark at a stop. Needs the vertical.
 * Its time lies in the newest two seconds, or in the stop that lasts. The first one is a beginning;
 * one that hardly anything was turned before is not needed, and answered by ZERORATE_OK too.
 * @param sigma_rad standard deviation of its error, above 0 and at most 1.6
 * @return ZERORATE_REFERENCE_TIME, _REFERENCE_REFUSED: it did not teach; ZERORATE_NOTHING_LEARNT
 *         before the first standstill, ZERORATE_BAD_ARGUMENT
 */
zerorate_result zerorate_heading_reference(zerorate_node* self, int64_t time_ns, float heading_rad,
                                           float sigma_rad);

/**
 * The angle that the vehicle turned by between two times, whole turns included. Each end lies in
 * the newest two seconds, in the stop before the drive or in that after it, or is the end of the
 * turn before.
 * @return as zerorate_heading_reference()
 */
zerorate_result zerorate_turn_reference(zerorate_node* self, int64_t from_ns, int64_t to_ns,
                                        float angle_rad, float sigma_rad);

/** What references taught. ZERORATE_BAD_ARGUMENT where the vertical is not known. */
zerorate_result zerorate_get_learnt_motion(const zerorate_node* self,
                                           zerorate_learnt_motion* learnt);

#ifdef __cplusplus
}
#endif

#endif /* ZERORATE_REFERENCES_H */
