#include "host_tools/lib/evaluate/schedule.hpp"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <stdexcept>

namespace zerorate::evaluate {
namespace {

template <class Number>
Number parse_number(std::string_view key, std::string_view text) {
  Number number{};
  const auto* const end = text.data() + text.size();
  const auto result = [&] {
    if constexpr (std::is_integral_v<Number>) {
      return std::from_chars(text.data(), end, number);
    } else {
      return fast_float::from_chars(text.data(), end, number);
    }
  }();
  if (text.empty() || result.ec != std::errc{} || result.ptr != end) {
    throw std::invalid_argument(fmt::format(
        "schedule: {} is '{}', expected a number, as in still=60,drive=300,seed=1", key, text));
  }
  return number;
}

double parse_mean_seconds(std::string_view key, std::string_view text) {
  const auto seconds = parse_number<double>(key, text);
  if (!(seconds > 0.0) || !std::isfinite(seconds)) {
    throw std::invalid_argument(
        fmt::format("schedule: {} is '{}', expected a positive mean length in seconds", key, text));
  }
  return seconds;
}

void set(ScheduleParams& params, std::string_view key, std::string_view value) {
  if (key == "still") {
    params.still_s = parse_mean_seconds(key, value);
  } else if (key == "drive") {
    params.drive_s = parse_mean_seconds(key, value);
  } else if (key == "seed") {
    params.seed = parse_number<std::uint64_t>(key, value);
  } else {
    throw std::invalid_argument(
        fmt::format("schedule: unknown key '{}', expected still, drive or seed", key));
  }
}

}  // namespace

ScheduleParams parse_schedule(std::string_view text) {
  ScheduleParams params;
  while (!text.empty()) {
    const auto comma = text.find(',');
    const std::string_view item = text.substr(0, comma);
    text = comma == std::string_view::npos ? std::string_view{} : text.substr(comma + 1);
    const auto equals = item.find('=');
    if (equals == std::string_view::npos) {
      throw std::invalid_argument(fmt::format(
          "schedule: '{}' has no '=', expected still=SECONDS,drive=SECONDS,seed=N", item));
    }
    set(params, item.substr(0, equals), item.substr(equals + 1));
  }
  return params;
}

Schedule::Schedule(const ScheduleParams& params, core::Instant start)
    : params_(params), stream_(params.seed), phase_end_(start) {
  phase_end_ = start + next_length();
}

bool Schedule::is_moving(core::Instant at) {
  while (at >= phase_end_) {
    moving_ = !moving_;
    phase_end_ = phase_end_ + next_length();
  }
  return moving_;
}

core::Duration Schedule::next_length() {
  const double mean_s = moving_ ? params_.drive_s : params_.still_s;
  const double length_s = -mean_s * std::log(stream_.uniform(draws_++));
  return core::Duration::nanoseconds(std::llround(length_s * 1e9));
}

}  // namespace zerorate::evaluate
