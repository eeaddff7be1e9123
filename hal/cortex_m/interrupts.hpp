/// @file
/// Interrupts of every Cortex-M: short locks, and sleep that misses none.
#pragma once

namespace zerorate::hal::cortex_m {

/// Keeps interrupts pending while it lives. Keep it short: an edge that comes meanwhile is stamped
/// late. Nothing in an interrupt may use one.
class InterruptLock {
 public:
  InterruptLock() { asm volatile("cpsid i" ::: "memory"); }
  ~InterruptLock() { asm volatile("cpsie i" ::: "memory"); }
  InterruptLock(const InterruptLock&) = delete;
  InterruptLock& operator=(const InterruptLock&) = delete;
};

/// Sleeps until the next interrupt, unless there is work already. Between the question and the
/// sleep no interrupt can be lost: WFI wakes for a pending one even while they are masked
/// (ARMv6-M Architecture Reference Manual, B1.5.17; ARMv7-M, B1.5.19).
void sleep_unless(auto has_work) {
  const InterruptLock lock;
  if (!has_work()) asm volatile("wfi" ::: "memory");
}

}  // namespace zerorate::hal::cortex_m
