/* Firmware without an operating system: interrupts stamp and store, the main loop calls zerorate.
   The board behind it is host_tests/foreign/board.c, which plays a recording; write yours in its
   place. */

#include "super_loop.h"

#include "front_gyro.h"

#define UP_AXIS 2U
#define EVENTS 32U /* a power of two */

/* Static storage that starts as zeros. */
static zerorate_node gyro;
static uint8_t record[ZERORATE_SNAPSHOT_BYTES];

/* A pulse or a sample, in the order of their stamps. One side writes, the other reads: no lock is
 * needed. */
typedef struct event {
  int64_t time_ns;
  bool is_pulse;
} event;
static volatile event events[EVENTS];
static volatile uint32_t written; /* by interrupts alone */
static volatile uint32_t taken;   /* by the main loop alone */
static volatile uint32_t lost;    /* by interrupts alone */

static void store(bool is_pulse) {
  if ((written - taken) < EVENTS) {
    events[written % EVENTS].time_ns = board_now_ns();
    events[written % EVENTS].is_pulse = is_pulse;
    written = written + 1U; /* last: from now on the main loop may read it */
  } else {
    lost = lost + 1U;
  }
}

void odometer_interrupt(void) {
  store(true);
}

void gyro_interrupt(void) {
  store(false);
}

/* The vehicle sets off: how far its heading may be trusted in a minute, and what the next start
 * begins with. */
static void end_stop(void) {
  zerorate_heading_error minute;
  if (zerorate_predict_heading(&gyro, UP_AXIS, 6000U, &minute) == ZERORATE_OK) {
    board_tell_heading(&minute);
  }
  if (zerorate_save(&gyro, ZERORATE_NO_CLOCK, record, sizeof record) == ZERORATE_OK) {
    board_keep(record, sizeof record);
  }
}

static zerorate_result take_sample(int64_t time_ns) {
  static zerorate_motion motion = ZERORATE_MOVING;
  zerorate_measurement measured = {.time_ns = time_ns};
  zerorate_rate rate;
  zerorate_result result;

  board_read_gyro(measured.rate_rad_s);
  result = zerorate_sample(&gyro, &measured, &rate);
  if (result == ZERORATE_OK) {
    board_publish(&rate);
    if ((motion == ZERORATE_STILL) && (rate.motion != ZERORATE_STILL)) {
      end_stop();
    }
    motion = rate.motion;
  }
  return result;
}

static zerorate_result take_event(void) {
  const int64_t time_ns = events[taken % EVENTS].time_ns;
  const bool is_pulse = events[taken % EVENTS].is_pulse;
  taken = taken + 1U; /* the place may be written again */
  return is_pulse ? zerorate_pulse(&gyro, time_ns) : take_sample(time_ns);
}

zerorate_result super_loop(void) {
  uint32_t reported = 0U;
  zerorate_config config = zerorate_default_config();
  zerorate_result result;

  result = zerorate_init(&gyro, &front_gyro, &config);
  const size_t size = board_load(record, sizeof record);
  if ((result == ZERORATE_OK) && (size > 0U)) {
    (void)zerorate_restore(&gyro, ZERORATE_NO_CLOCK, record,
                           size); /* refused: the node begins anew */
  }
  while ((result == ZERORATE_OK) && board_runs()) {
    if (lost !=
        reported) { /* nobody knows whether pulses were among them: the vehicle counts as moving */
      reported = lost;
      result = zerorate_report_odometer_fault(&gyro, board_now_ns());
    } else if (taken != written) {
      result = take_event();
    } else {
      board_sleep();
    }
  }
  return result;
}
