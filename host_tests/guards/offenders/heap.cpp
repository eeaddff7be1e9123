// Allocates: nothing in the image offers operator new.
int* volatile kept;

extern "C" int main() {
  kept = new int(1);
  return 0;
}
