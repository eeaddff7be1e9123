/// @file
/// A short drive with an LSM6DSO, in which any call to the hardware may go wrong.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "drivers/common/register_access.hpp"
#include "drivers/lsm6dso/driver.hpp"
#include "firmware/app/node_loop.hpp"
#include "firmware/app/snapshot.hpp"
#include "firmware/model/hypotheses.hpp"
#include "hal/sim/buses.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/lsm6dso.hpp"
#include "hal/sim/odometer.hpp"
#include "hal/sim/storage.hpp"
#include "hal/testing/fault_injector.hpp"
#include "host_tests/system/scenario/play.hpp"
#include "host_tools/lib/simulate/simulate.hpp"
#include "host_tools/lib/simulate/vehicle.hpp"

namespace zerorate::scenario {

/// Learns as the Linux node does; six lags of 1/f noise and a warm-up.
inline constexpr core::ModelShape kFaultyShape{
    .decaying = 7, .has_accelerometer = true, .hypotheses = model::kMostHypotheses};
using FaultyNode = app::GyroNode<kFaultyShape>;
using Random = std::mt19937_64;

[[nodiscard]] inline double uniform(Random& random, double from, double to) {
  return std::uniform_real_distribution<double>{from, to}(random);
}
[[nodiscard]] inline bool happens(Random& random, double probability) {
  return uniform(random, 0.0, 1.0) < probability;
}

/// From a time on, for a while.
struct Episode {
  double from_s = std::numeric_limits<double>::infinity();
  double length_s = 0.0;

