// The node on a Raspberry Pi Pico: chip, board and application, bound together.

#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"
#include "firmware/app/node_loop.hpp"
#include "firmware/boards/common/console.hpp"
#include "firmware/boards/common/state_keeper.hpp"
#include "firmware/boards/pico/gyro.hpp"
#include "firmware/boards/pico/node.hpp"
#include "hal/cortex_m/flash_storage.hpp"
#include "hal/cortex_m/interrupts.hpp"
#include "hal/rp2040/chip.hpp"
#include "hal/rp2040/flash_chip.hpp"
#include "hal/rp2040/timer.hpp"
#include "hal/rp2040/uart.hpp"

namespace zerorate::pico {
namespace {

using namespace hal::rp2040;
using boards::Console;
using boards::StateKeeper;
using hal::cortex_m::enable_interrupt;
using hal::cortex_m::FlashStorage;
using hal::cortex_m::Priority;
using hal::cortex_m::sleep_unless;

constexpr core::Duration kReportEvery = core::Duration::seconds(1);

using Line = Uart0<kUartTransmit, kUartReceive, 256>;
using Pulses = EdgeQueue<32>;
using Loop = app::NodeLoop<Node, Gyro, Pulses, LatestEdge, TimerClock, Console<Line>, 2>;

/// The last two sectors of the 2 MiB: a new image leaves them as they are.
using Memory = FlashStorage<FlashChip, 0x1F'E000, (exported::kModelShape.hypotheses > 1) ? 1 : 4>;
static_assert(app::Snapshot<Node>::kBytesOfFilters <= Memory::kLargestRecord);
constexpr app::Snapshot<Node> kSnapshot{kNodeParams, kSensor};

// Variables that interrupts share with the main loop, each written by one of them.
// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
constinit Line line;
constinit Pulses pulses;
constinit LatestEdge data_ready;
constinit Beat<kBeat_us> beat;
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

void start_hardware() {
  start_clocks();
  release_from_reset(resets::kIoBank0 | resets::kPadsBank0 | resets::kTimer);
  Line::start(kBaud);
  start_bus();
  EdgePin<kOdometer>::start(Pull::up);  // an open-drain sensor works too
  EdgePin<kDataReady>::start(Pull::down);
  decltype(beat)::start();
  // Edges first: their stamps are what the node lives on.
  enable_interrupt<nvic::io_bank0>(Priority::highest);
  enable_interrupt<nvic::timer_0>(Priority::low);
  enable_interrupt<nvic::uart0>(Priority::low);
  Watchdog<2'000'000>::start();
}

bool has_work() {
  return beat.is_due() || data_ready.has_edge() || !pulses.is_empty();
}

[[noreturn]] void run() {
  static TimerClock clock;
  static Bus bus;
  static Gyro gyro{wire_on(bus), kGyroSettings};
  static Node node{kNodeParams};
  static Memory memory;
  static StateKeeper keeper{kSnapshot, memory};
  static Console console{line};
  static Loop loop{node, gyro, pulses, data_ready, clock, console};
  keeper.restore(node);
  core::Instant report_at = clock.now() + kReportEvery;
  for (;;) {
    Watchdog<2'000'000>::feed();
    if (const auto key = Line::receive()) console.handle_key(*key);
    beat.take();
    loop.poll();
    const core::Instant now = clock.now();
    if (keeper.poll(node, now)) {
      // The newest sample is younger than the edge of the first one that was not fetched.
      (void)data_ready.take_edge();
    }
    if (now >= report_at) {
      report_at = report_at + kReportEvery;
      console.report(loop.counters());
    }
    sleep_unless(has_work);
  }
}

}  // namespace
}  // namespace zerorate::pico

extern "C" {

void handle_timer_0() {
  zerorate::pico::beat.on_interrupt();
}

/// In RAM with all that it calls: it runs while the flash is erased or programmed.
[[gnu::section(".ram_code"), gnu::flatten]] void handle_io_bank0() {
  using namespace zerorate::pico;
  const std::uint64_t now = TimerClock::microseconds();
  if (EdgePin<kDataReady>::take_interrupt()) data_ready.on_edge(now);
  if (EdgePin<kOdometer>::take_interrupt()) pulses.on_edge(now);
}

void handle_uart0() {
  zerorate::pico::line.on_interrupt();
}

int main() {
  zerorate::pico::start_hardware();
  zerorate::pico::run();
}
}
