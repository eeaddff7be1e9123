/**
 * @file
 * The example at the top of zerorate.h, to be compiled.
 */
#ifndef ZERORATE_EXAMPLE_FIRST_STEPS_H
#define ZERORATE_EXAMPLE_FIRST_STEPS_H

#include <stdbool.h>
#include <zerorate.h>

#ifdef __cplusplus
extern "C" {
#endif

extern const zerorate_model my_sensor;
extern float turn_rad;
extern bool is_trusted;

uint32_t micros(void); /* of the board: wraps after 71 minutes */

void start_gyro(void);
void take_word(bool wheels_are_still);
void take_sample(zerorate_measurement measured);

#ifdef __cplusplus
}
#endif

#endif /* ZERORATE_EXAMPLE_FIRST_STEPS_H */
