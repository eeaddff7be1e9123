#include "core/base/units.hpp"

using namespace zerorate::core;

#ifdef MUST_NOT_COMPILE
constexpr auto kSum = deg_per_s(1.0F) + deg(1.0F);
#else
constexpr auto kSum = deg_per_s(1.0F) + deg_per_h(1.0F);
#endif
