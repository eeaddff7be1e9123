#include "firmware/boards/linux/speed_source.hpp"

#include <cerrno>
#include <cmath>
#include <cstddef>
#include <limits>
#include <variant>

#include "hal/linux/clock.hpp"

namespace zerorate::linux_node {
namespace {

std::optional<double> speed_in(const Message& message) {
  if (const auto* const value = std::get_if<double>(&message)) return *value;
  return decode_text(std::get<std::string_view>(message));
}

}  // namespace

std::optional<double> decode_text(std::string_view text) {
  text = trimmed(text);
  if (text == "still") return 0.0;
  if (text == "moving") return std::numeric_limits<double>::infinity();
  return decode_number(text);
}

core::Result<hal::PulseBatch, hal::BusError> SpeedSource::read_pulses(
    std::span<core::Instant> stamps) {
  constexpr std::size_t kMostMessages = 64;  // messages of one call; the others wait for the next
  const core::Instant now = hal::linux_os::KernelClock::now();
  is_silent_ = false;
  if (!messages_.open(now)) return core::Unexpected{hal::BusError::not_present};
  hal::PulseBatch batch{};
  MessageSource::Buffer buffer{};
  for (std::size_t i = 0; i < kMostMessages && batch.count < stamps.size(); ++i) {
    const auto message = messages_.next(buffer);
    if (!message) return core::Unexpected{message.error()};
    if (!*message) break;
    const auto speed = speed_in(**message);
    if (!speed) continue;  // no word of the speed: the timeout decides
    heard_at_ = now;
    if (std::abs(*speed) > dead_band_mps_) stamps[batch.count++] = now;
  }
  is_silent_ = !heard_at_ || now - *heard_at_ > timeout_;
  if (is_silent_) return core::Unexpected{hal::BusError::timeout};
  return batch;
}

int SpeedSource::error_number() const {
  return is_silent_ ? ETIMEDOUT : messages_.error_number();
}

}  // namespace zerorate::linux_node
