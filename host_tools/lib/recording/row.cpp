#include "host_tools/lib/recording/row.hpp"

#include <numbers>

namespace zerorate::recording {

double rad_per_s_in(RateUnit unit) {
  return unit == RateUnit::deg_per_s ? std::numbers::pi / 180.0 : 1.0;
}

}  // namespace zerorate::recording
