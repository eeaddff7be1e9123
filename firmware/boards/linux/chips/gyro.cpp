#include "firmware/boards/linux/chips/gyro.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "drivers/chips/chips.hpp"
#include "drivers/common/any_gyro.hpp"
#include "drivers/common/chip.hpp"
#include "drivers/common/register_access.hpp"
#include "firmware/boards/linux/chips/iio_gyro.hpp"
#include "hal/linux/i2c_dev.hpp"
#include "hal/linux/spidev.hpp"
#include "hal/linux/sysfs.hpp"

namespace zerorate::linux_node {
namespace {

using Spi = hal::linux_os::SpidevDevice<>;
using I2c = hal::linux_os::I2cDevBus<>;

/// Code of a value, which must be among the choices.
auto code_of(double value, const auto& choices) {
  return std::ranges::find_if(choices, [&](auto& choice) { return choice.value == value; })->code;
}

/// Driver settings that `wanted` names; it must be possible by the chip's description.
template <class Chip>
auto settings_of(const GyroSettings& wanted) {
  return Chip::settings(code_of(wanted.rate_hz, Chip::kRates),
                        code_of(wanted.full_scale_dps, Chip::kFullScales), wanted.fifo);
}

using Bytes = std::vector<std::uint8_t>;

/// File of the chip's maker. Throws KernelFileError.
template <drivers::ConfigFileChipEntry Chip>
Bytes read_config_file(const std::string& path) {
  constexpr const char* kCure = "config_file of [gyro] names the maker's file for this chip";
  errno = 0;
  std::ifstream file{path, std::ios::binary};
  if (!file) throw hal::linux_os::KernelFileError(path, errno, kCure);
  Bytes bytes{std::istreambuf_iterator<char>{file}, {}};
  if (Chip::takes_config_file(bytes.size())) return bytes;
  throw hal::linux_os::KernelFileError(
      path, std::to_string(bytes.size()) + " bytes cannot be the file of this chip", kCure);
}

template <drivers::RegisterChipEntry Chip, drivers::RegisterBus Bus>
std::optional<std::uint32_t> identity_of(Bus bus) {
  const auto identity = drivers::read_register(bus, Chip::kIdentity);
  if (!identity) return std::nullopt;
  return *identity;
}

template <drivers::LateChipEntry Chip, class Bus>
std::optional<std::uint32_t> identity_of(Bus bus) {
  const auto reply = drivers::ask_identity<Chip>(bus);
  if (!reply) return std::nullopt;
  return *reply;
}

constexpr const char* kFileNotTaken =
    "the chip did not take config_file of [gyro]: another chip's, or damaged";
constexpr const char* kNoFile = "config_file of [gyro] is missing, which the chip needs";

constexpr const char* kNoAccelerometer =
    "the gyro answers, but its accelerometer gives another identity or none (is it wired? see "
    "accelerometer_address and accelerometer_device; or leave acceleration out)";

constexpr const char* kAnotherModel =
    "the chip is of the right family, but another model, with another full scale: see chip of "
    "[gyro]";

/// @tparam Link  makes from a wire what the driver talks through
template <class Chip, class Wire, class Link, class Driver>
class BoundGyro final : public drivers::ErasedGyro<Wire, Driver, DeviceGyro> {
 public:
  /// @param settings  what the driver takes besides the link
  template <class Node, class... Settings>
  BoundGyro(Link link, const Node& node, const Settings&... settings)
      : drivers::ErasedGyro<Wire, Driver, DeviceGyro>(
            [&](Wire& wire) {
              return Driver{link(wire), settings...};
            },
            node),
        link_(link) {}

  GyroReason reason(drivers::DriverErrorCode code) override {
    GyroReason reason{.error_number = this->wiring().error_number()};
    if (code == drivers::DriverErrorCode::wrong_identity) {
      const auto link = link_(this->wiring());
      if constexpr (requires { link.accelerometer; }) {
        reason.identity = identity_of<Chip>(link.gyro);
        if (reason.identity == Chip::kIdentity.reset) reason.told = kNoAccelerometer;
      } else {
        reason.identity = identity_of<Chip>(link);
      }
      if constexpr (drivers::WordChipEntry<Chip>) {
        const bool is_it =
            reason.identity && Chip::is_identity(static_cast<std::uint16_t>(*reason.identity));
        if (is_it) reason.told = kAnotherModel;
      }
    }
    if constexpr (drivers::ConfigFileChipEntry<Chip>) {
      if (code == drivers::DriverErrorCode::sensor_fault) reason.told = kFileNotTaken;
      if (code == drivers::DriverErrorCode::no_config_file) reason.told = kNoFile;
    }
    return reason;
  }

