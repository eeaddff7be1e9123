#include "drivers/common/configuration_table.hpp"

using namespace zerorate::drivers;

constexpr Register<0x0F, Access::read_only> kIdentity;
constexpr Register<0x11, Access::read_write> kControl;

#ifdef MUST_NOT_COMPILE
constexpr ConfigurationEntry kEntry = configure(kIdentity, 0xFF, 0x00);
#else
constexpr ConfigurationEntry kEntry = configure(kControl, 0xFF, 0x00);
#endif
