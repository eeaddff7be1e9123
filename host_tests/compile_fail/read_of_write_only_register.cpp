#include "drivers/common/register_access.hpp"

using namespace zerorate;

struct Bus {
  core::Result<void, hal::BusError> read(std::uint8_t first, std::span<std::uint8_t> out);
  core::Result<void, hal::BusError> write(std::uint8_t address, std::uint8_t value);
};

constexpr drivers::Register<0x7E, drivers::Access::write_only> kCommand;
constexpr drivers::Register<0x11, drivers::Access::read_write> kControl;

core::Result<std::uint8_t, drivers::DriverError> read(Bus& bus) {
#ifdef MUST_NOT_COMPILE
  return drivers::read_register(bus, kCommand);
#else
  static_cast<void>(kCommand);
  return drivers::read_register(bus, kControl);
#endif
}