  [[nodiscard]] bool is_on(double time_s) const {
    return time_s >= from_s && time_s < from_s + length_s;
  }
};

/// Faults of the calls that are not bus transactions.
struct WireFaults {
  Episode odometer_error;    ///< the call fails
  Episode odometer_bounces;  ///< each pulse comes twenty times within 2 ms
  Episode odometer_dead;     ///< no pulse arrives
  Episode data_ready_dead;   ///< no edge arrives
  Episode storage_error;     ///< nothing can be saved
  double restart_s = std::numeric_limits<double>::infinity();  ///< the program starts anew
};

[[nodiscard]] inline std::string describe(const WireFaults& faults) {
  if (!(faults.odometer_dead.length_s > 0.0)) return {};
  return "; no pulses from " + std::to_string(faults.odometer_dead.from_s) + " s for " +
         std::to_string(faults.odometer_dead.length_s) + " s";
}

/// Faults of the chip and of the machine.
struct ChipFaults {
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  Episode frozen;               ///< axes give the number that they gave before
  unsigned frozen_axes = 0;     ///< a bit for each of them
  Episode half_rate;            ///< each second conversion is missing
  double rounding_dps = 0.0;    ///< step of the numbers, larger than that of the chip
  double power_cut_s = kNever;  ///< the chip is without power, and its bias changes
  double suspend_s = kNever;    ///< the machine sleeps, and its clock stands still
  double slept_s = 0.0;
};

/// One limit of the node is left out (docs/reference/scenarios.md): axes that freeze before their
/// noise was seen at rest. Steps reach 0.3 deg/s, eleven standard deviations of a sample.
[[nodiscard]] inline ChipFaults random_chip_faults(Random& random, double end_s) {
  constexpr double kChipStep_dps = 0.00875;
  constexpr unsigned kMostChipSteps = 35;
  constexpr double kLongestFirstStop_s = 12.0;
  ChipFaults faults;
  const auto draw = [&](Episode& episode, double earliest_s) {
    if (happens(random, 0.9)) return;
    episode = {.from_s = uniform(random, earliest_s, end_s),
               .length_s = uniform(random, 0.1, 20.0)};
  };
  draw(faults.frozen, kLongestFirstStop_s);
  draw(faults.half_rate, 0.0);
  faults.frozen_axes = static_cast<unsigned>(1 + random() % 7);
  if (happens(random, 0.1)) {
    faults.rounding_dps = kChipStep_dps * static_cast<double>(2 + random() % (kMostChipSteps - 1));
  }
  if (happens(random, 0.1)) faults.power_cut_s = uniform(random, 0.0, end_s);
  if (happens(random, 0.1)) {
    faults.suspend_s = uniform(random, 0.0, end_s);
    faults.slept_s = std::exp(uniform(random, 0.0, 10.0));  // up to six hours
    if (happens(random, 0.5)) faults.power_cut_s = faults.suspend_s;
  }
  return faults;
}

[[nodiscard]] inline std::string describe(const ChipFaults& faults) {
  std::string text;
  const auto add = [&](bool is_there, const std::string& words) {
    if (is_there) text += "; " + words;
  };
  const auto seconds = [](double time_s) { return std::to_string(time_s) + " s"; };
  const auto during = [&](const Episode& episode) {
    return " from " + seconds(episode.from_s) + " for " + seconds(episode.length_s);
  };
  add(faults.frozen.length_s > 0.0,
      "axes " + std::to_string(faults.frozen_axes) + " frozen" + during(faults.frozen));
  add(faults.half_rate.length_s > 0.0, "half rate" + during(faults.half_rate));
  add(faults.rounding_dps > 0.0, "rounded to " + std::to_string(faults.rounding_dps) + " deg/s");
  add(faults.power_cut_s < ChipFaults::kNever, "power cut at " + seconds(faults.power_cut_s));
  add(faults.suspend_s < ChipFaults::kNever,
      "asleep at " + seconds(faults.suspend_s) + " for " + seconds(faults.slept_s));
  return text;
}

/// Faults of the accelerometer.
struct ForceFaults {
  Episode absent;      ///< no readings
  Episode frozen;      ///< the reading from before, again and again
  Episode infinite;    ///< no numbers
  double scale = 1.0;  ///< factor of a range that is set otherwise than it is read
};
[[nodiscard]] inline ForceFaults random_force_faults(Random& random, double end_s) {
  ForceFaults faults;
  for (Episode* const episode : {&faults.absent, &faults.frozen, &faults.infinite}) {
    if (happens(random, 0.8)) continue;
    *episode = {.from_s = uniform(random, 0.0, end_s), .length_s = uniform(random, 0.1, 60.0)};
  }
  if (happens(random, 0.1)) faults.scale = happens(random, 0.5) ? 2.0 : 0.5;
  return faults;
}

/// A clock that stands still while the machine sleeps, and says for how long it slept.
class SleepingClock {
 public:
  explicit SleepingClock(const hal::sim::SimulatedClock& clock) : clock_(&clock) {}
  [[nodiscard]] core::Instant now() const { return clock_->now(); }
  [[nodiscard]] core::Duration slept() const { return slept_; }
  void sleep(core::Duration time) { slept_ = slept_ + time; }

 private:
  const hal::sim::SimulatedClock* clock_;
  core::Duration slept_;
};

/// Passes a PulseInput on, or fails.
class FaultyOdometer {
 public:
  void set_broken(bool broken) { broken_ = broken; }
  [[nodiscard]] hal::sim::SimulatedOdometer& wheel() { return wheel_; }
  core::Result<hal::PulseBatch, hal::BusError> read_pulses(std::span<core::Instant> stamps) {
    if (broken_) return core::Unexpected{hal::BusError::io};
    return wheel_.read_pulses(stamps);
  }

 private:
  hal::sim::SimulatedOdometer wheel_;
  bool broken_ = false;
};

/// Passes a DataReady on, or loses its edges.
class FaultyPin {
 public:
  explicit FaultyPin(hal::sim::DataReadyPin& pin) : pin_(&pin) {}
  void set_broken(bool broken) { broken_ = broken; }
  std::optional<core::Instant> take_edge() {
    const auto edge = pin_->take_edge();
    return broken_ ? std::nullopt : edge;
  }

