// A recording, plain or packed: rows in the order of time, or an error that names file and mend.

#include <sys/mman.h>
#include <unistd.h>

#include <string>
#include <system_error>

#include "host_tests/fuzz/fuzz.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace {

using namespace zerorate;

/// A file that lives in memory only; one a process, with other content for each input.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(::memfd_create("fuzzed", 0)) {
    if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "memfd_create");
  }
  void fill(const std::uint8_t* data, std::size_t size) const {
    const auto wanted = static_cast<ssize_t>(size);
    if (::ftruncate(descriptor_, 0) != 0 || ::pwrite(descriptor_, data, size, 0) != wanted) {
      throw std::system_error(errno, std::generic_category(), "the file in memory");
    }
  }
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const MemoryFile file;
  file.fill(data, size);
  try {
    recording::Reader reader(file.path());
    recording::Row row;
    std::uint64_t line = 0;
    while (reader.next(row)) {
      fuzz::promise(reader.line() > line, "every row is of a later line");
      line = reader.line();
    }
  } catch (const recording::Error& error) {
    fuzz::promise(error.place().file == file.path() && !error.mend().empty(),
                  "an error names the file and how to mend it");
  }
  return 0;
}
