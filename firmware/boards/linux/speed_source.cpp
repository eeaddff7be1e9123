#include "firmware/boards/linux/speed_source.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <limits>
#include <variant>

#include "hal/linux/clock.hpp"

namespace zerorate::linux_node {
namespace {

constexpr std::size_t kMostSpeeds = 16;

}  // namespace

std::optional<double> decode_text(std::string_view text) {
  text = trimmed(text);
  if (text == "still") return 0.0;
  if (text == "moving") return std::numeric_limits<double>::infinity();
  if (text.empty()) return std::nullopt;
  double fastest = 0.0;
  for (std::size_t i = 0; i < kMostSpeeds && !text.empty(); ++i) {
    const auto speed = decode_number(take_word(text));
    if (!speed) return std::nullopt;
    fastest = std::max(fastest, std::abs(*speed));
  }
  if (!text.empty()) return std::nullopt;
  return fastest;
}

bool SpeedSource::hear(const Message& message, core::Instant now) {
  if (const auto* const frame = std::get_if<CanFrame>(&message)) {
    const bool moves = signals_.hear(*frame, now);
    if (signals_.was_refused()) refused_at_ = now;
    return moves;
  }
  const auto* const text = std::get_if<std::string_view>(&message);
  const auto speed = text != nullptr ? decode_text(*text) : std::get<double>(message);
  (speed ? heard_at_ : refused_at_) = now;  // no word of the speed: the timeout decides
  return speed && std::abs(*speed) > dead_band_mps_;
}

bool SpeedSource::is_known(core::Instant now) const {
  return has_signals_ ? signals_.is_known(now, timeout_)
                      : heard_at_ && now - *heard_at_ <= timeout_;
}

int SpeedSource::reason_of_silence(core::Instant now) const {
  if (!signals_.is_valid()) return ENODATA;
  return refused_at_ && now - *refused_at_ <= timeout_ ? EBADMSG : ETIMEDOUT;
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
    if (hear(**message, now)) stamps[batch.count++] = now;
  }
  if (!is_known(now)) return fail(hal::BusError::timeout, reason_of_silence(now));
  return batch;
}

}  // namespace zerorate::linux_node
