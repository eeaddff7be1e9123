#include "drivers/common/register_access.hpp"

using namespace zerorate;

struct Bus {
  core::Result<void, hal::BusError> read(std::uint8_t first, std::span<std::uint8_t> out);
  core::Result<void, hal::BusError> write(std::uint8_t address, std::uint8_t value);
};

constexpr drivers::Register<0x0F, drivers::Access::read_only> kIdentity;
constexpr drivers::Register<0x11, drivers::Access::read_write> kControl;

core::Result<void, drivers::DriverError> write(Bus& bus) {
#ifdef MUST_NOT_COMPILE
  return drivers::write_register(bus, kIdentity, 0x6C);
#else
  static_cast<void>(kIdentity);
  return drivers::write_register(bus, kControl, 0x6C);
#endif
}
