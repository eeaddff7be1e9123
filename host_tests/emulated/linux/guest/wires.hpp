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

/// Transactions come one after the other: each is answered, or not at all, before the next.
class Wires {
 public:
  Wires() = default;
  Wires(const Wires&) = delete;
  Wires& operator=(const Wires&) = delete;
  virtual ~Wires() = default;

  /// Waits for a zerorate_bus_transaction and the bytes behind it.
  /// @return false: it was too late for this one
  virtual bool next(std::span<std::uint8_t> transaction) = 0;
  /// A zerorate_bus_answer and the bytes behind it.
  virtual void answer(std::span<const std::uint8_t> answer) = 0;
  virtual void drive(int line, bool high) = 0;
};

/// Through the modules in kernel/.
class KernelWires final : public Wires {
 public:
  bool next(std::span<std::uint8_t> transaction) override {
    return read(bus_, transaction.data(), transaction.size()) >= 0;
  }
  void answer(std::span<const std::uint8_t> answer) override {
    (void)!write(bus_, answer.data(), answer.size());
  }
  void drive(int line, bool high) override {
    const std::string text = std::to_string(line) + (high ? " 1" : " 0");
    if (write(lines_, text.data(), text.size()) < 0) give_up("zerorate_lines");
  }

 private:
  int bus_ = open_device("/dev/zerorate_bus", O_RDWR);
  int lines_ = open_device("/dev/zerorate_lines", O_WRONLY);
};

}  // namespace zerorate::emulated
