#include "firmware/boards/linux/chips/gyro.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "drivers/chips/chips.hpp"
#include "drivers/common/erased_gyro.hpp"
#include "drivers/common/frame_bus.hpp"
#include "drivers/common/register_bus.hpp"
#include "hal/linux/i2c_dev.hpp"
#include "hal/linux/spidev.hpp"

namespace zerorate::linux_node {
namespace {

using Spi = hal::linux_os::SpidevDevice<>;
using I2c = hal::linux_os::I2cDevBus<>;

/// Driver settings that `wanted` names; it must be possible by the chip's description.
template <class Chip>
auto settings_of(const GyroSettings& wanted) {
  const auto code_of = [](double value, const auto& choices) {
    return std::ranges::find_if(choices, [&](auto& choice) { return choice.value == value; })->code;
  };
  return Chip::settings(code_of(wanted.rate_hz, Chip::kRates),
                        code_of(wanted.full_scale_dps, Chip::kFullScales), wanted.fifo);
}

/// @param link  makes from a wire what the driver talks through
template <template <class> class Driver, class Wire, class Settings, class Link, class... Node>
std::unique_ptr<drivers::AnyGyro> bind(const Settings& settings, Link link, Node&&... node) {
  using Bound = Driver<decltype(link(std::declval<Wire&>()))>;
  return std::make_unique<drivers::ErasedGyro<Wire, Bound>>(
      [&](Wire& wire) {
        return Bound{link(wire), settings};
      },
      std::forward<Node>(node)...);
}

template <class Chip>
std::unique_ptr<drivers::AnyGyro> make(const GyroSettings& wanted) {
  const auto settings = settings_of<Chip>(wanted);
  const hal::linux_os::SpiSettings spi{wanted.device, wanted.speed_hz, Chip::kSpiMode};
  if constexpr (drivers::RegisterChipEntry<Chip>) {
    if (wanted.bus == BusKind::i2c) {
      const hal::I2cAddress address{wanted.address};
      return bind<Chip::template Driver, I2c>(
          settings,
          [&](I2c& wire) {
            return drivers::I2cRegisters{wire, address};
          },
          wanted.device);
    }
    return bind<Chip::template Driver, Spi>(
        settings, [](Spi& wire) { return drivers::SpiRegisters{wire}; }, spi);
  } else {
    return bind<Chip::template Driver, Spi>(
        settings, [](Spi& wire) { return drivers::SpiFrames{wire}; }, spi);
  }
}

template <const auto& Choices>
constexpr auto kValues = [] {
  std::array<double, Choices.size()> values{};
  std::ranges::transform(Choices, values.begin(), [](const auto& choice) { return choice.value; });
  return values;
}();

template <class Chip>
constexpr auto kAddresses = [] {
  if constexpr (drivers::RegisterChipEntry<Chip>) {
    std::array<std::uint8_t, Chip::kAddresses.size()> addresses{};
    std::ranges::transform(Chip::kAddresses, addresses.begin(), [](hal::I2cAddress address) {
      return static_cast<std::uint8_t>(address);
    });
    return addresses;
  } else {
    return std::span<const std::uint8_t>{};
  }
}();

template <class Chip>
ChipDescription describe() {
  return {.name = Chip::kName,
          .rates_hz = kValues<Chip::kRates>,
          .full_scales_dps = kValues<Chip::kFullScales>,
          .addresses = kAddresses<Chip>,
          .highest_speed_hz = Chip::kHighestSpi_hz,
          .has_fifo = Chip::kHasFifo,
          .counts = Chip::kCounts,
          .make = make<Chip>};
}

}  // namespace

std::span<const ChipDescription> chips() {
  static const std::vector<ChipDescription> all = [] {
    std::vector<ChipDescription> descriptions;
    drivers::AllChips::for_each([&]<class Chip> { descriptions.push_back(describe<Chip>()); });
    return descriptions;
  }();
  return all;
}

const ChipDescription* find_chip(std::string_view name) {
  const auto found = std::ranges::find(chips(), name, &ChipDescription::name);
  return found == chips().end() ? nullptr : &*found;
}

}  // namespace zerorate::linux_node
