/* How many instructions each function of zerorate.h takes and how deep its stack gets, on the drive
   that board.c plays. Linked with --wrap: every call of super_loop.c comes through here. QEMU's
   -icount makes periods of timer 0 of the board a number of instructions; SysTick has 24 bits, too
   few for a call of 655,360 instructions. The interrupt of board.c is off, and sleeping brings the
   next sample. Included by board.c. */

#define TIMER_CONTROL REGISTER(0x40000000)
#define TIMER_VALUE REGISTER(0x40000004)
#define TIMER_RELOAD REGISTER(0x40000008)
#define PAINTED_WORDS 1024
#define PAINT 0xA5A5A5A5U

typedef struct figure {
  uint32_t calls;
  uint32_t most;
  uint64_t sum;
  uint32_t stack_bytes;
} figure;
static figure init_, pulse_, sample_moving, sample_still, predict_, save_;

static void start_timer(void) {
  TIMER_RELOAD = 0xFFFFFFFFU;
  TIMER_VALUE = 0xFFFFFFFFU;
  TIMER_CONTROL = 1U;
}

/* Paints the stack below, calls, counts, and looks how far down the paint is gone. */
#define MEASURE(figure_, call)                          \
  do {                                                  \
    register uint32_t* sp __asm__("sp");                \
    volatile uint32_t* const top = sp;                  \
    for (int i = 1; i <= PAINTED_WORDS; ++i) {          \
      top[-i] = PAINT;                                  \
    }                                                   \
    start_timer();                                      \
    result = (call);                                    \
    const uint32_t periods = 0xFFFFFFFFU - TIMER_VALUE; \
    int depth = PAINTED_WORDS;                          \
    while (depth > 0 && top[-depth] == PAINT) {         \
      --depth;                                          \
    }                                                   \
    note(&(figure_), periods, 4U * (uint32_t)depth);    \
  } while (0)

static void note(figure* of, uint32_t periods, uint32_t stack_bytes) {
  ++of->calls;
  of->sum += periods;
  if (periods > of->most) {
    of->most = periods;
  }
  if (stack_bytes > of->stack_bytes) {
    of->stack_bytes = stack_bytes;
  }
}

/* The name of zerorate_init() in the library is a macro. */
#define JOINED_(prefix, name) prefix##name
#define JOINED(prefix, name) JOINED_(prefix, name)
#define REAL(name) JOINED(__real_, zerorate_##name)
#define WRAP(name) JOINED(__wrap_, zerorate_##name)

zerorate_result REAL(init)(zerorate_node*, const zerorate_model*, const zerorate_config*);
zerorate_result REAL(pulse)(zerorate_node*, int64_t);
zerorate_result REAL(sample)(zerorate_node*, const zerorate_measurement*, zerorate_rate*);
zerorate_result REAL(predict_heading)(const zerorate_node*, uint8_t, uint32_t,
                                      zerorate_heading_error*);
zerorate_result REAL(save)(zerorate_node*, int64_t, uint8_t*, size_t);

zerorate_result WRAP(init)(zerorate_node* self, const zerorate_model* model,
                           const zerorate_config* config) {
  zerorate_result result;
  MEASURE(init_, REAL(init)(self, model, config));
  return result;
}
zerorate_result WRAP(pulse)(zerorate_node* self, int64_t time_ns) {
  zerorate_result result;
  MEASURE(pulse_, REAL(pulse)(self, time_ns));
  return result;
}
zerorate_result WRAP(sample)(zerorate_node* self, const zerorate_measurement* measured,
                             zerorate_rate* rate) {
  static zerorate_motion motion = ZERORATE_SETTLING;
  zerorate_result result;
  if (motion == ZERORATE_STILL) {
    MEASURE(sample_still, REAL(sample)(self, measured, rate));
  } else {
    MEASURE(sample_moving, REAL(sample)(self, measured, rate));
  }
  motion = rate->motion;
  return result;
}
zerorate_result WRAP(predict_heading)(const zerorate_node* self, uint8_t axis, uint32_t samples,
                                      zerorate_heading_error* error) {
  zerorate_result result;
  MEASURE(predict_, REAL(predict_heading)(self, axis, samples, error));
  return result;
}
zerorate_result WRAP(save)(zerorate_node* self, int64_t utc_s, uint8_t* record, size_t capacity) {
  zerorate_result result;
  MEASURE(save_, REAL(save)(self, utc_s, record, capacity));
  return result;
}

static void tell(const char* name, const figure* of) {
  write_text(name);
  write_text(" ");
  write_bits(of->calls);
  write_bits((uint32_t)(of->sum / (of->calls > 0U ? of->calls : 1U)));
  write_bits(of->most);
  write_bits(of->stack_bytes);
  write_text("\n");
}

static void tell_figures(void) {
  tell("zerorate_init", &init_);
  tell("zerorate_pulse", &pulse_);
  tell("zerorate_sample, moving or settling", &sample_moving);
  tell("zerorate_sample, still", &sample_still);
  tell("zerorate_predict_heading, 6000 samples", &predict_);
  tell("zerorate_save", &save_);
}
