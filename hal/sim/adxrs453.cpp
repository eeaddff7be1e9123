#include "hal/sim/adxrs453.hpp"

#include "hal/sim/conversion.hpp"

namespace zerorate::hal::sim {
namespace {

// Written apart from the driver's tables, so that each checks the other.
enum Address : std::uint8_t {
  tem1 = 0x02,
  fault1 = 0x0A,
  fault0 = 0x0B,
  pid1 = 0x0C,
  sn3 = 0x0E,
};

constexpr core::Duration kPowerOnTime = core::Duration::milliseconds(100);
constexpr core::Duration kCheckTime = core::Duration::milliseconds(50);
constexpr std::uint8_t kEveryFault = 0xFE;
constexpr double kLsbPerDps = 80.0;
constexpr double kClipDps = 400.0;

constexpr unsigned kSpiError = 4;
constexpr unsigned kRequestError = 2;
constexpr unsigned kDataUnavailable = 1;

bool is_odd(std::uint32_t bits) {
  bool odd = false;
  for (; bits != 0; bits &= bits - 1) odd = !odd;
  return odd;
}

/// Puts P0 at bit 28 and P1 at bit 0.
std::uint32_t with_parities(std::uint32_t reply) {
  if (!is_odd(reply >> 16U)) reply |= 0x1000'0000;
  if (!is_odd(reply)) reply |= 1U;
  return reply;
}

}  // namespace

void SimulatedAdxrs453::cycle_power() {
  registers_.fill(0);
  registers_[pid1] = 0x52;
  registers_[pid1 + 1] = 0x02;
  registers_[sn3] = 0x12;
  registers_[sn3 + 1] = 0x34;
  registers_[sn3 + 2] = 0x56;
  registers_[sn3 + 3] = 0x78;
  reply_ = 1;
  powered_at_ = clock_->now();
  checks_to_show_ = 0;
}

bool SimulatedAdxrs453::is_powered() const {
  return clock_->now() - powered_at_ >= kPowerOnTime;
}

std::uint32_t SimulatedAdxrs453::exchange_frame(std::uint32_t command) {
  const std::uint32_t reply = reply_;
  reply_ = respond(command);
  return reply;
}

std::uint32_t SimulatedAdxrs453::respond(std::uint32_t command) {
  if (!is_odd(command)) return refuse(kSpiError);
  if ((command & 0x2000'0000U) != 0) return sensor_data(command);
  constexpr std::uint32_t kOperation = 0xFC00'0000;  // and SM, which has to be 0
  if ((command & kOperation) != 0x8000'0000U) return refuse(kRequestError);
  if (!is_powered()) return refuse(kDataUnavailable);
  return read(static_cast<std::uint8_t>((command >> 17U) & 0xFFU));
}

/// The datasheet's start-up sequence: the two replies that follow CHK, each 50 ms after the command
/// before, show every fault; then they are gone.
std::uint8_t SimulatedAdxrs453::faults() {
  if (checks_to_show_ > 0 && clock_->now() - checked_at_ >= kCheckTime) {
    --checks_to_show_;
    checked_at_ = clock_->now();
    return kEveryFault;
  }
  checks_to_show_ = 0;
  return static_cast<std::uint8_t>(registers_[fault0] & kEveryFault);
}

std::uint32_t SimulatedAdxrs453::sensor_data(std::uint32_t command) {
  const std::uint32_t sequence = ((command >> 30U) & 3U) | (((command >> 28U) & 1U) << 2U);
  const std::uint32_t header = sequence << 29U;
  if (!is_powered()) return with_parities(header);  // ST is 00
  const std::uint8_t shown = faults();
  const bool is_check = shown == kEveryFault;
  if ((command & 2U) != 0) {
    checks_to_show_ = 2;
    checked_at_ = clock_->now();
  }
  const double dps =
      in_deg_per_s(rate_) + start_up_transient_dps(clock_->now() - powered_at_, kPowerOnTime);
  const auto counts = to_counts(dps * kLsbPerDps, -kClipDps * kLsbPerDps, kClipDps * kLsbPerDps);
  const std::uint32_t data = static_cast<std::uint32_t>(static_cast<std::uint16_t>(counts)) << 10U;
  std::uint32_t status = shown == 0 ? 1U : 0U;
  if (is_check) status = 2U;
  return with_parities(header | (status << 26U) | data | shown);
}

std::uint32_t SimulatedAdxrs453::read(std::uint8_t address) {
  if (address + 1U >= registers_.size()) return refuse(kRequestError);
  std::uint32_t data =
      (static_cast<unsigned>(registers_.at(address)) << 8U) | registers_.at(address + 1U);
  if (address == tem1) {
    const auto counts =
        to_counts((static_cast<double>(temperature_.degc()) - 45.0) * 5.0, -512, 511);
    data = static_cast<std::uint16_t>(counts * 64);
  }
  if (address == fault1) registers_[fault1] = registers_[fault0] = 0;
  return with_parities(0x4E00'0000U | (data << 5U));
}

std::uint32_t SimulatedAdxrs453::refuse(unsigned reason) {
  if (reason != kDataUnavailable) ++refused_commands_;
  return with_parities(0x0E00'0000U | (reason << 16U));
}

}  // namespace zerorate::hal::sim
