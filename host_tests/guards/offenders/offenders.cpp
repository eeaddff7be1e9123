// Images of which each breaks one gate, under a macro of its name, and one that breaks none.

#include <cstddef>
#include <cstdio>

#if defined(INNOCENT)  // single precision and fixed memory
volatile float number = 1.0F;

extern "C" int main() {
  number = number * 2.0F;
  return 0;
}
#elif defined(HEAP)               // nothing in the image offers operator new
int* volatile kept;

extern "C" int main() {
  kept = new int(1);
  return 0;
}
#elif defined(HEAP_OF_ITS_OWN)    // links, because it brings its own malloc: only its symbols tell
namespace {
unsigned char arena[64];
}

extern "C" [[gnu::used, gnu::noinline]] void* malloc(std::size_t size) {
  return size <= sizeof(arena) ? arena : nullptr;
}

void* volatile kept;

extern "C" int main() {
  kept = malloc(8);
  return 0;
}
#elif defined(EXCEPTION)          // nothing in the image offers __cxa_throw
volatile int number;

extern "C" int main() {
  if (number > 0) throw 1;
  return 0;
}
#elif defined(PRINTING)           // nothing in the image offers printf
volatile int number;

extern "C" int main() {
  std::printf("%d\n", number);
  return 0;
}
#elif defined(DOUBLE_ARITHMETIC)  // openly double, so no promotion to warn of
volatile double number = 1.0;

extern "C" int main() {
  number = number * number;
  return 0;
}
#elif defined(DOUBLE_PROMOTION)   // a constant without its F makes the product a double
volatile float number = 1.0F;

extern "C" int main() {
  number = static_cast<float>(number * 2.5);
  return 0;
}
#elif defined(BIG_STACK_FRAME)    // 2 KiB
volatile unsigned char number;

extern "C" int main() {
  volatile unsigned char frame[2048];
  frame[number] = number;
  number = frame[0];
  return 0;
}
#elif defined(BIG_STATE)          // with the stack more than the 16 KiB of the smallest processor
volatile unsigned char state[14 * 1024];

extern "C" int main() {
  state[0] = 1;
  return 0;
}
#endif
