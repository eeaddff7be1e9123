/// @file
/// The loop around the node: the only place that owns time, retries and counts.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/time.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/gyro_source.hpp"
#include "firmware/app/chatter_watch.hpp"
#include "firmware/app/gyro_node.hpp"
#include "firmware/app/message_inputs.hpp"
#include "firmware/app/rate_message.hpp"
#include "firmware/app/rate_watch.hpp"
#include "firmware/app/sample_watch.hpp"
#include "firmware/app/temperature_watch.hpp"
#include "hal/contract/data_ready.hpp"
#include "hal/contract/monotonic_clock.hpp"
#include "hal/contract/pulse_input.hpp"

namespace zerorate::app {

/// Events since the start; every fault is counted, none is hidden. Counters wrap.
struct LoopCounters {
  std::uint32_t samples = 0;  ///< given to the node; not those of a frozen axis
  std::uint32_t pulses = 0;
  std::uint32_t pulses_lost = 0;
  std::uint32_t odometer_errors = 0;
  std::uint32_t foreign_stamps = 0;  ///< edges stamped by another clock, such as the wall clock
  std::uint32_t starts = 0;          ///< successful starts of the gyro
  std::uint32_t start_errors = 0;    ///< failed ones, without those that asked for more time
  std::uint32_t read_errors = 0;
  std::uint32_t overruns = 0;  ///< read errors that were samples lost in the chip
  std::uint32_t configurations_lost = 0;
  std::uint32_t sleeps = 0;    ///< times that the machine slept
  std::uint32_t silences = 0;  ///< messages that had to say that there are no samples
  drivers::DriverError last_error{};

  constexpr bool operator==(const LoopCounters&) const = default;
};

/// Binds a node to its hardware. Call poll() from the main loop, at least once a sample
/// (data-ready) or once a FIFO period; it never blocks longer than its bus transactions.
/// @tparam Batch samples and pulses that are taken at once; smaller saves stack, 48 bytes each
template <class Node, drivers::GyroSource Gyro, hal::PulseInput Odometer, hal::DataReady Ready,
          hal::MonotonicClock Clock, RateSink Sink, std::size_t Batch = 16>
class NodeLoop {
 public:
  /// All of them must outlive the loop.
  /// @param ready stamps the newest sample, unless the gyro is batched
  constexpr NodeLoop(Node& node, Gyro& gyro, Odometer& odometer, Ready& ready, Clock& clock,
                     Sink& sink)
      : node_(node),
        gyro_(gyro),
        odometer_(odometer),
        ready_(ready),
        clock_(clock),
        sink_(sink),
        watch_(node.params().model.white_variance_rad2_s2, node.params().model.sample_period) {
    if constexpr (requires { clock.slept(); }) slept_ = clock.slept();
  }

  [[nodiscard]] constexpr const LoopCounters& counters() const { return counters_; }
  [[nodiscard]] constexpr bool is_running() const { return running_; }
  /// Samples a second over the newest seconds, and whether that is another rate than the gyro's.
  [[nodiscard]] constexpr const RateWatch& sample_rate() const { return sample_rate_; }

  constexpr void poll() {
    const core::Instant now = clock_.now();
    // Before the pulses, so that no pulse is missing that is older than the sample.
    std::optional<core::Instant> edge = ready_.take_edge();
    if (edge) edge = own_stamp(*edge, now);
    take_sleep(now);
    take_pulses(now);
    polled_at_ = now;
    if (running_) {
      run(now, edge);
    } else if (now >= retry_at_) {
      if (has_run_) look_for_lost_power(now);
      if (!has_run_ && now >= retry_at_) start(now);
    }
    report_silence(now);
  }

 private:
  static constexpr std::size_t kMostBatches =
      64;  ///< most batches of one poll; more than any FIFO holds
  /// No chip asks for so much time; one that does will ask for ever.
  static constexpr core::Duration kLongestStart = core::Duration::seconds(2);
  static constexpr core::Duration kFirstRetry = core::Duration::milliseconds(10);
  static constexpr core::Duration kLongestRetry = core::Duration::seconds(1);
  static constexpr core::Duration kLongestSilence = core::Duration::milliseconds(250);
  /// The two clocks are not read at one instant.
  static constexpr core::Duration kShortestSleep = core::Duration::milliseconds(100);
  static constexpr core::Duration kFarStamp = core::Duration::seconds(1);
  static constexpr core::Duration kLongestWithoutData = core::Duration::seconds(1);

  constexpr void run(core::Instant now, std::optional<core::Instant> edge) {
    if (edge || now >= next_edge_by_) take_samples(now, edge);
    if (running_) watch_for_samples(now);
    if (running_ && now >= verify_at_) verify(now);
  }

