#include "firmware/boards/linux/node_service.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace zerorate::linux_node {
namespace {

/// A line for the log, without a heap.
template <class... Arguments>
void log_line(Log log, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  std::array<char, 256> line{};
  const auto written =
      fmt::format_to_n(line.data(), line.size(), format, std::forward<Arguments>(arguments)...);
  log({line.data(), std::min(written.size, line.size())});
}

}  // namespace

std::string_view describe(const drivers::DriverError& error, std::span<char, 96> buffer) {
  if (error.code == drivers::DriverErrorCode::frozen) return drivers::name(error.code);
  const bool is_bus = error.code == drivers::DriverErrorCode::bus_failed;
  const auto written = fmt::format_to_n(
      buffer.data(), buffer.size(), "{}{}{}{} at register {:#04x}", drivers::name(error.code),
      is_bus ? " (" : "", is_bus ? hal::name(error.bus) : "", is_bus ? ")" : "", error.reg);
  return {buffer.data(), std::min(written.size, buffer.size())};
}

NodeService::NodeService(const Configuration& configuration, Hardware& hardware,
                         hal::linux_os::FileStorage* storage, const app::Session& session, Log log)
    : configuration_(configuration),
      hardware_(hardware),
      storage_(storage),
      snapshot_(configuration.node, sensor_id(configuration.gyro)),
      session_(session),
      log_(log),
      node_(configuration.node),
      loop_(node_, hardware.gyro(), hardware, hardware, hardware, queue_),
      save_at_(hardware.now()) {
  for (const SinkSettings& settings : configuration.sinks) sinks_.push_back(make_sink(settings));
  if (configuration.state) save_at_ = save_at_ + configuration.state->save_interval;
}

bool NodeService::restore() {
  if (storage_ == nullptr) return false;
  std::array<std::uint8_t, app::Snapshot<Node>::kBytesOfState> bytes{};
  const auto size = storage_->load(bytes);
  if (!size) {
    log_line(log_, "state: {}; starting without", hal::name(size.error()));
    return false;
  }
  const auto restored = snapshot_.restore(node_, std::span{bytes}.first(*size), time_in(session_));
  if (!restored) {
    log_line(log_, "state: {}; starting without", app::name(restored.error()));
    return false;
  }
  log_line(log_, "state: restored, {}", app::name(*restored));
  return true;
}

void NodeService::measure() {
  hardware_.wait();
  loop_.poll();
  turns_.fetch_add(1, std::memory_order_relaxed);
  if (handover_.load(std::memory_order_acquire) == Handover::requested) hand_over();
}

void NodeService::hand_over() {
  offered_status_ = {.counters = loop_.counters(),
                     .is_running = loop_.is_running(),
                     .state = node_.state(),
                     .learnt = learnt()};
  handover_.store(Handover::ready, std::memory_order_release);
}

wire::LearntModel NodeService::learnt() const {
  wire::LearntModel learnt;
  for (std::size_t i = 0; i < learnt.axes.size(); ++i) learnt.axes.at(i) = node_.learnt_noise(i);
  return learnt;
}

void NodeService::publish_waiting() {
  queue_.waiting().clear();
  while (const auto message = queue_.take()) {
    for (const auto& sink : sinks_) sink->publish(*message);
    latest_ = message;
  }
}

bool NodeService::tick() {
  if (handover_.load(std::memory_order_acquire) == Handover::ready) {
    report_changes(offered_status_);
    last_status_ = offered_status_;
    publish_learnt();
    const core::Instant now = hardware_.now();
    if (configuration_.state && now >= save_at_) {
      save_at_ = now + configuration_.state->save_interval;
      save(last_status_.state);
    }
  }
  handover_.store(Handover::requested, std::memory_order_release);
  const std::uint32_t turns = turns_.load(std::memory_order_relaxed);
  const bool is_alive = turns != turns_seen_;
  turns_seen_ = turns;
  return is_alive;
}

void NodeService::finish() {
  publish_waiting();
  hand_over();
  report_changes(offered_status_);
  last_status_ = offered_status_;
  if (configuration_.state) save(last_status_.state);
}

void NodeService::report_changes(const ServiceStatus& now) {
  std::array<char, 96> words{};
  const app::LoopCounters& before = last_status_.counters;
  if (now.counters.starts != before.starts) {
    const GyroSettings& gyro = configuration_.gyro;
    log_line(log_, "gyro: {} on {} started, {} Hz, {} deg/s{}", gyro.chip, gyro.device,
             gyro.rate_hz, gyro.full_scale_dps, before.starts > 0 ? ", again" : "");
  }
  const bool has_failed = now.counters.start_errors != before.start_errors ||
                          now.counters.read_errors != before.read_errors ||
                          now.counters.configurations_lost != before.configurations_lost;
  // A failure that repeats at every attempt is logged once.
  const bool is_news = before.last_error != now.counters.last_error || last_status_.is_running;
  if (has_failed && is_news) {
    log_line(log_, "gyro: {}{}", describe(now.counters.last_error, words),
             now.is_running ? "" : "; trying again");
  }
  const bool odometer_fails = now.counters.odometer_errors != before.odometer_errors;
  if (odometer_fails && !odometer_failed_) {
    log_("odometer: cannot be read; the vehicle counts as moving");
  }
  odometer_failed_ = odometer_fails;
  if (now.counters.pulses_lost != before.pulses_lost) {
    log_line(log_, "odometer: {} pulses lost", now.counters.pulses_lost - before.pulses_lost);
  }
}

/// Each second, moving or not: whoever comes later or lost a datagram knows it a second later.
void NodeService::publish_learnt() {
  if (!last_status_.learnt.is_learnt()) return;
  for (const auto& sink : sinks_) sink->publish_learnt(last_status_.learnt);
}

void NodeService::save(const Node::State& state) {
  if (storage_ == nullptr) return;
  if (const auto saved = storage_->save(snapshot_.of_state(state, time_in(session_))); !saved) {
    ++counters_.save_errors;
    log_line(log_, "state: not saved: {}", hal::name(saved.error()));
    return;
  }
  ++counters_.saves;
}

}  // namespace zerorate::linux_node
