// Throws: nothing in the image offers __cxa_throw.
volatile int number;

extern "C" int main() {
  if (number > 0) throw 1;
  return 0;
}
