// A constant without its F turns a single-precision product into a double one.
volatile float number = 1.0F;

extern "C" int main() {
  number = static_cast<float>(number * 2.5);
  return 0;
}
