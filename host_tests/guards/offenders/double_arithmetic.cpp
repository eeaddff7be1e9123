// Openly double, so no promotion to warn of: libgcc's software routines are in the image.
volatile double number = 1.0;

extern "C" int main() {
  number = number * number;
  return 0;
}
