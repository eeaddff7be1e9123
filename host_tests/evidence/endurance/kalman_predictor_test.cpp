#include <gtest/gtest.h>

#include <cstdint>

#include "host_tests/evidence/endurance/lockstep.hpp"

namespace zerorate::testing {
namespace {

/// Flicker of two orders, and next to no or mostly white noise; checked a hundred times on the way.
void expect_sound_over(std::uint64_t steps) {
  for (const double order : {0.5, 0.8}) {
    for (const double r : {1e-6, 10.0}) {
      const Lockstep run = run_in_lockstep(fitted_decades(order), r, steps, steps / 100);
      EXPECT_EQ(run.checks, 100U);
      expect_sound(run, order, r);
    }
  }
}

TEST(KalmanPredictorOverAMillionSteps, StaysPositiveDefiniteAndKeepsItsInterval) {
  expect_sound_over(1'000'000);
}

TEST(KalmanPredictorOverAHundredMillionSteps, StaysPositiveDefiniteAndKeepsItsInterval) {
  expect_sound_over(100'000'000);
}

}  // namespace
}  // namespace zerorate::testing
