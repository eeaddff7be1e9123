// Mistakes that the compiler must refuse, each under a macro of its name; without any macro the
// file compiles.
#pragma GCC diagnostic error "-Wunused-result"
#include "core/base/result.hpp"
#include "core/base/units.hpp"
#include "drivers/common/configuration_table.hpp"
#include "drivers/common/register_access.hpp"
#include "hal/contract/i2c_bus.hpp"

using namespace zerorate;
using namespace zerorate::core;

struct Bus {
  Result<void, hal::BusError> read(std::uint8_t first, std::span<std::uint8_t> out);
  Result<void, hal::BusError> write(std::uint8_t address, std::uint8_t value);
};

constexpr drivers::Register<0x0F, drivers::Access::read_only> kIdentity;
constexpr drivers::Register<0x7E, drivers::Access::write_only> kCommand;
constexpr drivers::Register<0x11, drivers::Access::read_write> kControl;

Result<void, drivers::DriverError> write(Bus& bus) {
#ifdef WRITE_TO_READ_ONLY_REGISTER
  return drivers::write_register(bus, kIdentity, 0x6C);
#else
  return drivers::write_register(bus, kControl, 0x6C);
#endif
}

Result<std::uint8_t, drivers::DriverError> read(Bus& bus) {
#ifdef READ_OF_WRITE_ONLY_REGISTER
  return drivers::read_register(bus, kCommand);
#else
  static_cast<void>(kCommand);
  return drivers::read_register(bus, kControl);
#endif
}

#ifdef CONFIGURATION_OF_READ_ONLY_REGISTER
constexpr drivers::ConfigurationEntry kEntry = drivers::configure(kIdentity, 0xFF, 0x00);
#else
constexpr drivers::ConfigurationEntry kEntry = drivers::configure(kControl, 0xFF, 0x00);
#endif

#ifdef MIXED_UNITS
constexpr auto kSum = deg_per_s(1.0F) + deg(1.0F);
#else
constexpr auto kSum = deg_per_s(1.0F) + deg_per_h(1.0F);
#endif

#ifdef RATE_WITHOUT_UNIT
constexpr AngularRate kRate = 1.0F;
#else
constexpr AngularRate kRate = rad_per_s(1.0F);
#endif

constexpr Temperature kInside = Temperature::from_degc(20.0F);
constexpr Temperature kOutside = Temperature::from_degc(-5.0F);
#ifdef TEMPERATURE_POINTS_ADDED
constexpr auto kResult = kInside + kOutside;
#else
constexpr TemperatureDifference kResult = kInside - kOutside;
#endif

#ifdef I2C_ADDRESS_FROM_INTEGER
constexpr hal::I2cAddress kAddress = 0x6A;
#else
constexpr hal::I2cAddress kAddress{0x6A};
#endif

enum class Refusal : unsigned char { late };
Result<void, Refusal> act();

void call() {
#ifdef IGNORED_RESULT
  act();
#else
  static_cast<void>(act());
#endif
}
