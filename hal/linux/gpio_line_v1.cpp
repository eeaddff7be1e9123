// libgpiod 1.6 (Debian 12), which speaks the kernel's first line-event interface.

#include <gpiod.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "hal/linux/gpio_line.hpp"
#include "hal/linux/gpio_request.hpp"

namespace zerorate::hal::linux_os {
namespace {

constexpr std::size_t kKernelQueue = 16;  // gpiolib-cdev.c: DECLARE_KFIFO(events, ..., 16)

gpiod_line* find_line(gpiod_chip* chip, const std::string& name) {
  const auto number = line_number(name);
  return number ? gpiod_chip_get_line(chip, *number) : gpiod_chip_find_line(chip, name.c_str());
}

int flags_of(LineBias bias) {
  switch (bias) {
    case LineBias::as_is:
      return 0;
    case LineBias::disabled:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
    case LineBias::pull_up:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    case LineBias::pull_down:
      break;
  }
  return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
}

int request_edges(gpiod_line* line, const LineSettings& settings) {
  const int flags = flags_of(settings.bias);
  switch (settings.edge) {
    case Edge::rising:
      return gpiod_line_request_rising_edge_events_flags(line, "zerorate", flags);
    case Edge::falling:
      return gpiod_line_request_falling_edge_events_flags(line, "zerorate", flags);
    case Edge::both:
      break;
  }
  return gpiod_line_request_both_edges_events_flags(line, "zerorate", flags);
}

}  // namespace

struct GpioLine::Request {
  struct Close {
    void operator()(gpiod_chip* open) const { gpiod_chip_close(open); }  // releases its lines too
  };
  std::unique_ptr<gpiod_chip, Close> chip;
  int descriptor = -1;
};

GpioLine::GpioLine(LineSettings settings) : settings_(std::move(settings)) {}
GpioLine::~GpioLine() = default;

core::Result<void, BusError> GpioLine::open() {
  auto request = std::make_unique<Request>();
  // A node, a name or a label.
  request->chip.reset(gpiod_chip_open_lookup(settings_.chip.c_str()));
  if (!request->chip) return last_line_error();
  gpiod_line* const line = find_line(request->chip.get(), settings_.line);
  if (line == nullptr) return core::Unexpected{BusError::not_present};
  if (request_edges(line, settings_) != 0) return last_line_error();
  request->descriptor = gpiod_line_event_get_fd(line);
  if (!set_non_blocking(request->descriptor)) return last_line_error();
  request_ = std::move(request);
  return {};
}

core::Result<PulseBatch, BusError> GpioLine::read_pulses(std::span<core::Instant> stamps) {
  if (stamps.empty()) return PulseBatch{};
  if (!request_) {
    if (const auto opened = open(); !opened) return core::Unexpected{opened.error()};
  }
  std::array<gpiod_line_event, kKernelQueue> events{};
  const std::size_t wanted = std::min(stamps.size(), events.size());
  const int read = gpiod_line_event_read_fd_multiple(request_->descriptor, events.data(),
                                                     static_cast<unsigned>(wanted));
  if (read < 0) {
    if (errno == EAGAIN) return PulseBatch{};
    const auto error = last_line_error();
    if (error.error() == BusError::not_present) request_.reset();
    return error;
  }
  const auto count = static_cast<std::size_t>(read);
  for (std::size_t i = 0; i < count; ++i) {
    stamps[i] = core::Instant{} + core::Duration::seconds(events[i].ts.tv_sec) +
                core::Duration::nanoseconds(events[i].ts.tv_nsec);
  }
  PulseBatch batch{.count = count, .lost = count == kKernelQueue ? 1U : 0U};
  debounce_.drop_bounces(stamps, batch);
  return batch;
}

int GpioLine::descriptor() const {
  return request_ ? request_->descriptor : -1;
}

}  // namespace zerorate::hal::linux_os
