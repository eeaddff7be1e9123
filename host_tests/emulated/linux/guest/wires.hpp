/// @file
/// How the played devices reach the programs of the emulated machine.
#pragma once

#include <fcntl.h>
#include <sys/types.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>

#include "host_tests/emulated/linux/kernel/zerorate_bus.h"

namespace zerorate::emulated {

[[noreturn]] inline void give_up(const char* what) {
  std::perror(what);
  std::exit(2);
}

inline int open_device(const char* path, int flags) {
  const int descriptor = open(path, flags);
  if (descriptor < 0) give_up(path);
  return descriptor;
}

/// The modules in kernel/. Transactions come one after the other: each is answered, or not at all,
/// before the next.
class Wires {
 public:
  /// Waits for a zerorate_bus_transaction and the bytes behind it.
  /// @return false: it was too late for this one
  bool next(std::span<std::uint8_t> transaction) {
    return read(bus_, transaction.data(), transaction.size()) >= 0;
  }
  /// Sends a zerorate_bus_answer and the bytes behind it.
  void answer(std::span<const std::uint8_t> answer) {
    (void)!write(bus_, answer.data(), answer.size());
  }
  void drive(int line, bool high) {
    const std::string text = std::to_string(line) + (high ? " 1" : " 0");
    if (write(lines_, text.data(), text.size()) < 0) give_up("zerorate_lines");
  }

 private:
  int bus_ = open_device("/dev/zerorate_bus", O_RDWR);
  int lines_ = open_device("/dev/zerorate_lines", O_WRONLY);
};

}  // namespace zerorate::emulated
