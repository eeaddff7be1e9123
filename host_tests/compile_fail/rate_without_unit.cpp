#include "core/base/units.hpp"

using namespace zerorate::core;

#ifdef MUST_NOT_COMPILE
constexpr AngularRate kRate = 1.0F;
#else
constexpr AngularRate kRate = rad_per_s(1.0F);
#endif
