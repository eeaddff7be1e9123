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
  const auto fail = [&](hal::BusError error, int error_number) {
    error_number_ = error_number;
    return core::Unexpected{error};
  };
  if (!messages_.open(now)) return fail(hal::BusError::not_present, messages_.error_number());
  hal::PulseBatch batch{};
  MessageSource::Buffer buffer{};
  for (std::size_t i = 0; i < kMostMessages && batch.count < stamps.size(); ++i) {
    const auto message = messages_.next(buffer);
    if (!message) return fail(message.error(), messages_.error_number());
    if (!*message) break;
    const auto speed = speed_in(**message);
    if (!speed) continue;  // no word of the speed: the timeout decides
    heard_at_ = now;
    if (std::abs(*speed) > dead_band_mps_) stamps[batch.count++] = now;
  }
  const bool is_silent = !heard_at_ || now - *heard_at_ > timeout_;
  if (is_silent) return fail(hal::BusError::timeout, ETIMEDOUT);
  return batch;
}

}  // namespace zerorate::linux_node