  constexpr void take_pulses(core::Instant now) {
    std::array<core::Instant, Batch> stamps{};
    for (std::size_t i = 0; i < kMostBatches; ++i) {
      const auto batch = odometer_.read_pulses(stamps);
      if (!batch) break;
      for (std::size_t k = 0; k < batch->count; ++k) take_pulse(stamps[k], now);
      counters_.pulses += static_cast<std::uint32_t>(batch->count);
      if (batch->count > 0) driven_at_ = now;
      if (batch->lost > 0) {
        counters_.pulses_lost += batch->lost;
        node_.report_odometer_fault(now);
      }
      if (batch->count < Batch) return;
    }
    // An error, or a source without an end. Nobody knows what was missed: the vehicle counts as
    // moving.
    ++counters_.odometer_errors;
    node_.report_odometer_fault(now);
  }

  constexpr void take_pulse(core::Instant stamp, core::Instant now) {
    const core::Instant own = own_stamp(stamp, now);
    if (own != stamp) node_.report_odometer_fault(now);
    node_.pulse(own);
    chatter_.pulse();
  }
  /// Edges come between two polls. A stamp far from there is of another clock: kernels before
  /// Linux 5.7 take the wall clock. The time of the poll stands for it.
  constexpr core::Instant own_stamp(core::Instant stamp, core::Instant now) {
    const core::Instant oldest = polled_at_.value_or(stamp) - kFarStamp;
    if (stamp >= oldest && stamp <= now + kFarStamp) return stamp;
    ++counters_.foreign_stamps;
    return now;
  }

  constexpr void take_samples(core::Instant now, std::optional<core::Instant> edge) {
    // A pin that works will tell of the next sample too; read before it did, the sample would carry
    // the time of this loop. If no edge comes, the samples are looked for without.
    const bool is_stamped = edge && !gyro_.is_batched();
    const core::Duration period = gyro_.sample_period();
    if (is_stamped) next_edge_by_ = *edge + period * 2;
    const core::Instant stamp = is_stamped ? *edge : now;
    std::array<core::GyroSample, Batch> samples{};
    for (std::size_t batch = 0; batch < kMostBatches; ++batch) {
      const auto count = gyro_.read(stamp, samples);
      if (!count) return fail_to_read(count.error(), now);
      if (*count > 0) sampled_at_ = now;
      sample_rate_.take(now, static_cast<std::uint32_t>(*count), period);
      if (const auto frozen = take(std::span{samples}.first(*count), now); frozen != 0) {
        return fail_to_read({.code = drivers::DriverErrorCode::frozen, .reg = frozen}, now);
      }
      if (*count < Batch) return;
    }
  }

  /// Gives the samples to the node, but for those of an axis that no longer measures.
  /// @return axes that are at fault with the newest sample, one bit each
  constexpr std::uint8_t take(std::span<drivers::GyroSample> samples, core::Instant now) {
    std::uint8_t frozen = 0;
    for (drivers::GyroSample& sample : samples) {
      frozen = watch_before(node_, watch_, sample, driven_at_, now);
      if (frozen != 0) continue;
      temperature_watch_.take(sample);
      RateMessage message = node_.step(sample);
      if constexpr (drivers::MeasuresAcceleration<Gyro>) {
        if (sample.has_acceleration) message.acceleration = sample.acceleration;
      }
      describe_inputs(node_.ticks(), message);
      message.health.sample_rate_off = sample_rate_.is_off();
      chatter_.take(
          sample, message.health.calibrated,
          [&](std::size_t axis) { return message.axes[axis].bias.in(core::rad_per_s); },
          [&](std::size_t axis) { return node_.white_variance_rad2_s2(axis); });
      message.health.odometer_disagreement |= chatter_.chatters();
      publish(message, now);
      ++counters_.samples;
      retry_after_ = kFirstRetry;
    }
    return frozen;
  }

  /// A gyro that answers without measuring is started again, with its reset.
  constexpr void watch_for_samples(core::Instant now) {
    const core::Duration longest = std::max(kLongestWithoutData, gyro_.sample_period() * 4);
    if (now - sampled_at_ <= longest) return;
    ++counters_.read_errors;
    fail({.code = drivers::DriverErrorCode::no_new_samples}, now);
  }

  constexpr void fail_to_read(drivers::DriverError error, core::Instant now) {
    ++counters_.read_errors;
    if (error.code == drivers::DriverErrorCode::fifo_overrun) {
      ++counters_.overruns;  // the chip goes on by itself
      sampled_at_ = now;
      counters_.last_error = error;
    } else {
      fail(error, now);
    }
  }