 private:
  hal::sim::DataReadyPin* pin_;
  bool broken_ = false;
};

inline constexpr double kLsm6dsoPeriod_s = 64.0 / 6667.0;

/// Motion and warmth that neither the odometer nor the model of the sensor shows.
struct Unseen {
  std::size_t turns_before = 0;  ///< leg that a steady turn without a pulse precedes; 0: none
  double turn_s = 0.0;
  double turn_dps = 0.0;
  std::array<double, 3> warm_up_dps{};  ///< at power-on; 0: none
  double time_constant_s = 60.0;
};
[[nodiscard]] inline Unseen random_unseen(Random& random) {
  Unseen unseen;
  const auto log_uniform = [&](double from, double to) {
    return std::exp(uniform(random, std::log(from), std::log(to)));
  };
  const auto either_way = [&](double size) { return happens(random, 0.5) ? size : -size; };
  if (happens(random, 0.2)) {
    unseen.turns_before = static_cast<std::size_t>(1 + random() % 4);
    unseen.turn_s = log_uniform(5.0, 60.0);
    unseen.turn_dps = either_way(log_uniform(0.5, 10.0));
  }
  if (happens(random, 0.2)) {
    unseen.time_constant_s = log_uniform(60.0, 1800.0);
    for (double& by_dps : unseen.warm_up_dps) by_dps = either_way(log_uniform(0.1, 2.0));
  }
  return unseen;
}
[[nodiscard]] inline std::string describe(const Unseen& unseen) {
  std::string text;
  if (unseen.turns_before > 0) {
    text += "; turns before leg " + std::to_string(unseen.turns_before) + " for " +
            std::to_string(unseen.turn_s) + " s at " + std::to_string(unseen.turn_dps) + " deg/s";
  }
  if (unseen.warm_up_dps[0] != 0.0) {
    text += "; warms up over " + std::to_string(unseen.time_constant_s) + " s by";
    for (const double by_dps : unseen.warm_up_dps) text += " " + std::to_string(by_dps);
    text += " deg/s";
  }
  return text;
}

/// Three stops and two drives between them, as they really are.
[[nodiscard]] inline std::vector<simulate::ScenarioRow> random_drive(Random& random,
                                                                     const Unseen& unseen) {
  std::vector<simulate::Leg> legs;
  for (std::size_t leg = 0; leg < 5; ++leg) {
    const bool drives = leg % 2 == 1;
    const double turn = uniform(random, 3.0, 20.0) * (happens(random, 0.5) ? 1.0 : -1.0);
    if (unseen.turns_before > 0 && unseen.turns_before == leg) {
      legs.push_back({.length_s = unseen.turn_s, .turn_dps = unseen.turn_dps});
    }
    legs.push_back({.length_s = uniform(random, 5.0, 12.0),
                    .speed_m_s = drives ? uniform(random, 3.0, 15.0) : 0.0,
                    .turn_dps = drives ? turn : 0.0});
  }
  const simulate::VehicleMotion motion = simulate::follow(legs, kLsm6dsoPeriod_s);
  std::vector<simulate::ScenarioRow> rows(motion.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<simulate::Effect> slow{
        simulate::ConstantBias{.bias_rad_s = uniform(random, -1.0, 1.0) * kDps},
        simulate::WarmUpTransient{.amplitude_rad_s = unseen.warm_up_dps[axis] * kDps,
                                  .time_constant_s = unseen.time_constant_s},
        simulate::FlickerNoise{.bias_instability_rad_s =
                                   simulate::kScenarioBiasInstabilityDph / 3600.0 * kDps}};
    const random::RandomStream stream{random()};
    const auto bias = simulate::simulate({motion.size(), kLsm6dsoPeriod_s}, slow, stream);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      rows[k].bias_rad_s[axis] = static_cast<float>(bias.rate_rad_s[k]);
      rows[k].true_rate_rad_s[axis] = static_cast<float>(motion.rate_rad_s[k][axis]);
    }
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    rows[k].row.time_ns = std::llround(static_cast<double>(k + 1) * kLsm6dsoPeriod_s * 1e9);
    rows[k].row.odometer_pulses = motion.odometer_pulses[k];
    rows[k].row.speed_m_s = static_cast<float>(motion.speed_m_s[k]);
  }
  return rows;
}

}  // namespace zerorate::scenario
