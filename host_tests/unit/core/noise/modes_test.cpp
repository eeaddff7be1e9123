#include "core/noise/modes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <vector>

#include "core/noise/inputs.hpp"
#include "core/noise/terms.hpp"

namespace zerorate::core {
namespace {

constexpr Duration kTick = Duration::milliseconds(100);

constexpr auto every_block() {
  return compose(kTick, Start::stationary,
                 FlickerDecades<3>{.time_constant_s = {0.1F, 1.0F, 1e5F},
                                   .variance_rad2_s2 = {1.0F, 0.9F, 1.3F}},
                 RandomWalk{.coefficient_rad_s_sqrt_s = 0.01F},
                 GaussMarkov{.sigma_rad_s = 2.0F, .time_constant_s = 3.0F},
                 Harmonic{.rms_rad_s = 0.5F, .frequency_hz = 0.7F, .coherence_time_s = 20.0F});
}

/// The oracle: steps z and the running sum tick by tick, all moments in double, no alpha.
struct SteppedMode {
  std::complex<double> factor, kept = 1.0, reach = 0.0, sum_covariance = 0.0;
  double noise_per_tick, noise = 0.0, sum_variance = 0.0;

  SteppedMode(std::complex<double> f, double q) : factor(f), noise_per_tick(q) {}
  void step() {
    kept *= factor;
    noise = std::norm(factor) * noise + noise_per_tick;
    sum_covariance *= std::conj(factor);
    reach += kept;
    sum_variance += 2.0 * sum_covariance.real() + noise;
    sum_covariance += noise;
  }
};

std::complex<double> as_double(Complex x) {
  return {double{x.re}, double{x.im}};
}
std::complex<double> as_double(float x) {
  return double{x};
}

template <class Scalar>
void expect_equal(const ModeTransition<Scalar>& span, const SteppedMode& oracle,
                  std::uint32_t ticks) {
  // Float accuracy: 24 bits, and about as many roundings as there are doublings.
  const double tolerance = 6e-8 * (8.0 + 6.0 * std::log2(static_cast<double>(ticks)));
  const auto near = [&](std::complex<double> a, std::complex<double> b, const char* what) {
    EXPECT_LE(std::abs(a - b), tolerance * std::abs(b) + 1e-30) << what << " over " << ticks;
  };
  near(as_double(span.one_minus_phi_m), 1.0 - oracle.kept, "forgotten");
  near(as_double(span.sum_gain), oracle.reach, "reach");
  near(as_double(span.sum_lag), static_cast<double>(ticks) - oracle.reach, "lag");
  near(double{span.noise}, oracle.noise, "noise");
  near(as_double(span.sum_covariance), oracle.sum_covariance, "sum covariance");
  near(double{span.sum_variance}, oracle.sum_variance, "sum variance");
}

/// Verifies SR-PRED-03.
TEST(TransitionOverAGap, EqualsSteppingForEveryBlock) {
  const auto modes = every_block();
  SteppedMode level{1.0, double{modes.walk_variance}};
  std::vector<SteppedMode> decaying;
  for (const auto& m : modes.decaying)
    decaying.emplace_back(1.0 - double{m.one_minus_phi}, double{m.noise_variance});
  SteppedMode rotating{1.0 - as_double(modes.rotating[0].one_minus_phi),
                       double{modes.rotating[0].noise_variance}};
  std::uint32_t ticks = 0;
  for (const std::uint32_t stop : {1U, 2U, 3U, 7U, 64U, 1000U, 4095U, 100'003U}) {
    for (; ticks < stop; ++ticks) {
      level.step();
      for (auto& mode : decaying) mode.step();
      rotating.step();
    }
    const auto gap = modes.over(stop);
    expect_equal(gap.level, level, stop);
    for (std::size_t i = 0; i < decaying.size(); ++i)
      expect_equal(gap.decaying[i], decaying[i], stop);
    expect_equal(gap.rotating[0], rotating, stop);
  }
}

TEST(TransitionOverNoTicks, ChangesNothing) {
  const auto modes = every_block();
  const auto step = modes.over(17);
  EXPECT_EQ(then(step, modes.over(0)), step);
  EXPECT_EQ(modes.over(0).noise(), 0.0F);
}

TEST(TransitionsThatFollowEachOther, LastAsLongAsBoth) {
  const auto modes = every_block();
  EXPECT_EQ(then(modes.over(3), modes.over(5)).ticks, 8U);
}

TEST(TemperatureDrift, IsAnInputAndItsSquareOnAllAxes) {
  constexpr TemperatureDrift kDrift{.reference_degc = 20.0F,
                                    .slope_rad_s_per_k = 3.0F,
                                    .slope_sigma_rad_s_per_k = 5.0F,
                                    .curvature_rad_s_per_k2 = 4.0F,
                                    .curvature_sigma_rad_s_per_k2 = 6.0F,
                                    .lag_s = 7.0F};
  const auto terms = kDrift.terms();
  EXPECT_EQ(terms.reference_degc, 20.0F);
  EXPECT_EQ(terms.lag_s, 7.0F);
  EXPECT_EQ(terms.terms[0], (InputTerm{Input::temperature, 5.0F, {3.0F, 3.0F, 3.0F}}));
  EXPECT_EQ(terms.terms[1], (InputTerm{Input::temperature_squared, 6.0F, {4.0F, 4.0F, 4.0F}}));
}

TEST(StationaryMode, KeepsItsVarianceOverAnySpan) {
  const auto modes = every_block();
  for (const std::uint32_t ticks : {1U, 100U, 1'000'000U}) {
    const auto gap = modes.over(ticks);
    for (std::size_t i = 0; i < modes.decaying.size(); ++i) {
      const float variance = modes.decaying[i].initial_variance;
      EXPECT_NEAR(variance_after(gap.decaying[i], variance), variance, 2e-5F * variance);
    }
    const float variance = modes.rotating[0].initial_variance;
    EXPECT_NEAR(variance_after(gap.rotating[0], variance), variance, 2e-5F * variance);
  }
}

TEST(ZeroStart, LeavesEveryModeAtZero) {
  const auto modes =
      compose(kTick, Start::zero, GaussMarkov{.sigma_rad_s = 2.0F, .time_constant_s = 3.0F});
  EXPECT_EQ(modes.decaying[0].initial_variance, 0.0F);
  EXPECT_GT(modes.decaying[0].noise_variance, 0.0F);
}

TEST(Harmonic, TurnsAtItsFrequencyAndIsAliasedAboveNyquist) {
  const auto factor = [](float frequency_hz) {
    const auto modes = compose(
        kTick, Start::zero,
        Harmonic{.rms_rad_s = 1.0F, .frequency_hz = frequency_hz, .coherence_time_s = 1e3F});
    return 1.0 - as_double(modes.rotating[0].one_minus_phi);
  };
  EXPECT_NEAR(std::arg(factor(1.25F)), 2.0 * M_PI * 0.125, 1e-6);
  EXPECT_NEAR(std::arg(factor(10.0F + 1.25F)), 2.0 * M_PI * 0.125, 1e-5);
  EXPECT_NEAR(std::abs(factor(1.25F)), std::exp(-1e-4), 1e-7);
}

static_assert(decltype(every_block())::kStates == 3 + 1 + 2, "a random walk costs no state");

}  // namespace
}  // namespace zerorate::core
