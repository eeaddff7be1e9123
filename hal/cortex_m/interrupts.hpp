/// @file
/// Interrupts of every Cortex-M: priorities, short locks, and sleep that misses none.
#pragma once

#include <cstdint>

#include "hal/cortex_m/registers.hpp"

namespace zerorate::hal::cortex_m {

/// An interrupt preempts those of lower priority. These four exist on every Cortex-M; the M0+ has
/// no more.
enum class Priority : std::uint32_t { highest = 0x00, high = 0x40, low = 0x80, lowest = 0xC0 };

/// @tparam Number of the interrupt, as the chip's manual counts them
template <unsigned Number>
void enable_interrupt(Priority priority) {
  constexpr unsigned kShift = 8 * (Number % 4);
  const std::uint32_t others = nvic::kPriority<Number>.read() & ~(0xFFU << kShift);
  nvic::kPriority<Number>.write(others | (static_cast<std::uint32_t>(priority) << kShift));
  nvic::kSetEnable<Number>.write(bit(Number % 32));
}

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
