#include <gtest/gtest.h>

#include "host_tests/endurance/lockstep.hpp"

namespace zerorate::testing {
namespace {

TEST(KalmanPredictorOverAHundredMillionSteps, StaysPositiveDefiniteAndKeepsItsInterval) {
  for (const double order : {0.5, 0.8}) {
    for (const double r : {1e-6, 10.0}) {
      const Lockstep run = run_in_lockstep(fitted_decades(order), r, 100'000'000, 1'000'000);
      EXPECT_EQ(run.checks, 100U);
      expect_sound(run, order, r);
    }
  }
}

}  // namespace
}  // namespace zerorate::testing