 private:
  Link link_;
};

/// @tparam Driver  of Chip, over what the link makes
template <class Chip, class Wire, template <class> class Driver, class Link, class Node,
          class... Settings>
std::unique_ptr<DeviceGyro> bound(Link link, const Node& node, const Settings&... settings) {
  using DriverOverLink = Driver<std::invoke_result_t<Link, Wire&>>;
  return std::make_unique<BoundGyro<Chip, Wire, Link, DriverOverLink>>(link, node, settings...);
}

template <class Chip, class Wire, class Link, class Node>
std::unique_ptr<DeviceGyro> bind_with(const GyroSettings& wanted,
                                      const typename Chip::Settings& settings, Link link,
                                      const Node& node) {
  if constexpr (drivers::AccelerometerChipEntry<Chip> && !drivers::TwoDieChipEntry<Chip>) {
    if (wanted.acceleration_range_g) {
      const auto range = code_of(*wanted.acceleration_range_g, Chip::kAccelerationRanges);
      return bound<Chip, Wire, Chip::template DriverWithAcceleration>(link, node, settings, range);
    }
  }
  return bound<Chip, Wire, Chip::template Driver>(link, node, settings);
}

template <class Chip, class Wire, class Link, class Node>
std::unique_ptr<DeviceGyro> bind(const GyroSettings& wanted, Link link, const Node& node) {
  auto settings = settings_of<Chip>(wanted);
  if constexpr (drivers::ConfigFileChipEntry<Chip>) {
    if (!wanted.config_file.empty()) {
      // The gyro keeps its link, and the link keeps the file.
      const auto file = std::make_shared<const Bytes>(read_config_file<Chip>(wanted.config_file));
      settings.config_file = *file;
      const auto keeping = [link, file](Wire& wire) { return link(wire); };
      return bind_with<Chip, Wire>(wanted, settings, keeping, node);
    }
  }
  return bind_with<Chip, Wire>(wanted, settings, link, node);
}

/// The nodes of two dies that share a bus of SPI.
class SpiPair {
 public:
  using Settings = std::array<hal::linux_os::SpiSettings, 2>;
  explicit SpiPair(const Settings& settings) : gyro(settings[0]), accelerometer(settings[1]) {}

  [[nodiscard]] int error_number() const {
    return gyro.error_number() != 0 ? gyro.error_number() : accelerometer.error_number();
  }

