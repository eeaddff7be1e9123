/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * zerorate for vehicle firmware written in C: the bias of a gyro, learnt whenever the vehicle
 * stands (zero angular rate update), predicted with its error while it moves.
 *
 *     static zerorate_node gyro;  // no heap: the storage is yours
 *     float turn_rad;             // since the vehicle drove off, about z
 *     bool is_trusted;            // within 3 deg, with a probability of 95 %
 *     static int64_t now_ns(void) {  // a counter of 32 bits wraps, its differences do not
 *       static int64_t us;
 *       us += (uint32_t)(micros() - (uint32_t)us);
 *       return us * 1000;
 *     }
 *     void start_gyro(void) {  // my_sensor: made by zerorate export --c
 *       zerorate_config config = zerorate_default_config();
 *       config.standstill = ZERORATE_BY_WORD;
 *       (void)zerorate_init(&gyro, &my_sensor, &config);
 *     }
 *     void take_word(bool wheels_are_still) {  // no word for a second: it counts as moving
 *       (void)zerorate_zero_velocity(&gyro, now_ns(), wheels_are_still);
 *     }
 *     void take_sample(zerorate_measurement measured) {
 *       zerorate_rate rate;
 *       measured.time_ns = now_ns();
 *       is_trusted = zerorate_sample(&gyro, &measured, &rate) == ZERORATE_OK &&
 *                    rate.health.usable && 1.96F * rate.turn_sigma_rad[2] < 0.052F;
 *       if (is_trusted) turn_rad = rate.turn_rad[2];
 *     }
 *
 * Times are nanoseconds of one monotonic clock that does not wrap, from -73 to 146 years of its
 * zero (else ZERORATE_BAD_ARGUMENT); rates are in rad/s, axes are x, y, z of the sensor.
 *
 * Rules:
 * - An instance is used by one context at a time; different instances are independent. An interrupt
 *   routine does not call into an instance that the main program uses: it stores the stamp of its
 *   pulse, and the main program hands it over before the sample that follows.
 * - Nothing blocks, allocates, or keeps a pointer of the caller's. Floating point is single
 *   precision: in an interrupt routine it needs the FPU context saved.
 * - An instance is not copied or moved: after memcpy() every call answers
 *   ZERORATE_NOT_INITIALISED. Keep it in static storage that starts as zeros.
 *
 * Cost, and what each answer means: docs/reference/c-interface.md.
 */
#ifndef ZERORATE_H
#define ZERORATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "zerorate_size.h"

