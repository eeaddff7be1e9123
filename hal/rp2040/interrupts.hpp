/// @file
/// Interrupts of the Cortex-M0+: priorities, short locks, and sleep that misses none.
#pragma once

#include <cstdint>

#include "hal/rp2040/registers.hpp"

namespace zerorate::hal::rp2040 {

/// The Cortex-M0+ has four; an interrupt preempts those of lower priority.
enum class Priority : std::uint32_t { highest = 0x00, high = 0x40, low = 0x80, lowest = 0xC0 };

template <nvic::Interrupt Number>
void enable_interrupt(Priority priority) {
  constexpr unsigned kShift = 8 * (Number % 4);
  const std::uint32_t others = nvic::kPriority<Number>.read() & ~(0xFFU << kShift);
  nvic::kPriority<Number>.write(others | (static_cast<std::uint32_t>(priority) << kShift));
  nvic::kSetEnable.write(bit(Number));
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
/// (ARMv6-M Architecture Reference Manual, B1.5.17).
void sleep_unless(auto has_work) {
  const InterruptLock lock;
  if (!has_work()) asm volatile("wfi" ::: "memory");
}

}  // namespace zerorate::hal::rp2040
