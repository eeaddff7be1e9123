#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_tools/lib/identify/allan_deviation.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::identify {
namespace {

constexpr std::size_t kRuns = 400;
constexpr std::size_t kSamples = 4096;

using simulate::Effect;

/// Share of all intervals from tau = 8 on that hold the true deviation.
template <class Truth>
double coverage(const Effect& effect, const Truth& true_deviation) {
  double held = 0.0;
  double all = 0.0;
  for (std::size_t run = 0; run < kRuns; ++run) {
    const simulate::Signal signal =
        simulate::simulate(simulate::Signal(kSamples, 1.0), std::vector<Effect>{effect},
                           random::RandomStream(20120416, run));
    for (const AllanPoint& point :
         allan_deviation(signal.rate_rad_s, 1.0, {.points_per_decade = 3, .coverage = 0.9})) {
      if (point.tau_s < 8.0) continue;
      const double truth = true_deviation(point.tau_s);
      held += point.lo < truth && truth < point.hi ? 1.0 : 0.0;
      all += 1.0;
    }
  }
  return held / all;
}

// The points of one run are treated as one draw, which overstates the error. The published formulas
// are fits to within a few per cent of edf, and chi squared is itself approximate: 0.02 on top.
constexpr double kNominal = 0.9;
const double kError = 4.0 * std::sqrt(kNominal * (1.0 - kNominal) / kRuns) + 0.02;

TEST(AllanInterval, HoldsTheTruthOfWhiteNoise) {
  const auto truth = [](double tau_s) { return 1.0 / std::sqrt(tau_s); };
  EXPECT_NEAR(coverage(simulate::WhiteNoise{1.0}, truth), kNominal, kError);
}

TEST(AllanInterval, HoldsTheTruthOfFlickerNoise) {
  const auto truth = [](double) { return spectrum::allan_floor(1.0); };
  EXPECT_NEAR(coverage(simulate::FlickerNoise{1.0}, truth), kNominal, kError);
}

// K sqrt(tau / 3) for a walk in continuous time; a sum of m steps adds the factor 1 + 1 / (2 m^2).
TEST(AllanInterval, HoldsTheTruthOfARandomWalk) {
  const auto truth = [](double tau_s) {
    return std::sqrt(tau_s / 3.0 * (1.0 + 0.5 / (tau_s * tau_s)));
  };
  EXPECT_NEAR(coverage(simulate::RateRandomWalk{1.0}, truth), kNominal, kError);
}

}  // namespace
}  // namespace zerorate::identify
