#include "host_tools/lib/evaluate/simulated_gyro.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/chips/chips.hpp"
#include "drivers/common/any_gyro.hpp"
#include "drivers/common/frame_bus.hpp"
#include "drivers/common/register_access.hpp"
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

/// @tparam Device  how the chip hangs on SPI
template <class Simulated, class Device, class Driver>
class Assembled final
    : public drivers::ErasedGyro<Wiring<Simulated, Device>, Driver, SimulatedGyro> {
 public:
  using drivers::ErasedGyro<Wiring<Simulated, Device>, Driver, SimulatedGyro>::ErasedGyro;

  void measure(const std::array<core::AngularRate, 3>& rate,
               core::Temperature temperature) override {
    this->wiring().chip.measure(rate, temperature);
  }
  hal::sim::DataReadyPin& interrupt() override {
    if constexpr (requires { this->wiring().chip.interrupt(); }) {
      return this->wiring().chip.interrupt();
    } else {
      return this->wiring().no_pin;
    }
  }
};

template <class Simulated, template <class> class Driver, class Device, class Link, class Settings>
std::unique_ptr<SimulatedGyro> assemble(const hal::sim::SimulatedClock& clock,
                                        const Settings& settings) {
  using OnLink = Driver<Link>;
  return std::make_unique<Assembled<Simulated, Device, OnLink>>(
      [&](Wiring<Simulated, Device>& wiring) {
        return OnLink{Link{wiring.device}, settings};
      },
      clock);
}

template <class Chip, class Simulated>
std::unique_ptr<SimulatedGyro> make(const hal::sim::SimulatedClock& clock) {
  if constexpr (drivers::RegisterChipEntry<Chip>) {
    using Device = hal::sim::SimulatedSpiDevice<Simulated>;
    return assemble<Simulated, Chip::template Driver, Device, drivers::SpiRegisters<Device>>(
        clock, typename Chip::Settings{});
  } else {
    using Device = hal::sim::SimulatedFrameSpi<Simulated>;
    // The chip has no rate of its own; shorter than any recording's, each row is due.
    const auto settings =
        Chip::settings(core::Duration::microseconds(1), Chip::kFullScales[0].code, false);
    return assemble<Simulated, Chip::template Driver, Device, drivers::SpiFrames<Device>>(clock,
                                                                                          settings);
  }
}

/// Adds the line of a chip that has a simulated one.
template <class Chip>
void add(std::vector<SimulatedChip>& chips) {
  hal::sim::AllSimulatedChips::for_each([&]<class Simulated> {
    if constexpr (Simulated::kName == Chip::kName) {
      chips.push_back(
          {.name = Chip::kName, .axis_count = Chip::kAxes, .make = make<Chip, Simulated>});
    }
  });
}

}  // namespace

std::span<const SimulatedChip> simulated_chips() {
  static const std::vector<SimulatedChip> chips = [] {
    std::vector<SimulatedChip> lines;
    drivers::AllChips::for_each([&]<class Chip> { add<Chip>(lines); });
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
