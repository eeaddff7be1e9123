#include "firmware/wire/rate_text.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace zerorate::wire {
namespace {

std::string line_of(const app::RateMessage& message) {
  TextLine text{};
  const auto line = write_rate(message, text);
  return {line.begin(), line.end()};
}

app::RateMessage message_with(float x_dps, float y_dps, float z_dps) {
  app::RateMessage message{.time = core::Instant::from_ns(12'345'678'901),
                           .motion = core::Motion::still,
                           .health = {.calibrated = true}};
  message.axes[0].corrected = core::deg_per_s(x_dps);
  message.axes[1].corrected = core::deg_per_s(y_dps);
  message.axes[2].corrected = core::deg_per_s(z_dps);
  return message;
}

TEST(RateText, ShowsTimeMotionAndCorrectedRates) {
  EXPECT_EQ(line_of(message_with(1.5F, -0.00002F, 245.0F)),
            "     12.345 s  still    +   1.50000 -   0.00002 + 245.00000 deg/s\r\n");
}

TEST(RateTextOfWhatHasNoFiveDecimals, ShowsDashes) {
  EXPECT_EQ(line_of(message_with(std::numeric_limits<float>::quiet_NaN(),
                                 std::numeric_limits<float>::infinity(), -1e6F)),
            "     12.345 s  still     ----.-----  ----.-----  ----.----- deg/s\r\n");
}

TEST(RateTextBeforeTheFirstCalibration, EndsWithAQuestionMark) {
  app::RateMessage message = message_with(0.0F, 0.0F, 0.0F);
  message.health.calibrated = false;
  message.motion = core::Motion::moving;
  EXPECT_EQ(line_of(message),
            "     12.345 s  moving   +   0.00000 +   0.00000 +   0.00000 deg/s ?\r\n");
}

TEST(RateTextOfAnythingUnhealthy, EndsWithAnExclamationMark) {
  app::RateMessage message = message_with(0.0F, 0.0F, 0.0F);
  message.health.saturated = true;
  EXPECT_TRUE(line_of(message).ends_with(" deg/s !\r\n"));
}

TEST(RateTextAtItsLongest, FitsItsLine) {
  app::RateMessage message = message_with(9999.0F, -9999.0F, -9999.0F);
  message.time = core::Instant::from_ns(std::numeric_limits<std::int64_t>::max());
  message.motion = core::Motion::settling;
  message.health = {.saturated = true};
  EXPECT_LE(line_of(message).size(), TextLine{}.size());
}

}  // namespace
}  // namespace zerorate::wire