  Spi gyro;
  Spi accelerometer;
};

template <drivers::TwoDieChipEntry Chip>
std::unique_ptr<DeviceGyro> make_both(const GyroSettings& wanted) {
  const auto settings = settings_of<Chip>(wanted);
  const auto range = code_of(*wanted.acceleration_range_g, Chip::kAccelerationRanges);
  if (wanted.bus == BusKind::i2c) {
    const hal::I2cAddress gyro{wanted.address};
    const hal::I2cAddress accelerometer{wanted.accelerometer_address};
    const auto link = [gyro, accelerometer](I2c& wire) {
      return Chip::buses(drivers::I2cRegisters{wire, gyro},
                         drivers::I2cRegisters{wire, accelerometer});
    };
    return bound<Chip, I2c, Chip::template DriverWithAcceleration>(link, wanted.device, settings,
                                                                   range);
  }
  const auto link = [](SpiPair& wire) {
    return Chip::buses(drivers::SpiRegisters{wire.gyro},
                       typename Chip::template AccelerometerSpi<Spi>{wire.accelerometer});
  };
  const SpiPair::Settings nodes{
      hal::linux_os::SpiSettings{wanted.device, wanted.speed_hz, Chip::kSpiMode},
      hal::linux_os::SpiSettings{wanted.accelerometer_device, wanted.speed_hz, Chip::kSpiMode}};
  return bound<Chip, SpiPair, Chip::template DriverWithAcceleration>(link, nodes, settings, range);
}

template <class Chip>
std::unique_ptr<DeviceGyro> make(const GyroSettings& wanted) {
  if constexpr (drivers::TwoDieChipEntry<Chip>) {
    if (wanted.acceleration_range_g) return make_both<Chip>(wanted);
  }
  const hal::linux_os::SpiSettings spi{wanted.device, wanted.speed_hz, Chip::kSpiMode,
                                       drivers::kSpiPauseOf<Chip>};
  if constexpr (drivers::RegisterChipEntry<Chip>) {
    if (wanted.bus == BusKind::i2c) {
      const hal::I2cAddress address{wanted.address};
      return bind<Chip, I2c>(
          wanted,
          [address](I2c& wire) {
            return drivers::I2cRegisters{wire, address};
          },
          wanted.device);
    }
  }
  return bind<Chip, Spi>(
      wanted, [](Spi& wire) { return drivers::SpiLink<Chip, Spi>{wire}; }, spi);
}

template <const auto& Choices>
constexpr auto kValues = [] {
  std::array<double, Choices.size()> values{};
  std::ranges::transform(Choices, values.begin(), [](const auto& choice) { return choice.value; });
  return values;
}();

template <class Chip>
constexpr std::span<const double> acceleration_ranges() {
  if constexpr (drivers::AccelerometerChipEntry<Chip>) return kValues<Chip::kAccelerationRanges>;
  return {};
}
template <class Chip>
constexpr double usual_acceleration_range() {
  if constexpr (drivers::AccelerometerChipEntry<Chip>) return Chip::kUsualAccelerationRange_g;
  return 0.0;
}

template <const auto& Addresses>
constexpr auto kNumbers = [] {
  std::array<std::uint8_t, Addresses.size()> numbers{};
  std::ranges::transform(Addresses, numbers.begin(), [](hal::I2cAddress address) {
    return static_cast<std::uint8_t>(address);
  });
  return numbers;
}();

template <class Chip>
constexpr std::span<const std::uint8_t> addresses() {
  if constexpr (drivers::RegisterChipEntry<Chip>) return kNumbers<Chip::kAddresses>;
  return {};
}
template <class Chip>
constexpr std::span<const std::uint8_t> accelerometer_addresses() {
  if constexpr (drivers::TwoDieChipEntry<Chip>) return kNumbers<Chip::kAccelerometerAddresses>;
  return {};
}

template <class Chip>
constexpr std::optional<std::uint8_t> kIdentity = [] {
  std::optional<std::uint8_t> identity;
  if constexpr (drivers::RegisterChipEntry<Chip>) identity = Chip::kIdentity.reset;
  return identity;
}();

template <class Chip>
ChipDescription describe() {
  return {.name = Chip::kName,
          .rates_hz = kValues<Chip::kRates>,
          .full_scales_dps = kValues<Chip::kFullScales>,
          .acceleration_ranges_g = acceleration_ranges<Chip>(),
          .usual_acceleration_range_g = usual_acceleration_range<Chip>(),
          .accelerometer_addresses = accelerometer_addresses<Chip>(),
          .addresses = addresses<Chip>(),
          .highest_speed_hz = Chip::kHighestSpi_hz,
          .has_fifo = Chip::kHasFifo,
          .has_thermometer = Chip::kHasThermometer,
          .needs_config_file = drivers::ConfigFileChipEntry<Chip>,
          .counts = Chip::kCounts,
          .identity = kIdentity<Chip>,
          .make = make<Chip>};
}

}  // namespace

std::span<const ChipDescription> chips() {
  static const std::vector<ChipDescription> all = [] {
    std::vector<ChipDescription> descriptions;
    drivers::AllChips::for_each([&]<class Chip> { descriptions.push_back(describe<Chip>()); });
    std::ranges::sort(descriptions, {}, &ChipDescription::name);
    return descriptions;
  }();
  return all;
}

const ChipDescription* find_chip(std::string_view name) {
  const auto found = std::ranges::find(chips(), name, &ChipDescription::name);
  return found == chips().end() ? nullptr : &*found;
}

std::unique_ptr<DeviceGyro> make_gyro(const GyroSettings& settings, const std::string& sysfs) {
  using namespace hal::linux_os;
  if (settings.bus == BusKind::iio) return std::make_unique<IioGyro>(settings);
  const auto refuse_if_held = [&](const std::string& device, std::uint8_t address) {
    const std::string driver = settings.bus == BusKind::i2c ? driver_of_i2c(sysfs, device, address)
                                                            : driver_of_spi(sysfs, device);
    if (driver.empty()) return;
    throw KernelFileError(device, "the kernel's driver " + driver + " holds the chip",
                          "read it with bus = \"iio\", see zerorate probe; or unbind the driver");
  };
  refuse_if_held(settings.device, settings.address);
  if (settings.accelerometer_address != 0) {
    refuse_if_held(settings.device, settings.accelerometer_address);
  }
  if (!settings.accelerometer_device.empty()) refuse_if_held(settings.accelerometer_device, 0);
  return find_chip(settings.chip)->make(settings);
}

}  // namespace zerorate::linux_node
