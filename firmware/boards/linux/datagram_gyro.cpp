#include "firmware/boards/linux/datagram_gyro.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>
#include <variant>

#include "firmware/boards/linux/log_words.hpp"
#include "hal/linux/clock.hpp"

namespace zerorate::linux_node {
namespace {

constexpr double kRadPerDeg = 0.017453292519943295;
constexpr core::Duration kOldest = core::Duration::seconds(1);

template <class Integer>
bool take_integer(std::string_view& text, Integer& value) {
  const std::string_view word = take_word(text);
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  return error == std::errc{} && stop == end;
}

bool take_vector(std::string_view& text, std::array<double, 3>& vector) {
  for (double& along : vector) {
    const auto number = decode_number(take_word(text));
    if (!number) return false;
    along = *number;
  }
  return true;
}

}  // namespace

std::optional<SampleMessage> decode_sample(std::string_view text) {
  SampleMessage message;
  text = trimmed(text);
  const bool has_rates = take_integer(text, message.sequence) &&
                         take_integer(text, message.time_ns) && message.time_ns >= 0 &&
                         take_vector(text, message.rate_rad_s);
  if (!has_rates) return std::nullopt;
  if (text.empty()) return message;
  const std::string_view temperature = take_word(text);
  if (temperature != "-") {
    message.temperature_degc = decode_number(temperature);
    if (!message.temperature_degc) return std::nullopt;
  }
  if (text.empty()) return message;
  if (!take_vector(text, message.acceleration_m_s2.emplace()) || !text.empty()) return std::nullopt;
  return message;
}

DatagramGyro::DatagramGyro(const GyroSettings& settings, MessageOrigin origin)
    : settings_(settings),
      messages_(std::move(origin)),
      period_(core::Duration::nanoseconds(std::llround(1e9 / settings.rate_hz))) {}

core::Result<void, drivers::DriverError> DatagramGyro::start(core::Instant now) {
  newest_.reset();
  if (!messages_.open(now)) return drivers::bus_failed(hal::BusError::not_present, 0);
  return {};
}

core::Result<std::size_t, drivers::DriverError> DatagramGyro::read(
    core::Instant /*now*/, std::span<drivers::GyroSample> out) {
  constexpr std::size_t kMostMessages = 64;  // messages of one call; the others wait for the next
  std::size_t count = 0;
  MessageSource::Buffer buffer{};
  for (std::size_t i = 0; i < kMostMessages && count < out.size(); ++i) {
    const auto message = messages_.next(buffer);
    if (!message) return drivers::bus_failed(message.error(), 0);
    if (!*message) break;
    if (const auto sample = take(std::get<std::string_view>(**message))) out[count++] = *sample;
  }
  return count;
}

std::optional<drivers::GyroSample> DatagramGyro::take(std::string_view text) {
  const core::Instant now = hal::linux_os::KernelClock::now();
  const bool is_cut = text.size() == std::tuple_size_v<MessageSource::Buffer>;
  const auto message = is_cut ? std::nullopt : decode_sample(text);
  if (!message) {
    ++counters_.unreadable;
    unreadable_at_ = now;
    return std::nullopt;
  }
  core::Instant time = core::Instant::from_ns(message->time_ns);
  if (message->time_ns == 0) {
    time = newest_ && now <= *newest_ ? *newest_ + core::Duration::nanoseconds(1) : now;
  } else if (time > now || now - time > kOldest) {
    ++counters_.foreign;
    foreign_at_ = now;
    return std::nullopt;
  }
  if (!is_next(*message, time)) return std::nullopt;
  newest_ = time;
  sequence_ = message->sequence;
  return sample_of(*message, time);
}

bool DatagramGyro::is_next(const SampleMessage& message, core::Instant time) {
  if (!newest_) return true;
  // Modulo 2^32; a number that lies behind is one that comes late, or of a sender that began anew.
  const auto ahead = static_cast<std::int32_t>(message.sequence - sequence_);
  const bool is_unstamped_and_behind = message.time_ns == 0 && ahead <= 0;
  if (time <= *newest_ || is_unstamped_and_behind) {
    ++(ahead == 0 ? counters_.doubled : counters_.late);
    return false;
  }
  if (ahead > 1) counters_.lost += static_cast<std::uint32_t>(ahead - 1);
  return true;
}

drivers::GyroSample DatagramGyro::sample_of(const SampleMessage& message,
                                            core::Instant time) const {
  drivers::GyroSample sample{.time = time};
  for (std::size_t axis = 0; axis < message.rate_rad_s.size(); ++axis) {
    const double rate = message.rate_rad_s.at(axis);
    sample.rate.at(axis) = core::rad_per_s(static_cast<float>(rate));
    if (std::abs(rate) >= settings_.full_scale_dps * kRadPerDeg) {
      sample.saturated_axes |= static_cast<std::uint8_t>(1U << axis);
    }
  }
  if (message.temperature_degc) {
    sample.temperature =
        core::Temperature::from_degc(static_cast<float>(*message.temperature_degc));
    sample.has_temperature = true;
  }
  if (!settings_.acceleration_range_g || !message.acceleration_m_s2) return sample;
  sample.has_acceleration = true;
  for (std::size_t axis = 0; axis < sample.acceleration.size(); ++axis) {
    const double along = message.acceleration_m_s2->at(axis);
    sample.acceleration.at(axis) = core::m_per_s2(static_cast<float>(along));
    if (std::abs(along) >= *settings_.acceleration_range_g * double{core::kStandardGravity_m_s2})
      sample.has_acceleration = false;
  }
  return sample;
}

core::AngularRate DatagramGyro::lsb() const {
  constexpr double kCounts = 32768.0;
  return core::rad_per_s(static_cast<float>(settings_.full_scale_dps * kRadPerDeg / kCounts));
}

GyroReason DatagramGyro::reason(drivers::DriverErrorCode code) {
  using Code = drivers::DriverErrorCode;
  GyroReason reason;
  if (code == Code::bus_failed) {
    reason.error_number = messages_.error_number();
    reason.told = fmt::format("{}: {}{}", settings_.device, std::strerror(reason.error_number),
                              cure_of_speed(reason.error_number));
  } else if (code == Code::no_new_samples) {
    const core::Instant since = hal::linux_os::KernelClock::now() - kOldest * 2;
    const bool are_foreign = foreign_at_ && *foreign_at_ > since;
    const bool are_unreadable = unreadable_at_ && *unreadable_at_ > since;
    reason.told = fmt::format("{}: no sample for a second ({})", settings_.device,
                              are_foreign ? "messages come, and their stamps are not of "
                                            "CLOCK_MONOTONIC of this machine"
                              : are_unreadable
                                  ? "messages come that are none: sequence time_ns wx wy wz, then "
                                    "maybe temperature, ax ay az"
                                  : "does its sender run?");
  }
  return reason;
}

}  // namespace zerorate::linux_node
