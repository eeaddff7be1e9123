/* A board that plays a recording of 2,000 samples at 100 Hz with a drive of four seconds in
   between, and prints the bits of what comes out. On a Cortex-M an interrupt brings each sample;
   elsewhere sleeping does. */

#include <super_loop.h>

#define SAMPLES 2000
#define SAMPLE_PERIOD_NS INT64_C(10000000)
#define DRIVE_BEGINS 800
#define DRIVE_ENDS 1200
#define PRINT_EVERY 20

/* Made by foreign_test.py from a recording [rad/s]. */
static const float recording[SAMPLES][ZERORATE_AXES] = {
#include <samples.h>
};

#define REGISTER(address) (*(volatile uint32_t*)(address))
/* Output of the machine, below. */
static void write_text(const char* text);
static void end_program(int code);

static volatile int played;
static volatile bool waits; /* a sample was announced and not read yet */
static int published;

static void write_bits(uint32_t bits) {
  char text[10];
  for (int i = 0; i < 8; ++i) {
    text[i] = "0123456789abcdef"[(bits >> (28 - 4 * i)) & 15U];
  }
  text[8] = ' ';
  text[9] = '\0';
  write_text(text);
}

static void write_float(float number) {
  union {
    float number;
    uint32_t bits;
  } both;
  both.number = number;
  write_bits(both.bits);
}

/* Announces the next sample as soon as the one before was read, so that the loop's speed changes
 * nothing. */
static void next_sample(void) {
  if (!waits && played < SAMPLES) {
    ++played;
    if (played > DRIVE_BEGINS && played <= DRIVE_ENDS) {
      odometer_interrupt();
    }
    waits = true;
    gyro_interrupt();
  }
}

bool board_runs(void) {
  return published < SAMPLES;
}
int64_t board_now_ns(void) {
  return played * SAMPLE_PERIOD_NS;
}

void board_read_gyro(float rate_rad_s[ZERORATE_AXES]) {
  for (int axis = 0; axis < ZERORATE_AXES; ++axis) {
    rate_rad_s[axis] = recording[played - 1][axis];
  }
  waits = false;
}

void board_publish(const zerorate_rate* rate) {
  double half = published / 2.0;
  int lines =
      half; /* a conversion as a guest's code has them, which -Wconversion -Werror would refuse */
  if (2 * lines % PRINT_EVERY == 0 && published % 2 == 0) {
    write_bits((uint32_t)rate->motion << 8 | (uint32_t)rate->health.calibrated << 1 |
               (uint32_t)rate->health.model_inconsistent);
    for (int axis = 0; axis < ZERORATE_AXES; ++axis) {
      write_float(rate->corrected_rad_s[axis]);
      write_float(rate->bias_rad_s[axis]);
      write_float(rate->sigma_rad_s[axis]);
    }
    write_text("\n");
  }
  ++published;
}

void board_tell_heading(const zerorate_heading_error* minute) {
  write_text("heading ");
  write_float(minute->angle_rad);
  write_float(minute->sigma_rad);
  write_text("\n");
}

size_t board_load(uint8_t* record, size_t capacity) {
  (void)record;
  (void)capacity;
  return 0;
}

void board_keep(const uint8_t* record, size_t size) {
  uint32_t sum = 2166136261U; /* FNV-1a */
  for (size_t i = 0; i < size; ++i) {
    sum = (sum ^ record[i]) * 16777619U;
  }
  write_text("record ");
  write_bits((uint32_t)size);
  write_bits(sum);
  write_text("\n");
}

#ifdef ZERORATE_FIGURES
#include <figures.c>
#else
static void tell_figures(void) {}
#endif

int main(void) {
  const zerorate_result result = super_loop();
  tell_figures();
  write_text(result == ZERORATE_OK ? "end\n" : "error\n");
  end_program(result == ZERORATE_OK ? 0 : 1);
  return 0;
}

#if defined(__arm__) /* QEMU's mps2 boards: semihosting, and the processor's own timer */

