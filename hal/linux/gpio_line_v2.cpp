// libgpiod 2 (Debian 13), which speaks the kernel's second line interface, with sequence numbers.

#include <gpiod.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "hal/linux/gpio_line.hpp"
#include "hal/linux/gpio_request.hpp"

namespace zerorate::hal::linux_os {
namespace {

constexpr std::size_t kBatch = 64;

/// A C object of libgpiod with the function that frees it.
template <class Object, auto Free>
struct Freed {
  void operator()(Object* object) const { Free(object); }
};
using Chip = std::unique_ptr<gpiod_chip, Freed<gpiod_chip, gpiod_chip_close>>;
using Info = std::unique_ptr<gpiod_chip_info, Freed<gpiod_chip_info, gpiod_chip_info_free>>;
using Settings =
    std::unique_ptr<gpiod_line_settings, Freed<gpiod_line_settings, gpiod_line_settings_free>>;
using LineConfig =
    std::unique_ptr<gpiod_line_config, Freed<gpiod_line_config, gpiod_line_config_free>>;
using RequestConfig =
    std::unique_ptr<gpiod_request_config, Freed<gpiod_request_config, gpiod_request_config_free>>;
using Lines =
    std::unique_ptr<gpiod_line_request, Freed<gpiod_line_request, gpiod_line_request_release>>;
using Events = std::unique_ptr<gpiod_edge_event_buffer,
                               Freed<gpiod_edge_event_buffer, gpiod_edge_event_buffer_free>>;

gpiod_line_edge edge_of(Edge edge) {
  switch (edge) {
    case Edge::rising:
      return GPIOD_LINE_EDGE_RISING;
    case Edge::falling:
      return GPIOD_LINE_EDGE_FALLING;
    case Edge::both:
      break;
  }
  return GPIOD_LINE_EDGE_BOTH;
}

/// The line's number on the chip; negative where there is none of that name.
int find_line(gpiod_chip* chip, const std::string& name) {
  const auto number = line_number(name);
  return number ? static_cast<int>(*number)
                : gpiod_chip_get_line_offset_from_name(chip, name.c_str());
}

gpiod_line_bias bias_of(LineBias bias) {
  switch (bias) {
    case LineBias::as_is:
      return GPIOD_LINE_BIAS_AS_IS;
    case LineBias::disabled:
      return GPIOD_LINE_BIAS_DISABLED;
    case LineBias::pull_up:
      return GPIOD_LINE_BIAS_PULL_UP;
    case LineBias::pull_down:
      break;
  }
  return GPIOD_LINE_BIAS_PULL_DOWN;
}

/// Opens a chip by its node, its name or its label; errno says why not.
Chip open_chip(const std::string& wanted) {
  if (wanted.find('/') != std::string::npos) return Chip{gpiod_chip_open(wanted.c_str())};
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", error)) {
    const std::string& node = entry.path().native();
    if (!gpiod_is_gpiochip_device(node.c_str())) continue;
    Chip chip{gpiod_chip_open(node.c_str())};
    const Info info{chip ? gpiod_chip_get_info(chip.get()) : nullptr};
    if (info && (wanted == gpiod_chip_info_get_label(info.get()) ||
                 wanted == gpiod_chip_info_get_name(info.get()))) {
      return chip;
    }
  }
  errno = ENOENT;
  return nullptr;
}

Lines request_edges(gpiod_chip* chip, unsigned offset, const LineSettings& wanted) {
  const Settings settings{gpiod_line_settings_new()};
  const LineConfig lines{gpiod_line_config_new()};
  const RequestConfig request{gpiod_request_config_new()};
  if (!settings || !lines || !request) return nullptr;
  gpiod_request_config_set_consumer(request.get(), "zerorate");
  gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT);
  gpiod_line_settings_set_edge_detection(settings.get(), edge_of(wanted.edge));
  gpiod_line_settings_set_bias(settings.get(), bias_of(wanted.bias));
  gpiod_line_settings_set_event_clock(settings.get(), GPIOD_LINE_CLOCK_MONOTONIC);
  if (gpiod_line_config_add_line_settings(lines.get(), &offset, 1, settings.get()) != 0) return {};
  return Lines{gpiod_chip_request_lines(chip, request.get(), lines.get())};
}

}  // namespace

struct GpioLine::Request {
  Lines lines;
  Events events;
  SequenceGaps gaps{};
};

GpioLine::GpioLine(LineSettings settings) : settings_(std::move(settings)) {}
GpioLine::~GpioLine() = default;

core::Result<void, BusError> GpioLine::open() {
  const Chip chip = open_chip(settings_.chip);
  if (!chip) return last_line_error();
  const int offset = find_line(chip.get(), settings_.line);
  if (offset < 0) return core::Unexpected{BusError::not_present};
  auto request = std::make_unique<Request>(
      Request{.lines = request_edges(chip.get(), static_cast<unsigned>(offset), settings_),
              .events = Events{gpiod_edge_event_buffer_new(kBatch)}});
  if (!request->lines || !request->events) return last_line_error();
  if (!set_non_blocking(gpiod_line_request_get_fd(request->lines.get()))) return last_line_error();
  request_ = std::move(request);
  return {};
}

core::Result<PulseBatch, BusError> GpioLine::read_pulses(std::span<core::Instant> stamps) {
  if (stamps.empty()) return PulseBatch{};
  if (!request_) {
    if (const auto opened = open(); !opened) return core::Unexpected{opened.error()};
  }
  gpiod_edge_event_buffer* const events = request_->events.get();
  const int read = gpiod_line_request_read_edge_events(request_->lines.get(), events,
                                                       std::min(stamps.size(), kBatch));
  if (read < 0) {
    if (errno == EAGAIN) return PulseBatch{};
    const auto error = last_line_error();
    if (error.error() == BusError::not_present) request_.reset();
    return error;
  }
  PulseBatch batch{.count = static_cast<std::size_t>(read)};
  for (std::size_t i = 0; i < batch.count; ++i) {
    gpiod_edge_event* const event = gpiod_edge_event_buffer_get_event(events, i);
    stamps[i] =
        core::Instant::from_ns(static_cast<std::int64_t>(gpiod_edge_event_get_timestamp_ns(event)));
    batch.lost +=
        request_->gaps.take(static_cast<std::uint32_t>(gpiod_edge_event_get_line_seqno(event)));
  }
  debounce_.drop_bounces(stamps, batch);
  return batch;
}

int GpioLine::descriptor() const {
  return request_ ? gpiod_line_request_get_fd(request_->lines.get()) : -1;
}

}  // namespace zerorate::hal::linux_os
