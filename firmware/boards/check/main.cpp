// Links everything that is meant to be flashed into one image that nobody runs: what compiles on
// the host but allocates, throws or computes in double precision is found here, on the first day.

#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"

namespace {

using namespace zerorate;

// The outside world: what comes in is unknown to the compiler, and what goes out is seen.
// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
volatile std::int64_t clock_ns;
volatile float gyro_deg_per_s;
volatile float report;
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

enum class Refusal : std::uint8_t { not_finite };

core::Result<core::AngularRate, Refusal> read_rate() {
  const float rate_deg_per_s = gyro_deg_per_s;
  if (!core::is_finite(rate_deg_per_s)) return core::Unexpected{Refusal::not_finite};
  return core::deg_per_s(rate_deg_per_s);
}

void exercise_base() {
  const auto start = core::Instant::from_ns(clock_ns);
  const core::Duration elapsed = core::Instant::from_ns(clock_ns) - start;
  report = core::to_float(elapsed / core::Duration::milliseconds(10));
  const auto rate = read_rate();
  if (!rate) return;
  report = (*rate * elapsed).in(core::deg);
  report = core::square_root(rate->in(core::deg_per_h));
  report = core::decay_share(elapsed.in_seconds());
}

}  // namespace

extern "C" [[noreturn]] int main() {
  while (true) exercise_base();
}
