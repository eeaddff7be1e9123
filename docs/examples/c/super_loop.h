/* What super_loop.c asks of a board, and what the board's interrupt routines call. */
#ifndef SUPER_LOOP_H
#define SUPER_LOOP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <zerorate.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Call these from the interrupts of the odometer's pin and of the gyro's data-ready pin, both of
 * one priority. */
void odometer_interrupt(void);
void gyro_interrupt(void);

/* Runs until board_runs() returns false. */
zerorate_result super_loop(void);

bool board_runs(void);
int64_t board_now_ns(void); /* one monotonic clock; called in interrupts too */
void board_sleep(void);     /* until the next interrupt: WFI */
void board_read_gyro(float rate_rad_s[ZERORATE_AXES]); /* the newest sample, rad/s */
void board_publish(const zerorate_rate* rate);
void board_tell_heading(const zerorate_heading_error* minute);
size_t board_load(uint8_t* record,
                  size_t capacity); /* bytes of the record of the last run; 0: there is none */
void board_keep(const uint8_t* record, size_t size);

#ifdef __cplusplus
}
#endif

#endif
