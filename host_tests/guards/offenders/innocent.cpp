// Single precision and fixed memory: passes every gate.
volatile float number = 1.0F;

extern "C" int main() {
  number = number * 2.0F;
  return 0;
}
