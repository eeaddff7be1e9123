#include "host_tools/lib/evaluate/simulated_gyro.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "drivers/chips/chips.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/any_gyro.hpp"
#include "drivers/common/chip.hpp"
#include "drivers/common/register_access.hpp"
#include "hal/sim/accelerometer.hpp"
#include "hal/sim/buses.hpp"
#include "hal/sim/chips.hpp"

namespace zerorate::evaluate {
namespace {

/// A simulated chip and the bus before it.
template <class Simulated, class Device>
struct Wiring {
  explicit Wiring(const hal::sim::SimulatedClock& clock) : chip(clock), device(chip) {}

  Simulated chip;
  Device device;
  hal::sim::DataReadyPin no_pin;
};

/// A force beyond every range: the driver gives a sample without acceleration.
constexpr core::Acceleration kBeyondRange = core::standard_gravity(1000.0F);

/// @tparam Device  how the chip hangs on SPI
template <class Simulated, class Device, class Driver>
class Assembled final
    : public drivers::ErasedGyro<Wiring<Simulated, Device>, Driver, SimulatedGyro> {
 public:
  using drivers::ErasedGyro<Wiring<Simulated, Device>, Driver, SimulatedGyro>::ErasedGyro;

  void measure(const core::GyroSample& sample) override {
    if constexpr (drivers::MeasuresAcceleration<Driver>) {
      hal::sim::SimulatedAccelerometer::Force force = sample.acceleration;
      if (!sample.has_acceleration) force.fill(kBeyondRange);
      this->wiring().chip.set_specific_force(force);
    }
    this->wiring().chip.measure(sample.rate, sample.temperature);
  }
  hal::sim::DataReadyPin& interrupt() override {
    if constexpr (requires { this->wiring().chip.interrupt(); }) {
      return this->wiring().chip.interrupt();
    } else {
      return this->wiring().no_pin;
    }
  }
};

/// @param link  makes from the device what the driver talks through
/// @param settings  what the driver takes besides the link
template <class Simulated, class Device, template <class> class Driver, class Link,
          class... Settings>
std::unique_ptr<SimulatedGyro> assemble(const hal::sim::SimulatedClock& clock, Link link,
                                        const Settings&... settings) {
  using OnLink = Driver<std::invoke_result_t<Link, Device&>>;
  return std::make_unique<Assembled<Simulated, Device, OnLink>>(
      [&](Wiring<Simulated, Device>& wiring) {
        return OnLink{link(wiring.device), settings...};
      },
      clock);
}

template <class Simulated>
using SpiOf = hal::sim::SimulatedSpi<Simulated>;
template <class Chip, class Simulated>
constexpr auto kLink =
    [](SpiOf<Simulated>& device) { return drivers::SpiLink<Chip, SpiOf<Simulated>>{device}; };

/// Settings of the driver, with the file that the simulated chip takes.
template <class Chip, class Simulated>
typename Chip::Settings usual_settings() {
  typename Chip::Settings settings{};
  if constexpr (drivers::ConfigFileChipEntry<Chip>) settings.config_file = Simulated::config_file();
  return settings;
}

/// The driver that reads the accelerometer, too.
template <drivers::AccelerometerChipEntry Chip, class Simulated>
std::unique_ptr<SimulatedGyro> make_with_acceleration(const hal::sim::SimulatedClock& clock) {
  const auto range = std::ranges::find_if(Chip::kAccelerationRanges, [](const auto& choice) {
                       return choice.value == Chip::kUsualAccelerationRange_g;
                     })->code;
  const auto settings = usual_settings<Chip, Simulated>();
  if constexpr (drivers::TwoDieChipEntry<Chip>) {
    using Device = typename Simulated::Module::Spi;
    const auto link = [](Device& device) {
      return Chip::buses(
          drivers::SpiRegisters{device.gyro},
          typename Chip::template AccelerometerSpi<
              std::remove_reference_t<decltype(device.accelerometer)>>{device.accelerometer});
    };
    return assemble<typename Simulated::Module, Device, Chip::template DriverWithAcceleration>(
        clock, link, settings, range);
  } else {
    return assemble<Simulated, SpiOf<Simulated>, Chip::template DriverWithAcceleration>(
        clock, kLink<Chip, Simulated>, settings, range);
  }
}

template <class Chip, class Simulated>
std::unique_ptr<SimulatedGyro> make(const hal::sim::SimulatedClock& clock,
                                    [[maybe_unused]] bool reads_accelerometer) {
  if constexpr (drivers::AccelerometerChipEntry<Chip>) {
    if (reads_accelerometer) return make_with_acceleration<Chip, Simulated>(clock);
  }
  auto settings = usual_settings<Chip, Simulated>();
  if constexpr (drivers::FrameChipEntry<Chip>) {
    // The chip has no rate of its own; shorter than any recording's, each row is due.
    settings.sample_period = core::Duration::microseconds(1);
  }
  return assemble<Simulated, SpiOf<Simulated>, Chip::template Driver>(clock, kLink<Chip, Simulated>,
                                                                      settings);
}

/// Adds the line of a chip that has a simulated one.
template <class Chip>
void add(std::vector<SimulatedChip>& chips) {
  hal::sim::AllSimulatedChips::for_each([&]<class Simulated> {
    if constexpr (Simulated::kName == Chip::kName) {
      chips.push_back({.name = Chip::kName,
                       .axis_count = Chip::kAxes,
                       .has_accelerometer = drivers::AccelerometerChipEntry<Chip>,
                       .make = make<Chip, Simulated>});
    }
  });
}

}  // namespace

std::span<const SimulatedChip> simulated_chips() {
  static const std::vector<SimulatedChip> chips = [] {
    std::vector<SimulatedChip> lines;
    drivers::AllChips::for_each([&]<class Chip> { add<Chip>(lines); });
    std::ranges::sort(lines, {}, &SimulatedChip::name);
    return lines;
  }();
  return chips;
}

const SimulatedChip& find_simulated_chip(std::string_view name) {
  const auto found = std::ranges::find(simulated_chips(), name, &SimulatedChip::name);
  if (found == simulated_chips().end()) {
    throw std::invalid_argument("there is no simulated chip " + std::string{name});
  }
  return *found;
}

}  // namespace zerorate::evaluate
