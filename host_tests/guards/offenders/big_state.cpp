// 14 KiB of state: together with the stack more than the 16 KiB of the smallest processor.
volatile unsigned char state[14 * 1024];

extern "C" int main() {
  state[0] = 1;
  return 0;
}
