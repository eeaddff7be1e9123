// One frame of 2 KiB, more than the ceiling.
volatile unsigned char number;

extern "C" int main() {
  volatile unsigned char frame[2048];
  frame[number] = number;
  number = frame[0];
  return 0;
}
