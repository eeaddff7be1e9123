/* Receives the corrected rate of a zerorate node by UDP and prints a line for each message. Needs a
 * C library with sockets alone; bytes are read as docs/reference/rate-frame.md describes them.
 *
 *   cc -std=c11 -o receive_rate receive_rate.c
 *   ./receive_rate [PORT [MESSAGES]]
 *
 * A line holds: number, time in s, motion, corrected rate of x, y and z in deg/s or "none",
 * temperature in deg C or "none", odometer pulses or "none", "calibrated" or "uncalibrated", and
 * how many messages were lost before it.
 */
#define _POSIX_C_SOURCE 200809L

#include <arpa/inet.h>
#include <inttypes.h>
#include <netinet/in.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { BLOCKS_AT = 116, VERSION = 5 }; /* the blocks that byte 3 names begin there */
enum {
  HAS_TEMPERATURE = 0x01,
  HAS_PULSES = 0x02,
  HAS_UP = 0x04,
  HAS_ACCELERATION = 0x08,
  HAS_VIBRATION = 0x10,
  HAS_EXPLAINED = 0x20,
  HAS_SLOPE = 0x40
};
/* Health: a fault is reported in messages without a rate, which must not be taken for standstill.
 */
enum { CALIBRATED = 0x001, NO_RATE = 0x002 | 0x004 | 0x040 };

struct rate_message {
  uint32_t sequence;
  int64_t time_ns;
  unsigned motion; /* 0 moving, 1 settling, 2 still */
  unsigned health;
  unsigned contents; /* HAS_TEMPERATURE and the others, what of this the frame had */
  float corrected_rad_s[3];
  float temperature_c;
  uint32_t odometer_pulses;
  float up[3];                /* unit vector in the axes of the sensor */
  float vertical_turn_rad[2]; /* about it since departure, and the standard deviation */
  float acceleration_m_s2[3];
  float vibration_m_s2;        /* root mean square */
  float slope_rad;             /* between the vertical and its mean over the stops before */
  float explained_rad_s[3][3]; /* of each axis: by temperature, acceleration, vibration */
};

static uint32_t crc32_of(const uint8_t* bytes, size_t size) {
  uint32_t crc = 0xFFFFFFFFU;
  for (size_t i = 0; i < size; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (0xEDB88320U & (0U - (crc & 1U)));
  }
  return ~crc;
}

static uint64_t little_endian(const uint8_t* bytes, size_t size) {
  uint64_t value = 0;
  for (size_t i = 0; i < size; ++i) value |= (uint64_t)bytes[i] << (8 * i);
  return value;
}

static float float_at(const uint8_t* bytes) {
  const uint32_t bits = (uint32_t)little_endian(bytes, 4);
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

/* Takes the values of a block, if the frame has it; the end of the block, or of the one before. */
static size_t take_block(const uint8_t* bytes, size_t at, unsigned is_there, float* values,
                         size_t count) {
  if (!is_there) return at;
  for (size_t i = 0; i < count; ++i) values[i] = float_at(bytes + at + 4 * i);
  return at + 4 * count;
}

/* Bytes before the checksum. */
static size_t checked_bytes(unsigned contents) {
  return BLOCKS_AT + (contents & HAS_UP ? 20U : 0U) + (contents & HAS_ACCELERATION ? 12U : 0U) +
         (contents & HAS_VIBRATION ? 4U : 0U) + (contents & HAS_EXPLAINED ? 36U : 0U) +
         (contents & HAS_SLOPE ? 4U : 0U);
}

/* False for anything that is not a whole rate frame, such as the learnt frame once a second. */
static bool decode(const uint8_t* bytes, size_t size, struct rate_message* message) {
  if (size < BLOCKS_AT || bytes[0] != 'Z' || bytes[1] != 'R' || bytes[2] != VERSION) return false;
  const unsigned contents = bytes[3];
  const size_t checked = checked_bytes(contents);
  if (size != checked + 4) return false;
  if (little_endian(bytes + checked, 4) != crc32_of(bytes, checked)) return false;
  message->contents = contents;
  message->sequence = (uint32_t)little_endian(bytes + 4, 4);
  message->time_ns = (int64_t)little_endian(bytes + 8, 8);
  message->motion = bytes[16];
  message->health = (unsigned)little_endian(bytes + 17, 2);
  for (int axis = 0; axis < 3; ++axis)
    message->corrected_rad_s[axis] = float_at(bytes + 24 + 16 * axis);
  message->temperature_c = float_at(bytes + 68);
  message->odometer_pulses = (uint32_t)little_endian(bytes + 72, 4);
  size_t at = take_block(bytes, BLOCKS_AT, contents & HAS_UP, message->up, 3);
  at = take_block(bytes, at, contents & HAS_UP, message->vertical_turn_rad, 2);
  at = take_block(bytes, at, contents & HAS_ACCELERATION, message->acceleration_m_s2, 3);
  at = take_block(bytes, at, contents & HAS_VIBRATION, &message->vibration_m_s2, 1);
  at = take_block(bytes, at, contents & HAS_EXPLAINED, message->explained_rad_s[0], 9);
  take_block(bytes, at, contents & HAS_SLOPE, &message->slope_rad, 1);
  return message->motion <= 2;
}

static void print(const struct rate_message* message, uint32_t lost) {
  static const char* const motions[] = {"moving", "settling", "still"};
  static const double deg_per_rad = 57.29577951308232;
  printf("%" PRIu32 " %.6f %s", message->sequence, (double)message->time_ns * 1e-9,
         motions[message->motion]);
  for (int axis = 0; axis < 3; ++axis) {
    if (message->health & NO_RATE) {
      printf(" none");
    } else {
      printf(" %.9g", (double)message->corrected_rad_s[axis] * deg_per_rad);
    }
  }
  if (message->contents & HAS_TEMPERATURE) {
    printf(" %.9g", (double)message->temperature_c);
  } else {
    printf(" none");
  }
  if (message->contents & HAS_PULSES) {
    printf(" %" PRIu32, message->odometer_pulses);
  } else {
    printf(" none");
  }
  printf(" %s lost=%" PRIu32 "\n", message->health & CALIBRATED ? "calibrated" : "uncalibrated",
         lost);
  fflush(stdout);
}

int main(int argc, char** argv) {
  const long port = argc > 1 ? strtol(argv[1], NULL, 10) : 24680;
  const long wanted = argc > 2 ? strtol(argv[2], NULL, 10) : 0; /* 0: for ever */
  const int receiver = socket(AF_INET, SOCK_DGRAM, 0);
  struct sockaddr_in here = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
  here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (receiver < 0 || bind(receiver, (const struct sockaddr*)&here, sizeof here) != 0) {
    perror("receive_rate");
    return 1;
  }
  uint32_t expected = 0;
  for (long count = 0; wanted == 0 || count < wanted;) {
    uint8_t bytes[256];
    const ssize_t size = recv(receiver, bytes, sizeof bytes, 0);
    struct rate_message message;
    if (size < 0 || !decode(bytes, (size_t)size, &message)) continue;
    print(&message, count == 0 ? 0 : message.sequence - expected);
    expected = message.sequence + 1;
    ++count;
  }
  close(receiver);
  return 0;
}
