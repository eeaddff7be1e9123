// From the vector table to main(): RM0090, 12.1 (interrupt numbers).

#include "hal/cortex_m/startup.hpp"
#include "hal/cortex_m/registers.hpp"
#include "hal/stm32f4/registers.hpp"

using namespace zerorate::hal;
using namespace zerorate::hal::stm32f4::nvic;

extern "C" {
void handle_exti0();
void handle_exti1();
void handle_timer_2();
void handle_usart_2();

[[noreturn]] void start() {
  cortex_m::scb::kCoprocessorAccess.write(cortex_m::scb::kFloatingPoint);
  asm volatile("dsb\n isb" ::: "memory");
  cortex_m::prepare_memory();
  main();
  fault();
}
}

namespace {

constexpr auto make_vectors() {
  auto table = cortex_m::reset_vectors<usart_2 + 1>(start);
  table.interrupts[exti0] = handle_exti0;
  table.interrupts[exti1] = handle_exti1;
  table.interrupts[timer_2] = handle_timer_2;
  table.interrupts[usart_2] = handle_usart_2;
  return table;
}

}  // namespace

extern "C" [[gnu::section(".vectors"), gnu::used]] const constinit auto vectors = make_vectors();
