/* Example: nanoseconds of 64 bits from a counter of 32 bits, such as micros(), that wraps. */
#ifndef WIDE_CLOCK_H
#define WIDE_CLOCK_H

#include <stdint.h>

typedef struct wide_clock {
  uint32_t newest; /* reading of the counter */
  int64_t total;   /* counts since the start */
} wide_clock;

/* Adds up what the counter went on by; call it at least once a turn of the counter, in one context
 * alone. */
static inline int64_t wide_clock_ns(wide_clock* self, uint32_t counter, int64_t ns_per_count) {
  const uint32_t since = counter - self->newest; /* right over the wrap, too */
  self->newest = counter;
  self->total += since;
  return self->total * ns_per_count;
}

#endif
