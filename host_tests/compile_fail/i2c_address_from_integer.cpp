#include "hal/contract/i2c_bus.hpp"

using namespace zerorate::hal;

#ifdef MUST_NOT_COMPILE
constexpr I2cAddress kAddress = 0x6A;
#else
constexpr I2cAddress kAddress{0x6A};
#endif
