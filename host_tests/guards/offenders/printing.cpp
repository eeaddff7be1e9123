// Prints: nothing in the image offers printf.
#include <cstdio>

volatile int number;

extern "C" int main() {
  std::printf("%d\n", number);
  return 0;
}