  /// A clock that stands still while the machine sleeps says how long it slept.
  constexpr void take_sleep(core::Instant now) {
    if constexpr (requires { clock_.slept(); }) {
      const core::Duration slept = clock_.slept();
      if (slept - slept_ < kShortestSleep) return;
      ++counters_.sleeps;
      node_.report_pause(now, slept - slept_, false);
      slept_ = slept;
      if (running_) look_for_lost_power(now);
    }
  }

  /// Verifies all of the configuration at once, before a start sets it anew: a chip that lost it
  /// was without power, and comes back with another bias. While the chip does not answer, that
  /// is unknown.
  constexpr void look_for_lost_power(core::Instant now) {
    constexpr int kMostEntries = 16;  // rate of any driver
    for (int i = 0; i < kMostEntries; ++i) {
      const auto verified = gyro_.verify_next();
      if (verified) continue;
      if (verified.error().code == drivers::DriverErrorCode::bus_failed) {
        ++counters_.start_errors;
        return fail(verified.error(), now);
      }
      if (verified.error().code == drivers::DriverErrorCode::configuration_lost) lose_power(now);
      break;
    }
    has_run_ = false;
    running_ = false;
  }
  constexpr void lose_power(core::Instant now) {
    ++counters_.configurations_lost;
    node_.report_pause(now, {}, true);
  }

  /// Once a sample period, whether samples come or not: a chip that lost its power is silent.
  constexpr void verify(core::Instant now) {
    verify_at_ = now + gyro_.sample_period();
    if (const auto verified = gyro_.verify_next(); !verified) {
      if (verified.error().code == drivers::DriverErrorCode::configuration_lost) {
        lose_power(now);
        has_run_ = false;
      } else {
        ++counters_.read_errors;
      }
      fail(verified.error(), now);
    }
  }

  /// Adds the pulses to the message and publishes it.
  constexpr void publish(RateMessage& message, core::Instant now) {
    if (node_.params().standstill.source != core::StandstillSource::gyro) {
      message.odometer_pulses = counters_.pulses + counters_.pulses_lost;
    }
    sink_.publish(message);
    published_at_ = now;
  }

  /// A receiver must not have to guess from silence: without samples it is told so, again and
  /// again.
  constexpr void report_silence(core::Instant now) {
    if (!published_at_) published_at_ = now;  // the clock's first reading
    if (now - *published_at_ < std::max(kLongestSilence, gyro_.sample_period() * 4)) return;
    ++counters_.silences;
    publish_silence(now);
  }
  /// Not inlined: poll() does not keep room for its message while the node computes.
  [[gnu::noinline]] constexpr void publish_silence(core::Instant now) {
    RateMessage message = node_.step_without_sample(now);
    publish(message, now);
  }

  constexpr void start(core::Instant now) {
    const auto started = gyro_.start(now);
    if (started) {
      ++counters_.starts;
      running_ = true;
      has_run_ = true;
      starting_since_.reset();
      watch_.set_step(gyro_.lsb());
      sample_rate_.restart();
      sampled_at_ = now + core::Duration::milliseconds(500);  // settling of the slowest chip
      return;
    }
    if (!starting_since_) starting_since_ = now;
    const bool is_getting_ready = started.error().code == drivers::DriverErrorCode::not_ready &&
                                  now - *starting_since_ < kLongestStart;
    if (is_getting_ready) return;
    starting_since_.reset();
    ++counters_.start_errors;
    fail(started.error(), now);
  }

  /// Starts the gyro again after a pause that doubles from failure to failure, until a sample is
  /// published.
  constexpr void fail(drivers::DriverError error, core::Instant now) {
    counters_.last_error = error;
    running_ = false;
    retry_at_ = now + retry_after_;
    retry_after_ = std::min(retry_after_ * 2, kLongestRetry);
  }

  Node& node_;
  Gyro& gyro_;
  Odometer& odometer_;
  Ready& ready_;
  Clock& clock_;
  Sink& sink_;
  LoopCounters counters_;
  SampleWatch<> watch_;
  RateWatch sample_rate_;
  TemperatureWatch temperature_watch_;
  ChatterWatch chatter_;
  bool running_ = false;
  bool has_run_ = false;  ///< since its newest start; a lost configuration shows lost power
  core::Duration slept_;  ///< pauses that the node was told of
  std::optional<core::Instant> polled_at_;
  std::optional<core::Instant> driven_at_;  ///< newest poll with pulses
  std::optional<core::Instant> published_at_;
  std::optional<core::Instant> starting_since_;  ///< a start that asked for more time
  core::Instant sampled_at_;                     ///< newest reading that had samples
  core::Instant next_edge_by_;
  core::Instant verify_at_;
  core::Instant retry_at_;
  core::Duration retry_after_ = kFirstRetry;
};

}  // namespace zerorate::app
