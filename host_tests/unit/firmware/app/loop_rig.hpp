/// @file
/// A node's loop on a simulated chip, with faults.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "firmware/app/node_loop.hpp"
#include "hal/sim/odometer.hpp"
#include "host_tests/support/simulated_gyros.hpp"
#include "host_tests/unit/firmware/app/node_rig.hpp"

namespace zerorate::app::testing {

using core::Duration;

inline constexpr Duration kMillisecond = Duration::milliseconds(1);

/// Keeps what was published in memory that was reserved before.
struct Published {
  Published() { messages.reserve(100'000); }
  void publish(const RateMessage& message) { messages.push_back(message); }
  std::vector<RateMessage> messages;
};

/// An odometer that can fail.
struct FailingOdometer {
  core::Result<hal::PulseBatch, hal::BusError> read_pulses(std::span<core::Instant> stamps) {
    if (fails) return core::Unexpected{hal::BusError::io};
    if (is_endless) return hal::PulseBatch{.count = stamps.size()};
    return working.read_pulses(stamps);
  }
  hal::sim::SimulatedOdometer working;
  bool fails = false;
  bool is_endless = false;  ///< never says that no pulse is left
};

/// The clock of the chip, for a machine that may sleep.
struct SleepingClock {
  [[nodiscard]] core::Instant now() const { return awake->now(); }
  [[nodiscard]] Duration slept() const { return asleep; }
  const hal::sim::SimulatedClock* awake;
  Duration asleep = Duration::seconds(3600);  ///< before the loop begins
};

/// A node's loop on the simulated chip, over SPI, with faults.
struct LoopRig {
  using Chip = support::GyroRig<support::OverSpi<support::Lsm6dso>>;
  using Loop = NodeLoop<Node, decltype(Chip::driver), FailingOdometer, hal::sim::DataReadyPin,
                        SleepingClock, Published>;

  explicit LoopRig(drivers::lsm6dso::Settings settings = {}) : hardware(settings) {}

  /// The chip measures with its noise, the loop polls.
  void sample(float rate_rad_s = 0.01F) {
    support::Rates rates{core::rad_per_s(rate_rad_s), core::rad_per_s(-rate_rad_s), {}};
    for (std::size_t i = 0; i < rates.size(); ++i) {
      const random::RandomStream noise{1, i};
      rates.at(i) = stuck.at(i).value_or(
          rates.at(i) + core::rad_per_s(sigma_rad_s * static_cast<float>(noise.normal(measured))));
    }
    ++measured;
    hardware.sample(rates);
    loop.poll();
  }
  void samples(int count, float rate_rad_s = 0.01F) {
    for (int i = 0; i < count; ++i) sample(rate_rad_s);
  }
  /// Polls every millisecond, without samples.
  void wait(Duration time) {
    for (Duration waited; waited < time; waited = waited + kMillisecond) {
      hardware.clock.advance(kMillisecond);
      loop.poll();
    }
  }
  /// Starts, and lets the start-up time of the chip pass.
  void start() {
    wait(Duration::milliseconds(3));
    samples(20, 0.0F);
    published.messages.clear();
  }
  /// The bus fails from the next transaction on.
  void break_bus(std::size_t transactions) {
    hardware.faults.inject({.first = hardware.faults.calls(), .calls = transactions});
  }
  [[nodiscard]] const LoopCounters& counters() const { return loop.counters(); }

  Chip hardware;
  std::array<std::optional<core::AngularRate>, 3> stuck{};  ///< axes that no longer measure
  float sigma_rad_s = kWhiteSigmaRadS;
  std::int64_t measured = 0;
  FailingOdometer odometer;
  Published published;
  Node::Params params = node_params();
  Node node{params};
  SleepingClock clock{&hardware.clock};
  Loop loop{node, hardware.driver, odometer, hardware.chip.interrupt(), clock, published};
};

}  // namespace zerorate::app::testing
