#include "hal/rp2040/flash_chip.hpp"

#include "hal/cortex_m/registers.hpp"
#include "hal/rp2040/registers.hpp"

namespace zerorate::hal::rp2040 {
namespace {

/// Sends a byte and gives what came back meanwhile (datasheet, 4.10.8). One at a time, so that an
/// interrupt in between overflows nothing.
[[gnu::section(".ram_code"), gnu::noinline]] std::uint8_t exchange(std::uint32_t byte) {
  ssi::kData.write(byte);
  while ((ssi::kStatus.read() & ssi::kReceiveNotEmpty) == 0) {
  }
  return static_cast<std::uint8_t>(ssi::kData.read());
}

/// Selects the flash chip while it lives: the SSI would let go of it whenever its FIFO runs empty.
class Selected {
 public:
  [[gnu::always_inline]] Selected() { io_qspi::kChipSelect.write(io_qspi::kOverrideLow); }
  [[gnu::always_inline]] ~Selected() { io_qspi::kChipSelect.write(io_qspi::kOverrideHigh); }
  Selected(const Selected&) = delete;
  Selected& operator=(const Selected&) = delete;
};

/// The SSI may be set up only while it is off.
[[gnu::always_inline]] inline void set_up(std::uint32_t control) {
  while ((ssi::kStatus.read() & ssi::kBusy) != 0) {
  }
  ssi::kEnable.write(0);
  ssi::kControl0.write(control);
  ssi::kEnable.write(1);
}

}  // namespace

[[gnu::section(".ram_code"), gnu::noinline]] void FlashChip::run(
    std::uint8_t command, std::uint32_t offset, std::span<const std::uint8_t> bytes) {
  constexpr auto kEnabled = cortex_m::nvic::kSetEnable<nvic::io_bank0>;
  const std::uint32_t enabled = kEnabled.read();
  cortex_m::nvic::kClearEnable<nvic::io_bank0>.write(~bit(nvic::io_bank0));
  ssi::kSelect.write(1);
  set_up(ssi::kFrames8Bits);
  {
    const Selected chip;
    exchange(kWriteEnable);
  }
  {
    const Selected chip;
    exchange(command);
    for (std::uint32_t shift = 24; shift > 0;) exchange((offset >> (shift -= 8)) & 0xFFU);
    for (const std::uint8_t byte : bytes) exchange(byte);
  }
  constexpr std::uint8_t kInProgress = 0x01;
  for (bool is_busy = true; is_busy;) {
    const Selected chip;
    exchange(kReadStatus);
    is_busy = (exchange(0) & kInProgress) != 0;
  }
  io_qspi::kChipSelect.write(io_qspi::kOverrideNone);
  set_up(ssi::kMapped);
  kEnabled.write(enabled);
}

}  // namespace zerorate::hal::rp2040
