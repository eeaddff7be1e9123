#include "firmware/boards/linux/node_service.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <string>
#include <system_error>

#include "firmware/model/sensor_model.hpp"

namespace zerorate::linux_node {
namespace {

/// A receiver that is only slow: counted, not reported.
bool is_congestion(int error_number) {
  return error_number == EAGAIN || error_number == ENOBUFS;
}

}  // namespace

app::Session read_boot_id(const char* file) {
  app::Session boot{};
  errno = 0;  // a file that is too short sets none
  std::ifstream stream{file};
  if (!stream.read(boot.data(), boot.size())) {
    throw std::system_error(errno != 0 ? errno : EIO, std::generic_category(), file);
  }
  return boot;
}

app::SnapshotTime time_in(const app::Session& session) {
  return {.session = session, .utc_s = std::time(nullptr)};
}

std::uint32_t sensor_id(const GyroSettings& gyro) {
  return app::sensor_id(gyro.chip + '\n' + gyro.device + '\n' + std::to_string(gyro.address));
}

NodeService::NodeService(const Configuration& configuration, Hardware& hardware,
                         hal::linux_os::FileStorage* storage, const app::Session& session, Log log)
    : configuration_(configuration),
      hardware_(hardware),
      storage_(storage),
      snapshot_(configuration.node, sensor_id(configuration.gyro)),
      session_(session),
      log_(std::move(log)),
      odometer_name_(name_of_odometer(configuration)),
      reference_name_(configuration.reference ? name_of(configuration.reference->origin) : ""),
      node_(configuration.node),
      loop_(node_, hardware.gyro(), hardware, hardware, hardware, queue_),
      save_at_(hardware.now()) {
  for (const SinkSettings& settings : configuration.sinks) {
    add_sink(make_sink(settings, configuration.name));
  }
  if (configuration.state) save_at_ = save_at_ + configuration.state->save_interval;
}

void NodeService::add_sink(std::unique_ptr<Sink> sink) {
  sinks_.push_back(std::move(sink));
  sink_reports_.emplace_back();
}

bool NodeService::restore() {
  if (storage_ == nullptr) return false;
  std::array<std::uint8_t, app::Snapshot<Node>::kBytesOfState> bytes{};
  const auto size = storage_->load(bytes);
  if (!size) {
    log_line(log_, "state: {}; starting without", hal::name(size.error()));
    return false;
  }
  return restore(std::span{bytes}.first(*size));
}

bool NodeService::restore(std::span<const std::uint8_t> record) {
  const auto restored = snapshot_.restore(node_, record, time_in(session_));
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
  take_references();
  turns_.fetch_add(1, std::memory_order_relaxed);
  if (handover_.load(std::memory_order_acquire) == Handover::requested) hand_over();
}

/// A reference is taken with the first sample that is not older.
void NodeService::take_references() {
  constexpr int kMost = 16;  // references of one turn of the loop; the others wait for the next
  for (int i = 0; i < kMost; ++i) {
    if (!waiting_reference_) waiting_reference_ = hardware_.next_reference();
    if (!waiting_reference_ || time_of(*waiting_reference_) > node_.newest_sample()) return;
    const auto verdict =
        std::visit([&](const auto& reference) { return node_.take_reference(reference); },
                   *waiting_reference_);
    waiting_reference_.reset();
    using Verdict = core::ReferenceVerdict;
    references_.learnt += verdict == Verdict::learnt ? 1U : 0U;
    references_.refused += verdict == Verdict::refused ? 1U : 0U;
    const bool is_unusable = verdict == Verdict::no_bias || verdict == Verdict::bad_time;
    references_.unusable += is_unusable ? 1U : 0U;
  }
}

void NodeService::hand_over() {
  offered_status_ = {.counters = loop_.counters(),
                     .is_running = loop_.is_running(),
                     .sample_rate = loop_.sample_rate(),
                     .state = node_.state(),
                     .learnt = learnt(),
                     .samples = hardware_.sample_counters(),
                     .references = references_,
                     .heading = node_.heading(),
                     .reference_error_number = hardware_.reference_error_number()};
  const app::LoopCounters& counters = offered_status_.counters;
  const std::uint32_t failures = counters.read_errors + counters.configurations_lost;
  if (!loop_.is_running() || counters.odometer_errors != 0 || failures != asked_failures_)
    reasons_ = hardware_.reasons(counters.last_error.code);
  asked_failures_ = failures;
  // Kept, because a status that was not read yet may be written over, as at the end.
  offered_status_.reasons = reasons_;
  handover_.store(Handover::ready, std::memory_order_release);
}

wire::LearntModel NodeService::learnt() const {
  wire::LearntModel learnt;
  for (std::size_t i = 0; i < learnt.axes.size(); ++i)
    learnt.axes.at(i) = node_.predictors().learnt_noise(i);
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
  report_gyro(now);
  report_samples(now);
  report_sample_rate(now);
  report_odometer(now);
  report_references(now);
  report_sinks();
}

/// A start is told when samples follow it, a fault once until then: a gyro that is started again
/// and again has two lines in the log.
void NodeService::report_gyro(const ServiceStatus& now) {
  const app::LoopCounters& before = last_status_.counters;
  const GyroSettings& gyro = configuration_.gyro;
  const bool has_samples = now.counters.samples != before.samples;
  const bool has_started = now.counters.starts != told_starts_;
  if (has_started && has_samples && now.is_running) {
    log_line(log_, "gyro: {}{}{} started, {} Hz, {} deg/s{}", gyro.chip,
             gyro.is_simulated() || gyro.chip.empty() ? "" : " on ", gyro.device, gyro.rate_hz,
             gyro.full_scale_dps, told_starts_ > 0 ? ", again" : "");
    if (told_starts_ == 0 && !configuration_.states_scale_factor) {
      log_line(log_, "model: no tolerance of the scale factor; the turn is published with {:g} %",
               100.0 * model::ScaleFactor{}.sigma);
    }
    told_starts_ = now.counters.starts;
    told_fault_.reset();
  }
  const bool has_failed = now.counters.start_errors != before.start_errors ||
                          now.counters.read_errors != before.read_errors ||
                          now.counters.configurations_lost != before.configurations_lost;
  if (!has_failed) return;
  const GyroReason& reason = now.reasons.gyro;
  const ToldFault fault{now.counters.last_error, reason.error_number, reason.told};
  if (told_fault_ == fault) return;
  told_fault_ = fault;
  LogBuffer words{};
  log_line(log_, "gyro: {}{}", describe(gyro, now.counters.last_error, reason, words),
           now.is_running ? "" : "; trying again");
}

/// Each kind is told when it happens first; the metrics count them.
void NodeService::report_samples(const ServiceStatus& now) {
  const SampleCounters& before = last_status_.samples;
  const auto tell = [&](std::uint32_t SampleCounters::*counter, const char* words) {
    if (before.*counter != 0 || now.samples.*counter == 0) return;
    log_line(log_, "gyro: {}: {} (the metrics count them)", configuration_.gyro.device, words);
  };
  tell(&SampleCounters::lost, "samples are lost on the way, by their numbers");
  tell(&SampleCounters::late, "samples come late and are left out");
  tell(&SampleCounters::doubled, "samples come twice and count once");
  tell(&SampleCounters::unreadable, "messages come that are no samples");
  tell(&SampleCounters::foreign, "stamps come that are not of CLOCK_MONOTONIC of this machine");
}

void NodeService::report_sample_rate(const ServiceStatus& now) {
  if (now.counters.sleeps != last_status_.counters.sleeps) {
    log_("the machine slept: the bias is aged by that time, and the gyro started again");
  }
  if (now.sample_rate.is_off() == last_status_.sample_rate.is_off()) return;
  if (now.sample_rate.is_off()) {
    log_line(log_,
             "gyro: {:.1f} samples a second instead of {} (does another program read the chip, or "
             "is the data-ready edge the wrong one?)",
             now.sample_rate.samples_per_second(), configuration_.gyro.rate_hz);
  } else {
    log_line(log_, "gyro: {:.1f} samples a second again", now.sample_rate.samples_per_second());
  }
}

void NodeService::report_odometer(const ServiceStatus& now) {
  const app::LoopCounters& before = last_status_.counters;
  const bool fails = now.counters.odometer_errors != before.odometer_errors;
  const int reason = now.reasons.odometer_error_number;
  const bool is_news =
      fails && (!odometer_failed_ || reason != last_status_.reasons.odometer_error_number);
  if (is_news && reason != 0) {
    log_line(log_, "{}: {}{}; the vehicle counts as moving", odometer_name_, std::strerror(reason),
             configuration_.speed ? cure_of_speed(reason) : cure_of_line(reason));
  } else if (is_news) {
    log_("odometer: cannot be read; the vehicle counts as moving");
  }
  odometer_failed_ = fails;
  if (before.foreign_stamps == 0 && now.counters.foreign_stamps > 0) {
    log_(
        "edges of a GPIO line are not stamped by the monotonic clock (a kernel before Linux 5.7?); "
        "the time of the reading is taken");
  }
  if (now.counters.pulses_lost != before.pulses_lost) {
    log_line(log_, "odometer: {} pulses lost", now.counters.pulses_lost - before.pulses_lost);
  }
}

/// Nothing that lasts is told twice.
void NodeService::report_references(const ServiceStatus& now) {
  const int error = now.reference_error_number;
  if (error != last_status_.reference_error_number && error != 0) {
    log_line(log_, "reference {}: {}{}", reference_name_, std::strerror(error),
             cure_of_speed(error));
  }
  const ReferenceCounters& before = last_status_.references;
  if (before.learnt == 0 && now.references.learnt > 0) {
    log_line(log_, "reference {}: agrees with the gyro, which learns from it", reference_name_);
  }
  if (before.refused == 0 && now.references.refused > 0) {
    log_line(log_,
             "reference {}: refused, too far from the turn of the gyro (does it jump or come late, "
             "or is sense or up another one?)",
             reference_name_);
  }
}

/// A receiver that is slow for a moment is counted, and told where a second brought it nothing.
void NodeService::report_sinks() {
  for (std::size_t i = 0; i < sinks_.size(); ++i) {
    SinkReport& told = sink_reports_[i];
    const Sink& sink = *sinks_[i];
    const bool takes_some = sink.sent() != told.sent;
    told.sent = sink.sent();
    const int error = sink.error_number();
    if (error == told.error_number || (is_congestion(error) && takes_some)) continue;
    told.error_number = error;
    if (error == 0) {
      log_line(log_, "sink {}: takes messages again", sink.name());
    } else {
      log_line(log_, "sink {}: {}{}; its messages are dropped", sink.name(), std::strerror(error),
               cure_of_sink(sink.name(), error));
    }
  }
}

/// Each second, moving or not: whoever comes later or lost a datagram knows it a second later.
void NodeService::publish_learnt() {
  if (!last_status_.learnt.is_learnt()) return;
  for (const auto& sink : sinks_) sink->publish_learnt(last_status_.learnt);
}

std::vector<std::uint8_t> NodeService::record() const {
  const auto record = snapshot_.of_state(last_status_.state, time_in(session_));
  return {record.begin(), record.end()};
}

/// A failure that lasts is told once.
void NodeService::save(const Node::State& state) {
  if (storage_ == nullptr) return;
  const std::string& file = configuration_.state->file;
  if (const auto saved = storage_->save(snapshot_.of_state(state, time_in(session_))); !saved) {
    ++counters_.save_errors;
    const int error = storage_->error_number() != 0 ? storage_->error_number() : EIO;
    if (error != told_save_error_) {
      log_line(log_, "state: not saved in {}: {} ({})", file, hal::name(saved.error()),
               std::strerror(error));
    }
    told_save_error_ = error;
    return;
  }
  if (told_save_error_ != 0) log_line(log_, "state: saved again in {}", file);
  told_save_error_ = 0;
  ++counters_.saves;
}

}  // namespace zerorate::linux_node
