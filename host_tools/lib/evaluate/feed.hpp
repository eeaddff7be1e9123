/// @file
/// The two ways by which a replayed sample reaches the node.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "firmware/app/gyro_node.hpp"
#include "firmware/app/message_inputs.hpp"
#include "firmware/app/node_loop.hpp"
#include "firmware/app/sample_watch.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/odometer.hpp"
#include "host_tools/lib/evaluate/simulated_gyro.hpp"

namespace zerorate::evaluate {

/// Hands samples and pulses to the node as they are, but for samples of an axis that no longer
/// measures: then the gyro counts as silent, as in firmware.
template <class Node>
class DirectFeed {
 public:
  /// @param axis_count axes that are measured, the first of a sample
  DirectFeed(Node& node, std::size_t axis_count)
      : node_(node),
        measured_axes_((1U << axis_count) - 1U),
        watch_(node.params().model.white_variance_rad2_s2, node.params().model.sample_period) {}

  app::RateMessage feed(const core::GyroSample& sample, std::span<const core::Instant> pulses) {
    for (const core::Instant pulse : pulses) node_.pulse(pulse);
    if (!pulses.empty()) driven_at_ = pulses.back();
    const bool is_frozen =
        node_.can_take(sample) &&
        (app::watch_before(node_, watch_, sample, driven_at_, sample.time, measured_axes_) != 0 ||
         is_dead_so_far(sample));
    if (is_frozen && is_dead_) node_.discard_stop(sample.time);
    app::RateMessage message =
        is_frozen ? node_.step_without_sample(sample.time) : node_.step(sample);
    if (sample.has_acceleration && !is_frozen) message.acceleration = sample.acceleration;
    app::describe_inputs(node_.ticks(), message);
    return message;
  }
  [[nodiscard]] app::LoopCounters counters() const { return {}; }

 private:
  /// True from the first second on while all samples are equal. No driver gives the size of a step
  /// here, and until a sample differs nothing shows it: SampleWatch cannot judge.
  bool is_dead_so_far(const core::GyroSample& sample) {
    if (!first_) first_ = sample;
    is_dead_ = is_dead_ && sample.rate == first_->rate;
    return is_dead_ && sample.time - first_->time > core::Duration::seconds(1);
  }

  Node& node_;
  unsigned measured_axes_;  ///< one bit each
  app::SampleWatch<> watch_;
  std::optional<core::Instant> driven_at_;
  std::optional<core::GyroSample> first_;
  bool is_dead_ = true;  ///< no sample has differed from the first
};

/// Sends them through a simulated chip, the SPI bus, the driver and the node's loop.
template <class Node>
class ChipFeed {
 public:
  /// Powers the chip on so long before the first sample that its start-up is over by then.
  /// @param has_data_ready false: the wire of its pin is broken
  /// @param has_acceleration whether samples have one, for the chip's accelerometer where it has
  /// one
  ChipFeed(Node& node, const SimulatedChip& chip, core::Instant first_sample, bool has_data_ready,
           bool has_acceleration)
      : clock_(first_sample - kStartUp),
        gyro_(chip.make(clock_, has_acceleration && chip.has_accelerometer)),
        loop_(node, *gyro_, odometer_, has_data_ready ? gyro_->interrupt() : loose_wire_, clock_,
              sink_) {
    // No further than that: a chip that measures whenever it is read would give samples of nothing.
    while (!loop_.is_running() && clock_.now() + kPoll < first_sample) {
      clock_.advance(kPoll);
      loop_.poll();
    }
  }

  app::RateMessage feed(const core::GyroSample& sample, std::span<const core::Instant> pulses) {
    clock_.advance_to(sample.time);
    for (const core::Instant pulse : pulses) odometer_.pulse(pulse);
    gyro_->measure(sample);
    sink_.message.reset();
    loop_.poll();
    // A sample that the driver dropped (a fault, a restart) leaves its time without a rate.
    return sink_.message.value_or(
        app::RateMessage{.time = sample.time, .health = {.sample_refused = true}});
  }
  [[nodiscard]] app::LoopCounters counters() const { return loop_.counters(); }

 private:
  /// More than the slowest chip needs, 656 ms of the ADIS16475, and less than the second without
  /// samples after which the loop starts a chip again.
  static constexpr core::Duration kStartUp = core::Duration::milliseconds(800);
  static constexpr core::Duration kPoll = core::Duration::milliseconds(1);

  struct LatestMessage {
    std::optional<app::RateMessage> message;
    void publish(const app::RateMessage& published) { message = published; }
  };

  hal::sim::SimulatedClock clock_;
  std::unique_ptr<SimulatedGyro> gyro_;
  hal::sim::SimulatedOdometer odometer_;
  hal::sim::DataReadyPin loose_wire_;
  LatestMessage sink_;
  app::NodeLoop<Node, SimulatedGyro, hal::sim::SimulatedOdometer, hal::sim::DataReadyPin,
                hal::sim::SimulatedClock, LatestMessage>
      loop_;
};

}  // namespace zerorate::evaluate
