#include "firmware/boards/linux/simulated_vehicle.hpp"

#include <poll.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <numbers>

#include "drivers/lsm6dso/chip.hpp"
#include "firmware/boards/linux/linux_hardware.hpp"
#include "hal/linux/clock.hpp"

namespace zerorate::linux_node {
namespace {

using drivers::lsm6dso::Chip;

constexpr core::Duration kPulsePeriod = core::Duration::milliseconds(100);

auto code_of(double value, const auto& choices) {
  return std::ranges::find_if(choices, [&](auto& choice) { return choice.value == value; })->code;
}

drivers::lsm6dso::Settings settings_of(const GyroSettings& wanted) {
  return Chip::settings(code_of(wanted.rate_hz, Chip::kRates),
                        code_of(wanted.full_scale_dps, Chip::kFullScales), false);
}

}  // namespace

SimulatedMotion motion_at(core::Duration time) {
  constexpr std::int64_t kRest_ns = 20'000'000'000;
  constexpr std::int64_t kCycle_ns = 60'000'000'000;
  constexpr float kBend_s = 10.0F;
  constexpr float kTurn_dps = 10.0F;
  const std::int64_t into_cycle_ns = time.ns() % kCycle_ns;
  if (into_cycle_ns < kRest_ns) return {};
  const float driven_s = static_cast<float>(into_cycle_ns - kRest_ns) * 1e-9F;
  const float phase = 2.0F * std::numbers::pi_v<float> * driven_s / kBend_s;
  return {.turn = core::deg_per_s(kTurn_dps * std::sin(phase)), .is_moving = true};
}

core::Temperature temperature_at(core::Duration time) {
  constexpr float kCold_degc = 25.0F;
  constexpr float kRise_k = 4.0F;
  constexpr float kTimeConstant_s = 300.0F;
  return core::Temperature::from_degc(
      kCold_degc + kRise_k * (1.0F - std::exp(-time.in_seconds() / kTimeConstant_s)));
}

SimulatedVehicle::SimulatedVehicle(const Configuration& configuration)
    : time_factor_(configuration.gyro.time_factor),
      drives_(configuration.gyro.drives),
      clock_(hal::linux_os::KernelClock::now()),
      begin_(clock_.now()),
      next_sample_(begin_),
      next_pulse_(begin_),
      gyro_(make_gyro(configuration.gyro)),
      noise_(0.0F, std::sqrt(configuration.node.model.white_variance_rad2_s2)),
      bias_rad_s_{core::deg_per_s(0.35F).in(core::rad_per_s),
                  core::deg_per_s(-0.2F).in(core::rad_per_s),
                  core::deg_per_s(0.12F).in(core::rad_per_s)} {
  if (configuration.speed) speed_.emplace(*configuration.speed);
  if (configuration.reference) references_.emplace(*configuration.reference);
}

std::unique_ptr<drivers::AnyGyro> SimulatedVehicle::make_gyro(const GyroSettings& wanted) {
  using Registers = drivers::SpiRegisters<Spi>;
  const auto erased = [&]<class Driver>(const auto&... settings) {
    const auto make = [&](Spi& spi) { return Driver{Registers{spi}, settings...}; };
    return std::make_unique<drivers::ErasedGyro<Spi, Driver>>(make, chip_);
  };
  if (!wanted.acceleration_range_g) {
    return erased.operator()<Chip::Driver<Registers>>(settings_of(wanted));
  }
  const core::Acceleration noise = core::standard_gravity(1e-3F);
  chip_.set_specific_force(
      {core::Acceleration{}, core::Acceleration{}, core::standard_gravity(1.0F)}, noise);
  return erased.operator()<Chip::DriverWithAcceleration<Registers>>(
      settings_of(wanted), code_of(*wanted.acceleration_range_g, Chip::kAccelerationRanges));
}

core::Instant SimulatedVehicle::now() const {
  const core::Duration real = hal::linux_os::KernelClock::now() - begin_;
  return begin_ +
         core::Duration::nanoseconds(std::llround(static_cast<double>(real.ns()) * time_factor_));
}

/// One sample at most, stamped with the time when it was due.
void SimulatedVehicle::wait() {
  const core::Duration left = std::max(next_sample_ - now(), core::Duration{});
  const auto real_ns = static_cast<std::int64_t>(static_cast<double>(left.ns()) / time_factor_);
  const std::timespec limit{.tv_sec = static_cast<std::time_t>(real_ns / 1'000'000'000),
                            .tv_nsec = static_cast<long>(real_ns % 1'000'000'000)};
  pollfd source{.fd = wake_.descriptor(), .events = POLLIN, .revents = 0};
  (void)ppoll(&source, 1, &limit, nullptr);
  wake_.clear();
  if (now() >= next_sample_) measure();
}

void SimulatedVehicle::measure() {
  clock_.advance_to(next_sample_);
  const core::Duration time = next_sample_ - begin_;
  const SimulatedMotion motion = drives_ ? motion_at(time) : SimulatedMotion{};
  if (motion.is_moving && next_sample_ >= next_pulse_) {
    odometer_.pulse(next_sample_);
    next_pulse_ = next_sample_ + kPulsePeriod;
  }
  constexpr float kWander_rad_s_per_sqrt_s = 3e-6F;
  const float wander =
      kWander_rad_s_per_sqrt_s * std::sqrt(static_cast<float>(gyro_->sample_period().ns()) * 1e-9F);
  std::normal_distribution<float> step{0.0F, wander};
  std::array<core::AngularRate, 3> rates{};
  for (std::size_t i = 0; i < rates.size(); ++i) {
    bias_rad_s_.at(i) += step(random_);
    const float turn = i == 2 ? motion.turn.in(core::rad_per_s) : 0.0F;
    rates.at(i) = core::rad_per_s(turn + bias_rad_s_.at(i) + noise_(random_));
  }
  chip_.measure(rates, temperature_at(time));
  next_sample_ = next_sample_ + gyro_->sample_period();
}

std::unique_ptr<Hardware> make_hardware(const Configuration& configuration) {
  if (configuration.gyro.is_simulated()) return std::make_unique<SimulatedVehicle>(configuration);
  return std::make_unique<LinuxHardware>(configuration);
}

}  // namespace zerorate::linux_node
