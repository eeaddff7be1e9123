/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Size of an instance of zerorate.h, which includes this header.
 */
#ifndef ZERORATE_SIZE_H
#define ZERORATE_SIZE_H

/**
 * @name Size of an instance
 * Chosen when the library is compiled, and the same for all that includes this header: a program
 * that chose otherwise does not link, because zerorate_init() has another name. Fewer of anything
 * take less memory and less time (docs/reference/c-interface.md has a table).
 * @{
 */
/** Measured axes, the first of a sample: 1 to 3. */
#ifndef ZERORATE_AXES
#define ZERORATE_AXES 3
#endif
/** Decaying modes: a flicker noise takes six, each Gauss-Markov process, warm-up and ramp one. */
#ifndef ZERORATE_DECAYING_MODES
#define ZERORATE_DECAYING_MODES 7
#endif
/** Rotating modes: a periodic disturbance takes one. */
#ifndef ZERORATE_ROTATING_MODES
#define ZERORATE_ROTATING_MODES 1
#endif
/** 1: a model may follow the temperature. */
#ifndef ZERORATE_TEMPERATURE
#define ZERORATE_TEMPERATURE 1
#endif
/** Further inputs that a model may follow: accelerations, vibration, rate of the temperature. */
#ifndef ZERORATE_INPUTS
#define ZERORATE_INPUTS 0
#endif
/** Noise models that an instance weighs: 12, 4 or, without learning, 1. */
#ifndef ZERORATE_HYPOTHESES
#define ZERORATE_HYPOTHESES 12
#endif
/** Ticks of the filter that are held back at most; hold-back and tick must fit. */
#ifndef ZERORATE_HELD_TICKS
#define ZERORATE_HELD_TICKS 16
#endif
/** 1: the moving average runs beside the Kalman predictor. */
#ifndef ZERORATE_HAS_MOVING_AVERAGE
#define ZERORATE_HAS_MOVING_AVERAGE 1
#endif
/** 1: the calibration mean runs beside the Kalman predictor. */
#ifndef ZERORATE_HAS_CALIBRATION_MEAN
#define ZERORATE_HAS_CALIBRATION_MEAN 1
#endif
/** 1: references of the heading teach the scale factor, and the bias in motion. */
#ifndef ZERORATE_TAKES_REFERENCES
#define ZERORATE_TAKES_REFERENCES 1
#endif
/** @} */

/* Terms of inputs, states of a filter, and bytes of its parts. */
#define ZERORATE_TERMS ((2 * ZERORATE_TEMPERATURE) + ZERORATE_INPUTS)
#define ZERORATE_DRIFTS (ZERORATE_DECAYING_MODES + (2 * ZERORATE_ROTATING_MODES) + ZERORATE_TERMS)
#define ZERORATE_FILTER_BYTES                                                   \
  (4 * (1 + ZERORATE_DRIFTS + ((ZERORATE_DRIFTS * (ZERORATE_DRIFTS + 1)) / 2) + \
        (ZERORATE_AXES * (1 + ZERORATE_DRIFTS))))
#define ZERORATE_LEARNS ((ZERORATE_HYPOTHESES > 1) ? 1 : 0)
#define ZERORATE_SPAN_BYTES (28 + (24 * ZERORATE_DECAYING_MODES) + (40 * ZERORATE_ROTATING_MODES))
#define ZERORATE_TICK_INPUT_BYTES \
  ((ZERORATE_TERMS > 0) ? (4 * (ZERORATE_TERMS + ((ZERORATE_INPUTS > 0) ? 3 : 1))) : 0)
#define ZERORATE_INPUT_BYTES                                                         \
  (((92 + (4 * ZERORATE_AXES * ZERORATE_LEARNS)) * ((ZERORATE_TERMS > 0) ? 1 : 0)) + \
   (58 * ZERORATE_TERMS) + ((ZERORATE_INPUTS > 0) ? (156 + ((ZERORATE_AXES == 3) ? 104 : 0)) : 0))
#define ZERORATE_HELD_TICK_BYTES \
  (((20 + (4 * ZERORATE_AXES) + ZERORATE_TICK_INPUT_BYTES + 7) / 8) * 8)
/** Bytes of an instance; what is inside is checked against it when the library is compiled. */
#define ZERORATE_INSTANCE_BYTES                                                                   \
  (904 + (238 * ZERORATE_AXES) + ZERORATE_INPUT_BYTES + (3 * ZERORATE_SPAN_BYTES) +               \
   (17 * ZERORATE_DECAYING_MODES) + (18 * ZERORATE_ROTATING_MODES) + (12 * ZERORATE_DRIFTS) +     \
   (2 * ZERORATE_DECAYING_MODES * (ZERORATE_DECAYING_MODES + 1)) +                                \
   (ZERORATE_HELD_TICKS * ZERORATE_HELD_TICK_BYTES) +                                             \
   (ZERORATE_HYPOTHESES * (ZERORATE_FILTER_BYTES + 4 + (8 * ZERORATE_DRIFTS))) +                  \
   (ZERORATE_LEARNS *                                                                             \
    (56 + (ZERORATE_HYPOTHESES * (24 + (12 * ZERORATE_AXES) + (4 * ZERORATE_DECAYING_MODES))))) + \
   (ZERORATE_AXES *                                                                               \
    ((896 * ZERORATE_HAS_MOVING_AVERAGE) + (42 * ZERORATE_HAS_CALIBRATION_MEAN))) +               \
   (368 * ZERORATE_TAKES_REFERENCES))
/** Bytes that zerorate_save() writes. */
#define ZERORATE_SNAPSHOT_BYTES                                                               \
  (88 + (12 * ZERORATE_AXES) + ZERORATE_TICK_INPUT_BYTES + (48 * ZERORATE_TAKES_REFERENCES) + \
   (ZERORATE_HYPOTHESES * ZERORATE_FILTER_BYTES) +                                            \
   (ZERORATE_LEARNS * (12 + (12 * ZERORATE_AXES * ZERORATE_HYPOTHESES))))

#endif /* ZERORATE_SIZE_H */
