// Links, because it brings its own malloc: only the image's symbols give it away.
#include <cstddef>

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