static uint32_t semihosting(uint32_t operation, const void* parameter) {
  register uint32_t r0 __asm__("r0") = operation;
  register const void* r1 __asm__("r1") = parameter;
  __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}
static void write_text(const char* text) {
  (void)semihosting(0x04, text);
}
static void end_program(int code) {
  const uint32_t block[2] = {0x20026U, (uint32_t)code}; /* ADP_Stopped_ApplicationExit */
  for (;;) {
    (void)semihosting(0x20, block);
  }
}
#ifdef ZERORATE_FIGURES
#define TIMER_CONTROL 5 /* it counts the processor's clock and interrupts nothing */
#define TIMER_PERIODS 0x00FFFFFF
void board_sleep(void) {
  next_sample();
}
#else
#define TIMER_CONTROL 7
#define TIMER_PERIODS 9999
void board_sleep(void) {
  __asm__ volatile("wfi");
}
#endif

void start(void);
void start(void) {
#ifdef __ARM_FP
  REGISTER(0xE000ED88) = 0xFU << 20; /* CPACR: the floating-point unit on */
  __asm__ volatile("dsb\n isb" ::: "memory");
#endif
  REGISTER(0xE000E014) = TIMER_PERIODS; /* SysTick */
  REGISTER(0xE000E018) = 0;
  REGISTER(0xE000E010) = TIMER_CONTROL;
  (void)main();
}
static void fault(void) {
  write_text("fault\n");
  end_program(99);
}
extern uint32_t stack_top[];
__attribute__((section(".vectors"), used)) static const void* const vectors[16] = {
    stack_top,
    (const void*)start,
    (const void*)fault,
    (const void*)fault,
    (const void*)fault,
    (const void*)fault,
    (const void*)fault,
    0,
    0,
    0,
    0,
    (const void*)fault,
    0,
    0,
    (const void*)fault,
    (const void*)next_sample};

#elif defined(__riscv) || defined(__XTENSA__) /* QEMU's user mode: system calls of Linux */

#ifdef __riscv
static long call_system(long number, long a, long b, long c) {
  register long a0 __asm__("a0") = a;
  register long a1 __asm__("a1") = b;
  register long a2 __asm__("a2") = c;
  register long a7 __asm__("a7") = number;
  __asm__ volatile("ecall" : "+r"(a0) : "r"(a1), "r"(a2), "r"(a7) : "memory");
  return a0;
}
enum { kWrite = 64, kExit = 93 };
#else
static long call_system(long number, long a, long b, long c) {
  register long a2 __asm__("a2") = number;
  register long a6 __asm__("a6") = a;
  register long a3 __asm__("a3") = b;
  register long a4 __asm__("a4") = c;
  __asm__ volatile("syscall" : "+r"(a2) : "r"(a6), "r"(a3), "r"(a4) : "memory");
  return a2;
}
enum { kWrite = 13, kExit = 118 };
#endif
static void write_text(const char* text) {
  long length = 0;
  while (text[length] != '\0') {
    ++length;
  }
  (void)call_system(kWrite, 1, (long)text, length);
}
static void end_program(int code) {
  for (;;) {
    (void)call_system(kExit, code, 0, 0);
  }
}
void board_sleep(void) {
  next_sample();
}
void _start(void);
void _start(void) {
  (void)main();
}

/* There is no C library. */
void* memset(void* target, int value, size_t size) {
  volatile uint8_t* bytes = target;
  for (size_t i = 0; i < size; ++i) {
    bytes[i] = (uint8_t)value;
  }
  return target;
}
void* memcpy(void* target, const void* source, size_t size) {
  volatile uint8_t* to = target;
  const uint8_t* from = source;
  for (size_t i = 0; i < size; ++i) {
    to[i] = from[i];
  }
  return target;
}

#else /* a program of this machine */

#include <stdio.h>
#include <stdlib.h>
static void write_text(const char* text) {
  (void)fputs(text, stdout);
}
static void end_program(int code) {
  exit(code);
}
void board_sleep(void) {
  next_sample();
}

#endif