#ifdef __cplusplus
#define ZERORATE_ALIGNED alignas(16)
extern "C" {
#else
#define ZERORATE_ALIGNED _Alignas(16)
#endif

/** Version of header and library. What a version may change: docs/reference/versions.md. */
#define ZERORATE_VERSION "0.2.0"

/** For zerorate_save() and zerorate_restore(): no clock runs while the power is off. */
#define ZERORATE_NO_CLOCK INT64_MIN
/** For zerorate_config: there are pulses alone, and no pulse means that the vehicle stands. */
#define ZERORATE_SILENCE_IS_REST INT64_MAX
/** For zerorate_rate: no stop has been judged yet. */
#define ZERORATE_NO_CALM 255
/** For zerorate_model: what the bias changes by while the power is off is not known. */
#define ZERORATE_UNKNOWN_VARIANCE (-1.0F)

/** Of 32 bits, as the other enumerations, whatever -fshort-enums makes of one on either side. */
typedef int32_t zerorate_result;
enum {
  ZERORATE_OK = 0,
  ZERORATE_NOT_INITIALISED, /**< zerorate_init() has not succeeded, or the instance was moved */
  ZERORATE_BAD_ARGUMENT,    /**< a null pointer, a value out of its range, an impossible time */
  ZERORATE_BAD_MODEL, /**< a figure is no number, above 1e6 (a strength: 1e8) or out of its range */
  ZERORATE_BAD_TIMES, /**< a time is not positive, above an hour, or does not fit the others */
  ZERORATE_BUFFER_TOO_SMALL,
  ZERORATE_TOO_LATE,            /**< zerorate_restore() after the first sample */
  ZERORATE_NOTHING_LEARNT,      /**< there has been no standstill yet */
  ZERORATE_SNAPSHOT_NOT_OURS,   /**< another size, or not our mark */
  ZERORATE_SNAPSHOT_DAMAGED,    /**< its checksum is wrong */
  ZERORATE_SNAPSHOT_VERSION,    /**< another version's */
  ZERORATE_SNAPSHOT_SENSOR,     /**< another sensor's */
  ZERORATE_SNAPSHOT_NOT_USABLE, /**< the model does not say what switching on changes */
  ZERORATE_SAMPLE_REFUSED,      /**< a rate that is not finite, or beyond 1e6 rad/s */
  ZERORATE_SENSOR_FAULT, /**< an axis no longer measures: it is frozen, at full scale, or a ramp */
  ZERORATE_TIME_REFUSED, /**< a sample that is not newer than the one before */
  ZERORATE_CLOCK_WENT_BACK,  /**< a stamp far behind the newest sample: its clock wrapped */
  ZERORATE_REFERENCE_TIME,   /**< after the newest sample, or further back than is remembered */
  ZERORATE_REFERENCE_REFUSED /**< too far from the gyro: it jumps, is late or has another sense */
};

typedef int32_t zerorate_predictor;
enum {
  ZERORATE_KALMAN = 0,      /**< one state a decade of 1/f noise */
  ZERORATE_MOVING_AVERAGE,  /**< the last samples of a stop, as many as the coming lead asks for */
  ZERORATE_CALIBRATION_MEAN /**< the plain mean of the last stop */
};

typedef int32_t zerorate_motion;
enum {
  ZERORATE_MOVING = 0, /**< it moved less than the settle time ago */
  ZERORATE_SETTLING,   /**< still, but not yet for so long that it counts */
  ZERORATE_STILL       /**< samples are being learnt from */
};

/** What tells that the vehicle stands. */
typedef int32_t zerorate_standstill;
enum {
  ZERORATE_BY_ODOMETER = 0,   /**< no pulse, or its own word, and no motion of the gyro */
  ZERORATE_BY_GYRO,           /**< the calm of the gyro alone: pulses are not looked at */
  ZERORATE_BY_ODOMETER_ALONE, /**< no pulse, or its own word, whatever the gyro shows */
  ZERORATE_BY_WORD            /**< its own word, and no motion of the gyro: silence is motion */
};

typedef struct zerorate_complex {
  float re;
  float im;
} zerorate_complex;

/** A Gauss-Markov process at the filter's tick: x' = phi x + noise. */
typedef struct zerorate_decaying_mode {
  float one_minus_phi;    /**< above 0, at most 1 */
  float noise_variance;   /**< a tick [rad2/s2] */
  float initial_variance; /**< [rad2/s2] */
  float initial_mean;     /**< [rad/s] */
} zerorate_decaying_mode;

/** A process whose phase turns by the angle of phi each tick: a periodic disturbance. */
typedef struct zerorate_rotating_mode {
  zerorate_complex one_minus_phi; /**< phi lies in the unit circle */
  float noise_variance;           /**< a tick [rad2/s2] */
  float initial_variance;         /**< [rad2/s2] */
  float initial_mean;             /**< [rad/s] */
} zerorate_rotating_mode;

/** Bias that follows the temperature: slope e + curvature e^2, e = temperature - reference. */
typedef struct zerorate_temperature_drift {
  float reference_degc;
  float slope_rad_s_per_k; /**< expected; learnt in service as far as its sigma allows */
  float slope_sigma_rad_s_per_k;
  float curvature_rad_s_per_k2;
  float curvature_sigma_rad_s_per_k2;
  float lag_s; /**< of the sensing element behind the thermometer; 0: none */
} zerorate_temperature_drift;

/** What a share of the bias may be proportional to, with its unit. */
typedef int32_t zerorate_quantity;
enum {
  ZERORATE_NO_QUANTITY = 0,
  ZERORATE_ACCELERATION_X, /**< specific force along an axis of the sensor [g] */
  ZERORATE_ACCELERATION_Y,
  ZERORATE_ACCELERATION_Z,
  ZERORATE_VIBRATION,       /**< variance of the specific force within a tick, of all axes [g2] */
  ZERORATE_TEMPERATURE_RATE /**< smoothed over a minute [K/s] */
};

/** A share of the bias that follows a measured quantity. */
typedef struct zerorate_input {
  zerorate_quantity quantity;
  float sigma;                      /**< of the coefficients [rad/s per unit] */
  float coefficient[ZERORATE_AXES]; /**< expected; learnt in service as far as sigma allows */
} zerorate_input;

/** A flicker noise that the sensor may have; `zerorate export --c` writes it. */
typedef struct zerorate_hypothesis {
  float strength[ZERORATE_DECAYING_MODES]; /**< variance of each mode over that of the model */
  float log_prior;                         /**< of its probability */
  float level;                             /**< of the slow noise, over that of the model */
  float order;                             /**< d */
  float bias_instability_rad_s;            /**< B */
  float angle_random_walk_rad_per_sqrt_s;  /**< N */
} zerorate_hypothesis;

/** The noise of a sensor at its rates: `zerorate export --c` writes it from a model file. */
typedef struct zerorate_model {
  int64_t sample_period_ns;     /**< nominal; the stamps of the samples decide */
  int64_t tick_ns;              /**< of the filter; not shorter than the sample period */
  bool starts_stationary;       /**< the noise begins at its stationary variance, not at zero */
  bool is_stationary;           /**< and no mode begins apart from it */
  float walk_variance_rad2_s2;  /**< what the level gains a tick */
  float white_variance_rad2_s2; /**< of one sample; positive */
  float measurement_floor_variance_rad2_s2; /**< stays however many samples are averaged */
  float turn_on_variance_rad2_s2;           /**< or ZERORATE_UNKNOWN_VARIANCE */
  float largest_bias_rad_s; /**< by the chip's specification; a larger one is flagged. 0: unknown */
  float scale_factor_sigma; /**< relative tolerance, of a tilted axis too, to 0.2. 0: 0.01 */
  float scale_factor_sigma_per_k; /**< change of it with the temperature; 0: 0.0001 */
  float scale_factor_at_k;        /**< temperature at which the tolerance holds; 0: 298.15 */
  float asymmetry_sigma;          /**< of half the difference between both senses; 0: none */
  float slope_variance_rad2;      /**< of the turn that a slope feigns on a tilted axis; 0: none */
  /** Known relative error of each scale factor, which is taken off the rate; below 0.2 either way.
      0.01: a turn by 100 deg is measured as 101 deg. Zeros: none is known. */
  float scale_factor_error[ZERORATE_AXES];
  float truncation_step_rad_s; /**< step of samples that are cut toward zero, which is undone by
                                  half a step away from it; 0: they are rounded */
  float gate_threshold_sigma;  /**< 0: no gate */
  uint16_t gate_longest_knock_ticks;
  zerorate_decaying_mode decaying[ZERORATE_DECAYING_MODES]; /**< unused ones are zero */
#if ZERORATE_ROTATING_MODES > 0
  zerorate_rotating_mode rotating[ZERORATE_ROTATING_MODES];
#endif
  zerorate_temperature_drift temperature; /**< zeros: the bias does not follow it */
#if ZERORATE_INPUTS > 0
  zerorate_input inputs[ZERORATE_INPUTS]; /**< unused ones are zero; each quantity once */
#endif
  uint8_t hypothesis_count; /**< of those below; 0: the model is taken at its word */
  float evidence_kept;      /**< share of the evidence that a measurement leaves, at most 1 */
  zerorate_hypothesis hypotheses[ZERORATE_HYPOTHESES];
} zerorate_model;

typedef struct zerorate_config {
  int64_t settle_ns;       /**< after the last motion nothing counts for so long */
  int64_t hold_back_ns;    /**< nor until it is so old and still no motion has followed */
  int64_t word_timeout_ns; /**< a word of rest counts for so long; or ZERORATE_SILENCE_IS_REST */
  int64_t odometer_latency_ns;  /**< from the motion to its pulse or word */
  float odometer_dead_band_mps; /**< speed up to which the odometer is silent, 0 to 10 */
  float count_rad_s; /**< rate of one count, by which a frozen axis is found; 0: not known */
  zerorate_predictor predictor; /**< whose bias corrects the rate */
  uint32_t sensor_id;           /**< a snapshot of another sensor is refused */
  zerorate_standstill standstill;
  int8_t up_axis;     /**< 1, 2, 3: x, y, z points up; negative: it points down; 0: not known, and
                         the Earth's rotation stays in the bias unless an accelerometer is read */
  float latitude_deg; /**< north positive; without up_axis 0 means: not known */
} zerorate_config;

/** Every flag is an alarm except `calibrated` and `usable`. */
typedef struct zerorate_health {
  bool calibrated;         /**< a bias was measured, and borne out for a second after it */
  bool sample_refused;     /**< not finite, or beyond 1e6 rad/s: no rate */
  bool time_refused;       /**< not after the sample before: no rate */
  bool saturated;          /**< an axis at full scale: the rate is a lower bound */
  bool model_inconsistent; /**< no hypothesis, or not the model, explains the innovations */
  bool odometer_fault;     /**< pulses were lost since the last sample, or no word comes any more */
  bool measurement_rejected;  /**< the gate took what was measured for a knock */
  bool temperature_missing;   /**< the model follows the temperature, and there is none */
  bool acceleration_missing;  /**< likewise the acceleration */
  bool odometer_disagreement; /**< it turns without pulses, or pulses come without motion */
  bool odometer_dead_band; /**< motion inside most of the newest stops: learnt from is the calm */
  bool sensor_fault;       /**< an axis no longer measures: no rate, and nothing is learnt */
  bool sample_rate_off; /**< samples come at another rate than the model's, by a quarter and more */
  bool reference_disagreement; /**< references of the heading and the gyro cannot both be right */
  bool usable; /**< calibrated, and nothing above puts the rate or its interval in doubt */
} zerorate_health;

/** One sample of the sensor. */
typedef struct zerorate_measurement {
  int64_t time_ns;
  float rate_rad_s[ZERORATE_AXES];
  float temperature_degc; /**< of the sensor, if has_temperature */
  bool has_temperature;
  uint8_t saturated_axes; /**< bit i: axis i at full scale, not learnt from; others are refused */
} zerorate_measurement;

typedef struct zerorate_rate {
  int64_t time_ns;
  zerorate_motion motion;
  zerorate_health health;
  float corrected_rad_s[ZERORATE_AXES]; /**< measured, without scale_factor_error, - bias, over the
                                           scale factor where it was learnt; NaN: no rate */
  float bias_rad_s[ZERORATE_AXES];
  float sigma_rad_s[ZERORATE_AXES];    /**< of the bias; infinite until measured */
  float turn_rad[ZERORATE_AXES];       /**< since the departure from the newest learnt stop */
  float turn_sigma_rad[ZERORATE_AXES]; /**< infinite: no departure, or full scale since */
  int64_t turn_time_ns;                /**< time that is summed since departure */
  float vertical_rad_s;    /**< corrected, about the vertical, counter-clockwise seen from above;
                                NaN where the vertical is not known or there is no rate */
  float heading_rad;       /**< by references (zerorate_references.h), counter-clockwise */
  float heading_sigma_rad; /**< infinite: no reference yet, or the turn since it was lost */
#if ZERORATE_INPUTS > 0
  float up[3]; /**< direction of the vertical in axes of the sensor, by the accelerometer; zero
                  where it is not known */
  float vertical_turn_rad;       /**< turn about it since departure, counter-clockwise from above */
  float vertical_turn_sigma_rad; /**< infinite: not known */
#endif
  uint8_t calm_percent; /**< of the newest stop, learnt from; or ZERORATE_NO_CALM */
} zerorate_rate;

/** Heading error that the bias will cause, as far as it can be predicted. */
typedef struct zerorate_heading_error {
  float angle_rad; /**< of an uncorrected rate; already taken off where the rate is corrected */
  float sigma_rad; /**< of what remains after correction */
} zerorate_heading_error;

/** A figure with its standard deviation. */
typedef struct zerorate_figure {
  float value;
  float sigma;
} zerorate_figure;

/** The noise of an axis as it was learnt from the stops; all zero where nothing is learnt. */
typedef struct zerorate_learnt_noise {
  zerorate_figure order;                            /**< d */
  zerorate_figure bias_instability_rad_s;           /**< B */
  zerorate_figure angle_random_walk_rad_per_sqrt_s; /**< N */
  float stops; /**< that the figures rest on, older ones counted in part */
} zerorate_learnt_noise;

/** Storage of one sensor. Opaque. */
typedef struct zerorate_node {
  ZERORATE_ALIGNED uint8_t opaque[ZERORATE_INSTANCE_BYTES];
} zerorate_node;

/** 1 s to settle, 0.5 s held back, a word counts for 1 s, the Kalman predictor, sensor 0. */
zerorate_config zerorate_default_config(void);

#ifndef DOXYGEN
/* The name that is linked tells the size of an instance. */
#define ZERORATE_JOINED_(name, a, d, r, t, i, h, q, m, c, f) \
  name##_##a##_##d##_##r##_##t##_##i##_##h##_##q##_##m##_##c##_##f
#define ZERORATE_JOINED(name, a, d, r, t, i, h, q, m, c, f) \
  ZERORATE_JOINED_(name, a, d, r, t, i, h, q, m, c, f)
#define zerorate_init                                                                              \
  ZERORATE_JOINED(zerorate_init, ZERORATE_AXES, ZERORATE_DECAYING_MODES, ZERORATE_ROTATING_MODES,  \
                  ZERORATE_TEMPERATURE, ZERORATE_INPUTS, ZERORATE_HYPOTHESES, ZERORATE_HELD_TICKS, \
                  ZERORATE_HAS_MOVING_AVERAGE, ZERORATE_HAS_CALIBRATION_MEAN,                      \
                  ZERORATE_TAKES_REFERENCES)
#endif

/**
 * Begins anew. The model and the configuration are copied.
 * @param config NULL: zerorate_default_config()
 * @return ZERORATE_BAD_ARGUMENT, ZERORATE_BAD_MODEL, ZERORATE_BAD_TIMES
 */
zerorate_result zerorate_init(zerorate_node* self, const zerorate_model* model,
                              const zerorate_config* config);

/**
 * An odometer pulse; before the sample that is not older. Pulses may come late and out of order.
 * After the first zerorate_zero_velocity(), or with ZERORATE_BY_WORD, a stop needs a word too.
 */
zerorate_result zerorate_pulse(zerorate_node* self, int64_t time_ns);

/** The odometer input failed or dropped pulses: the vehicle moves, and it is unknown since when. */
zerorate_result zerorate_report_odometer_fault(zerorate_node* self, int64_t now_ns);

/**
 * The vehicle's own word on whether it stands, as often as it is renewed. A word of rest counts for
 * `word_timeout_ns`, one of motion until the next. From the first word on (ZERORATE_BY_WORD: from
 * the start) silence is motion, and after `word_timeout_ns` each rate has `odometer_fault`.
 */
zerorate_result zerorate_zero_velocity(zerorate_node* self, int64_t time_ns, bool stands);

/**
 * Acceleration of the sensor (specific force: at rest 1 g upwards), at the newest sample or after
 * it, at any rate. For a model with `inputs`.
 * @param acceleration_m_s2 x, y, z
 * @return ZERORATE_BAD_ARGUMENT: a null pointer, or a library without ZERORATE_INPUTS;
 *   ZERORATE_SAMPLE_REFUSED: not finite, or beyond 1000 g
 */
zerorate_result zerorate_acceleration(zerorate_node* self, int64_t time_ns,
                                      const float acceleration_m_s2[3]);

/**
 * One sample, in the order of the stamps; a gap needs no call. One that is refused changes nothing.
 * @param rate the answer; whatever the result is but ZERORATE_OK, its corrected rates are NaN
 * @return ZERORATE_SAMPLE_REFUSED, _TIME_REFUSED, _CLOCK_WENT_BACK, _SENSOR_FAULT
 */
zerorate_result zerorate_sample(zerorate_node* self, const zerorate_measurement* measured,
                                zerorate_rate* rate);

/**
 * The heading error that the bias causes over the coming samples, if the vehicle drives off now.
 * @param samples one or more, of the model's period, taken in whole ticks of the filter
 * @return ZERORATE_NOTHING_LEARNT before the first standstill, ZERORATE_BAD_ARGUMENT
 */
zerorate_result zerorate_predict_heading(const zerorate_node* self, uint8_t axis, uint32_t samples,
                                         zerorate_heading_error* error);

/** The noise of an axis as it was learnt. */
zerorate_result zerorate_get_learnt_noise(const zerorate_node* self, uint8_t axis,
                                          zerorate_learnt_noise* learnt);

/**
 * Writes what has been learnt as a record for the time without power, ZERORATE_SNAPSHOT_BYTES long.
 * @param utc_s seconds since 1970, or ZERORATE_NO_CLOCK
 * @return ZERORATE_NOTHING_LEARNT before it is calibrated, ZERORATE_BUFFER_TOO_SMALL
 */
zerorate_result zerorate_save(zerorate_node* self, int64_t utc_s, uint8_t* record, size_t capacity);

/**
 * Takes a record up, after zerorate_init() and before the first sample: ages it by the time that
 * has passed (without a clock, by a day), and widens it by what switching the sensor on changes. Of
 * a record of another model the biases are taken up, and the noise is learnt anew. A refusal leaves
 * the instance as it was.
 */
zerorate_result zerorate_restore(zerorate_node* self, int64_t utc_s, const uint8_t* record,
                                 size_t size);

#ifdef __cplusplus
}
#endif

#endif /* ZERORATE_H */
