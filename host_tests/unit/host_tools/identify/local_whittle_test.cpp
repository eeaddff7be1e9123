#include "host_tools/lib/identify/whittle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::identify {
namespace {

std::vector<double> flicker(std::size_t samples) {
  const std::vector<simulate::Effect> effects{simulate::FlickerNoise{1.0}};
  return simulate::simulate(simulate::Signal(samples, 1.0), effects, random::RandomStream(20120416))
      .rate_rad_s;
}

TEST(LocalWhittle, DoesNotSeeScaleAndBias) {
  std::vector<double> rate = flicker(1000);
  const Estimate plain = exact_local_whittle(rate, 80);
  for (double& value : rate) value = 1e-4 * value + 0.3;
  EXPECT_NEAR(exact_local_whittle(rate, 80).value, plain.value, 1e-4);
}

TEST(LocalWhittle, StatesAnErrorThatTendsToItsLimit) {
  const double limit = 0.5 / std::sqrt(2000.0);
  const double stated = exact_local_whittle(flicker(100'000), 2000).standard_error;
  EXPECT_GT(stated, limit);
  EXPECT_LT(stated, 1.02 * limit);
}

TEST(LocalWhittle, RefusesWhatHasNoOrder) {
  std::vector<double> rate = flicker(100);
  EXPECT_THROW((void)exact_local_whittle(rate, 1), std::invalid_argument);
  EXPECT_THROW((void)exact_local_whittle(rate, 50), std::invalid_argument);
  EXPECT_THROW((void)exact_local_whittle({}, 10), std::invalid_argument);
  rate[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)exact_local_whittle(rate, 10), recording::DataError);
  EXPECT_THROW((void)exact_local_whittle(std::vector<double>(100, 0.1), 10), recording::DataError);
}

}  // namespace
}  // namespace zerorate::identify
