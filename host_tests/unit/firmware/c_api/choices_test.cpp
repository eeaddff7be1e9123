// Choices in zerorate_config: the witness of rest, and the predictor that corrects the rate.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "firmware/app/gyro_node.hpp"
#include "firmware/c_api/node_of_model.hpp"
#include "host_tests/unit/firmware/c_api/c_api_rig.hpp"

namespace zerorate::c_api {
namespace {

using testing::feed;
using testing::kDriveSamples;
using testing::kPeriod_s;
using testing::kStopSamples;
using testing::moment;

constexpr std::int64_t kRound = kStopSamples + kDriveSamples;

/// Last message of half a minute in which the vehicle stands by its odometer, and rocks by 3 deg/s.
zerorate_rate rocked(zerorate_standstill by) {
  zerorate_config config = zerorate_default_config();
  config.standstill = by;
  zerorate_node node;
  EXPECT_EQ(zerorate_init(&node, &front_gyro, &config), ZERORATE_OK);
  zerorate_rate rate{};
  for (std::int64_t k = 0; k < kStopSamples / 2; ++k) {
    testing::Moment now = moment(k);
    const float turns = 0.5F * kPeriod_s * static_cast<float>(k);  // half a hertz
    for (float& one : now.measured.rate_rad_s) {
      one += 0.05F * std::sin(2.0F * std::numbers::pi_v<float> * turns);
    }
    rate = feed(node, now);
  }
  return rate;
}

/// Verifies SR-STILL-12.
TEST(CInterfaceByTheOdometerAlone, LearnsWhateverTheGyroShows) {
  EXPECT_FALSE(rocked(ZERORATE_BY_ODOMETER).health.calibrated);
  const zerorate_rate rate = rocked(ZERORATE_BY_ODOMETER_ALONE);
  EXPECT_TRUE(rate.health.calibrated);
  for (std::size_t i = 0; i < testing::kBias.size(); ++i) {
    // A tenth of the rocking: the newest swings weigh more than those before them.
    EXPECT_NEAR(rate.bias_rad_s[i], testing::kBias[i], 5e-3F);
  }
}

/// Verifies SR-PRED-12.
TEST(CInterfaceGivenAPredictor, CorrectsTheRateByThatOne) {
  zerorate_config config = zerorate_default_config();
  constexpr std::pair<zerorate_predictor, app::Predictor> kAll[] = {
      {ZERORATE_KALMAN, app::Predictor::kalman},
      {ZERORATE_MOVING_AVERAGE, app::Predictor::moving_average},
      {ZERORATE_CALIBRATION_MEAN, app::Predictor::calibration_mean}};
  std::vector<float> last;
  for (const auto& [chosen, expected] : kAll) {
    config.predictor = chosen;
    const Node::Params params = params_of(front_gyro, config);
    ASSERT_EQ(params.published, expected);
    Node node{params};
    zerorate_node instance;
    ASSERT_EQ(zerorate_init(&instance, &front_gyro, &config), ZERORATE_OK);
    for (std::int64_t k = 0; k < 2 * kRound; ++k) {
      const zerorate_rate rate = feed(instance, moment(k));
      const auto& measured = moment(k).measured;
      core::GyroSample sample{.time = core::Instant::from_ns(measured.time_ns)};
      for (std::size_t i = 0; i < 3; ++i) sample.rate[i] = core::rad_per_s(measured.rate_rad_s[i]);
      if (!moment(k).stands) node.pulse(sample.time);
      const app::RateMessage message = node.step(sample);
      for (std::size_t i = 0; i < 3; ++i) {
        ASSERT_EQ(rate.bias_rad_s[i], message.axes[i].bias.in(core::rad_per_s)) << k;
        ASSERT_EQ(rate.corrected_rad_s[i], message.axes[i].corrected.in(core::rad_per_s)) << k;
      }
    }
    last.push_back(node.bias(expected, 0).in(core::rad_per_s));
  }
  EXPECT_TRUE(last[0] != last[1] && last[1] != last[2] && last[0] != last[2]);
}

}  // namespace
}  // namespace zerorate::c_api
