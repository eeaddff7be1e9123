/* SPDX-License-Identifier: GPL-2.0-only WITH Linux-syscall-note */
/*
 * What a process finds in /dev/zerorate_bus: each read() gives one transaction, each write() answers
 * the one that was read last.
 */
#ifndef ZERORATE_BUS_H
#define ZERORATE_BUS_H

#include <linux/types.h>

#define ZERORATE_BUS_SEGMENTS 8
#define ZERORATE_BUS_BYTES 4096

enum { ZERORATE_BUS_I2C = 0, ZERORATE_BUS_SPI = 1 };
/* ZERORATE_SEGMENT_LAST: the chip is deselected after it, another transfer to it follows. */
enum { ZERORATE_SEGMENT_WRITE = 1, ZERORATE_SEGMENT_READ = 2, ZERORATE_SEGMENT_LAST = 4 };

struct zerorate_bus_segment {
	__u32 length;
	__u32 direction; /* of ZERORATE_SEGMENT_*; SPI may read and write */
};

/* Followed by the bytes of all segments, in order; of a segment that is only read they mean nothing. */
struct zerorate_bus_transaction {
	__u32 bus;
	__u32 address; /* I2C; 0 on SPI */
	__u32 mode;    /* SPI */
	__u32 speed_hz;
	__u32 segments;
	struct zerorate_bus_segment segment[ZERORATE_BUS_SEGMENTS];
};

/* Followed by the bytes of all segments, as received where they are read. */
struct zerorate_bus_answer {
	__s32 status; /* 0 or a negative error number */
};

#ifdef __KERNEL__
int zerorate_lines_irq(unsigned int line);
#endif

#endif
