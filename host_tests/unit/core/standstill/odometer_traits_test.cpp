#include "core/standstill/odometer_traits.hpp"

#include <gtest/gtest.h>

namespace zerorate::core {
namespace {

constexpr Standstill::Params kPlain{};

TEST(OdometerOfWhichNothingIsKnown, ChangesNothing) {
  const Standstill::Params params = adapted_to({}, kPlain);
  EXPECT_EQ(params.settle, kPlain.settle);
  EXPECT_EQ(params.hold_back, kPlain.hold_back);
  EXPECT_EQ(params.slowest, kPlain.slowest);
}

TEST(OdometerThatIsLate, HoldsBackLonger) {
  const auto params = adapted_to({.latency = Duration::milliseconds(100)}, kPlain);
  EXPECT_EQ(params.hold_back, kPlain.hold_back + Duration::milliseconds(100));
}

TEST(OdometerWithADeadBand, HoldsBackAsLongAsAGentleStartTakesToLeaveIt) {
  const auto params = adapted_to({.dead_band_mps = 0.75F}, kPlain);
  EXPECT_EQ(params.hold_back, kPlain.hold_back + Duration::milliseconds(750));
  EXPECT_EQ(params.slowest, kPlain.slowest);
}

TEST(OdometerWithADeadBandAndAKnownPulse, NeedsNoLongerSilenceThanTwiceTheLongestInterval) {
  const auto params = adapted_to({.dead_band_mps = 0.5F, .metres_per_pulse = 0.25F}, kPlain);
  EXPECT_EQ(params.slowest, Duration::seconds(1));
  const auto coarse = adapted_to({.dead_band_mps = 0.5F, .metres_per_pulse = 100.0F}, kPlain);
  EXPECT_EQ(coarse.slowest, kPlain.slowest);
}

}  // namespace
}  // namespace zerorate::core
