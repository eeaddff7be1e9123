#include "core/base/units.hpp"

using namespace zerorate::core;

constexpr Temperature kInside = Temperature::from_degc(20.0F);
constexpr Temperature kOutside = Temperature::from_degc(-5.0F);

#ifdef MUST_NOT_COMPILE
constexpr auto kResult = kInside + kOutside;
#else
constexpr TemperatureDifference kResult = kInside - kOutside;
#endif
