/// @file
/// Interrupts of the RP2040: priorities.
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

}  // namespace zerorate::hal::rp2040
