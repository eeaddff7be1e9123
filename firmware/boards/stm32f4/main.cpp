// The node on an STM32F405 with an LSM6DSO on SPI 1. Built, gated, and booted in QEMU, which has no
// such chip on its bus; never run on silicon.
//
// PA4-PA7 select, clock, in, out; PB0 data-ready, PB1 odometer, PA2 messages
// (docs/how-to/port-to-a-board.md).

#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"
#include "drivers/chips/chips.hpp"
#include "drivers/common/register_access.hpp"
#include "firmware/app/node_loop.hpp"
#include "firmware/app/snapshot.hpp"
#include "firmware/boards/common/console.hpp"
#include "firmware/boards/common/state_keeper.hpp"
#include "firmware/boards/pico/model.hpp"  // of the same gyro
#include "hal/cortex_m/flash_storage.hpp"
#include "hal/cortex_m/interrupts.hpp"
#include "hal/stm32f4/chip.hpp"
#include "hal/stm32f4/spi_device.hpp"
#include "hal/stm32f4/timer.hpp"
#include "hal/stm32f4/uart.hpp"

namespace zerorate::stm32f4 {
namespace {

using namespace hal::stm32f4;
using hal::cortex_m::enable_interrupt;
using hal::cortex_m::Priority;

using Chip = drivers::lsm6dso::Chip;
using Gyro = Chip::Driver<drivers::SpiRegisters<Spi1Device>>;
using Node =
    app::GyroNode<exported::kModelShape, app::NodeCapacity{.held_ticks = 8,
                                                           .runs_moving_average = false,
                                                           .runs_calibration_mean = false}>;
static_assert(Node::check(exported::kNodeParams).has_value());

using Line = Usart2<256>;
using Pulses = EdgeQueue<32>;
using Loop = app::NodeLoop<Node, Gyro, Pulses, LatestEdge, TimerClock, boards::Console<Line>, 2>;
using Memory = hal::cortex_m::FlashStorage<BackupRam, 0, 1>;
static_assert(app::Snapshot<Node>::kBytesOfFilters <= Memory::kLargestRecord);
constexpr app::Snapshot<Node> kSnapshot{exported::kNodeParams, app::sensor_id(Chip::kName)};

using DataReadyPin = EdgePin<1, 0>;
using OdometerPin = EdgePin<1, 1>;
constexpr std::uint32_t kBaud = 115'200;
constexpr core::Duration kReportEvery = core::Duration::seconds(1);

// Variables that interrupts share with the main loop, each written by one of them.
// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
constinit Line line;
constinit Pulses pulses;
constinit LatestEdge data_ready;
constinit Beat<10'000> beat;
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

void start_hardware() {
  const Clocks clocks = start_clocks();
  Timer2::start(clocks.timer_hz);
  decltype(beat)::start();
  Spi1Device::start(clocks.apb2_hz, Chip::kHighestSpi_hz);
  Line::start(clocks.apb1_hz, kBaud);
  BackupRam::start();
  DataReadyPin::start(Pull::down);
  OdometerPin::start(Pull::up);  // an open-drain sensor works too
  // One priority for the clock and the edges that it stamps: none preempts another.
  enable_interrupt<nvic::timer_2>(Priority::high);
  enable_interrupt<nvic::exti0>(Priority::high);
  enable_interrupt<nvic::exti1>(Priority::high);
  enable_interrupt<nvic::usart_2>(Priority::low);
  Watchdog::start();
}

bool has_work() {
  return beat.is_due() || data_ready.has_edge() || !pulses.is_empty();
}

[[noreturn]] void run() {
  static TimerClock clock;
  static Spi1Device spi;
  static Gyro gyro{drivers::SpiRegisters{spi}};
  static Node node{exported::kNodeParams};
  static Memory memory;
  static boards::StateKeeper keeper{kSnapshot, memory};
  static boards::Console console{line};
  static Loop loop{node, gyro, pulses, data_ready, clock, console};
  keeper.restore(node);
  core::Instant report_at = clock.now() + kReportEvery;
  for (;;) {
    Watchdog::feed();
    if (const auto key = Line::receive()) console.handle_key(*key);
    beat.take();
    loop.poll();
    const core::Instant now = clock.now();
    (void)keeper.poll(node, now);
    if (now >= report_at) {
      report_at = report_at + kReportEvery;
      console.report(loop.counters());
    }
    hal::cortex_m::sleep_unless(has_work);
  }
}

}  // namespace
}  // namespace zerorate::stm32f4

extern "C" {

void handle_exti0() {
  using namespace zerorate::stm32f4;
  const std::uint64_t now = TimerClock::microseconds();
  DataReadyPin::take_interrupt();
  data_ready.on_edge(now);
}

void handle_exti1() {
  using namespace zerorate::stm32f4;
  const std::uint64_t now = TimerClock::microseconds();
  OdometerPin::take_interrupt();
  pulses.on_edge(now);
}

void handle_timer_2() {
  zerorate::stm32f4::Timer2::on_interrupt();
  zerorate::stm32f4::beat.on_interrupt();
}

void handle_usart_2() {
  zerorate::stm32f4::line.on_interrupt();
}

int main() {
  zerorate::stm32f4::start_hardware();
  zerorate::stm32f4::run();
}
}
