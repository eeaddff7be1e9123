// The node's template (firmware/boards/template) on a board of QEMU: CMakeLists.txt fills in the
// holes with calls of the functions in namespace qemu. A played LSM6DSO is on the bus, and it and
// the odometer play a stop, a drive and a stop. emulated_processor.py knows what must come out.

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "drivers/lsm6dso/registers.hpp"
#include "hal/contract/bus_error.hpp"
#include "hal/contract/bus_operation.hpp"
#include "hal/contract/storage.hpp"
#include "hal/cortex_m/interrupts.hpp"
#include "hal/cortex_m/registers.hpp"
#include "hal/mps2/semihosting.hpp"
#include "host_tests/emulated/mps2/print.hpp"

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables): firmware's state is static
namespace zerorate::qemu {

using hal::cortex_m::Register;
namespace systick = hal::cortex_m::systick;

/// SysTick counts 25 MHz and interrupts twice a sample of 6667/64 Hz.
constexpr std::uint32_t kPeriods = 119'994;
constexpr std::uint32_t kPeriodsOfMicrosecond = 25;
inline std::atomic<std::uint32_t> interrupts{0};

inline std::uint64_t microseconds() {
  for (;;) {
    const std::uint32_t before = interrupts;
    const std::uint32_t elapsed = (kPeriods - systick::kCurrent.read()) % kPeriods;
    if (interrupts == before) {
      return (std::uint64_t{before} * kPeriods + elapsed) / kPeriodsOfMicrosecond;
    }
  }
}

// A stop of 30 s, a drive of 20 s that turns at 10 deg/s, a stop of 20 s, in samples.
constexpr std::uint32_t kDriveBegins = 3125;
constexpr std::uint32_t kDriveEnds = 5208;
constexpr std::uint32_t kEnd = 7292;
constexpr std::uint32_t kSamplesOfPulse = 10;
constexpr std::array<int, 3> kBias{100, -40, 20};  // counts of 8.75 mdps
constexpr int kTurn = 1143;

[[nodiscard]] constexpr bool drives(std::uint32_t sample) {
  return sample >= kDriveBegins && sample < kDriveEnds;
}

/// The registers of the chip; it has left reset as soon as it is told to reset.
class PlayedGyro {
 public:
  void next_sample(std::uint32_t sample) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int turn = axis == 2 && drives(sample) ? kTurn : 0;
      const auto word = static_cast<std::uint16_t>(kBias[axis] + turn + noise());
      bytes_[kOutputs + 2 * axis] = static_cast<std::uint8_t>(word & 0xFFU);
      bytes_[kOutputs + 2 * axis + 1] = static_cast<std::uint8_t>(word >> 8U);
    }
    bytes_[kStatus] = drivers::lsm6dso::bits::kStatusGda;
  }
  void read(std::size_t first, std::span<std::uint8_t> out) {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = bytes_[(first + i) % bytes_.size()];
    if (first + out.size() > kOutputs && first <= kOutputs) bytes_[kStatus] = 0;
  }
  void write(std::size_t address, std::uint8_t value) {
    namespace chip = drivers::lsm6dso;
    if (address == chip::kCtrl3C.address)
      value &= static_cast<std::uint8_t>(~chip::bits::kCtrl3CSwReset);
    bytes_[address] = value;
  }

 private:
  static constexpr std::size_t kStatus = drivers::lsm6dso::kStatusReg.address;
  static constexpr std::size_t kOutputs = drivers::lsm6dso::kOutTempL.address + 2;

  static constexpr std::array<std::uint8_t, 128> after_reset() {
    namespace chip = drivers::lsm6dso;
    std::array<std::uint8_t, 128> bytes{};
    bytes[chip::kWhoAmI.address] = chip::kWhoAmI.reset;
    bytes[chip::kCtrl3C.address] = chip::kCtrl3C.reset;
    bytes[chip::kCtrl9Xl.address] = chip::kCtrl9Xl.reset;
    return bytes;
  }
  /// The sum of five numbers from -2 to 2: a standard deviation of 3.2, as the data sheet has it.
  int noise() {
    int sum = 0;
    for (int i = 0; i < 5; ++i) {
      random_ = random_ * 1'664'525U + 1'013'904'223U;
      sum += static_cast<int>(((random_ >> 16U) * 5U) >> 16U) - 2;
    }
    return sum;
  }

  std::array<std::uint8_t, 128> bytes_ = after_reset();
  std::uint32_t random_ = 1;
};
inline constinit PlayedGyro gyro;

inline core::Result<void, hal::BusError> transaction(std::span<const hal::Operation> operations) {
  constexpr unsigned kRead = 0x80;
  const hal::cortex_m::InterruptLock lock;  // a chip does not change while it is read
  const std::span<const std::uint8_t> sent = operations[0].bytes();
  if (operations.size() > 1) {  // the address, and room for what stands there
    gyro.read(sent[0] & ~kRead, operations.back().buffer());
  } else {
    gyro.write(sent[0], sent[1]);
  }
  return {};
}

/// Arm's CMSDK UART, which in QEMU is never full.
inline constexpr Register<0x4000'4000> kUartData;
inline constexpr Register<0x4000'4008> kUartControl;
inline constexpr Register<0x4000'4010> kUartDivider;

inline bool send(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) kUartData.write(byte);
  return true;
}

inline std::uint32_t saves = 0;
inline core::Result<std::size_t, hal::StorageError> load(std::span<std::uint8_t> /*record*/) {
  return core::Unexpected{hal::StorageError::empty};
}
inline core::Result<void, hal::StorageError> save(std::span<const std::uint8_t> /*record*/) {
  ++saves;
  return {};
}

inline void start() {
  kUartDivider.write(16);
  kUartControl.write(1);
  systick::kReload.write(kPeriods - 1);
  systick::kCurrent.write(0);
  systick::kControl.write(systick::kEnable | systick::kInterrupt | systick::kProcessorClock);
}

}  // namespace zerorate::qemu

// NOLINTNEXTLINE(bugprone-suspicious-include): as it is, and as every board compiles it
#include "firmware/boards/template/main.cpp"

extern "C" void handle_systick() {
  using namespace zerorate;
  const std::uint32_t interrupt = qemu::interrupts + 1;
  qemu::interrupts = interrupt;  // nobody else writes it
  const std::uint32_t sample = interrupt / 2;
  const std::uint64_t now = qemu::microseconds();
  if (interrupt % 2 == 0) {
    qemu::gyro.next_sample(sample);
    board::data_ready.on_edge(now);
  } else if (qemu::drives(sample) && sample % qemu::kSamplesOfPulse == 0) {
    board::pulses.on_edge(now);
  }
  if (sample == qemu::kEnd) {
    emulated::write_line("saves", qemu::saves);
    hal::mps2::Semihosting::exit(0);
  }
}
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)
