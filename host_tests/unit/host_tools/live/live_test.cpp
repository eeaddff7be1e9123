/// @file
/// Display of messages by zerorate monitor.

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <sstream>
#include <string>

#include "firmware/boards/linux/outputs/json_line.hpp"
#include "firmware/wire/explained_shares.hpp"
#include "host_tests/unit/firmware/wire/messages.hpp"
#include "host_tests/unit/host_tools/live/messages.hpp"
#include "host_tools/lib/live/source.hpp"
#include "host_tools/lib/live/tally.hpp"
#include "host_tools/lib/live/view.hpp"

namespace zerorate::live {
namespace {

using std::chrono::milliseconds;
using testing::calibrated_message;
using testing::tally_of;
using wire::NumberedMessage;

TEST(JsonMessage, RoundTripsUpToTheRoundingOfDegrees) {
  std::mt19937_64 random{3};
  linux_node::JsonBuffer buffer{};
  for (int i = 0; i < 200; ++i) {
    const NumberedMessage sent = wire::testing::random_message(random);
    const auto line = parse_json_message(linux_node::format_json_line(sent, buffer));
    ASSERT_TRUE(line.has_value());
    EXPECT_FALSE(line->learnt.has_value());
    const NumberedMessage* const read = &line->message;
    EXPECT_EQ(read->sequence, sent.sequence);
    EXPECT_EQ(read->message.time, sent.message.time);
    EXPECT_EQ(read->message.motion, sent.message.motion);
    EXPECT_EQ(read->message.health, sent.message.health);
    EXPECT_EQ(read->message.temperature, sent.message.temperature);
    EXPECT_EQ(read->message.odometer_pulses, sent.message.odometer_pulses);
    EXPECT_EQ(read->message.up, sent.message.up);
    ASSERT_EQ(read->message.slope.has_value(), sent.message.slope.has_value());
    if (sent.message.slope) {
      EXPECT_NEAR(read->message.slope->in(core::rad), sent.message.slope->in(core::rad), 1e-5F);
    }
    EXPECT_NEAR(read->message.vertical_turn.angle.in(core::rad),
                sent.message.vertical_turn.angle.in(core::rad), 1e-5F);
    EXPECT_EQ(read->message.acceleration, sent.message.acceleration);
    EXPECT_EQ(read->message.vibration, sent.message.vibration);
    ASSERT_EQ(read->message.explained.has_value(), sent.message.explained.has_value());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_FLOAT_EQ(read->message.axes[axis].bias.in(core::deg_per_s),
                      sent.message.axes[axis].bias.in(core::deg_per_s));
      if (sent.message.has_rate()) {
        EXPECT_FLOAT_EQ(read->message.axes[axis].corrected.in(core::deg_per_s),
                        sent.message.axes[axis].corrected.in(core::deg_per_s));
      }
      for (const wire::ExplainedShare& share : wire::kExplainedShares) {
        if (!sent.message.explained) break;
        EXPECT_FLOAT_EQ((read->message.explained->at(axis).*share.rate).in(core::deg_per_s),
                        (sent.message.explained->at(axis).*share.rate).in(core::deg_per_s));
      }
    }
  }
}

TEST(JsonMessageOfAnOlderNode, HasTheVerticalAsAnAxis) {
  linux_node::JsonBuffer buffer{};
  std::string line{linux_node::format_json_line(calibrated_message(1), buffer)};
  const std::string none = "\"up\":null";
  ASSERT_NE(line.find(none), std::string::npos);
  line.replace(line.find(none), none.size(), "\"up\":\"-y\"");
  EXPECT_EQ(parse_json_message(line)->message.message.up, (core::Direction{0.0F, -1.0F, 0.0F}));
}

TEST(JsonMessage, TakesADeviationThatIsNullForInfinite) {
  NumberedMessage sent = calibrated_message(1);
  sent.message.axes[1].sigma = core::rad_per_s(std::numeric_limits<float>::infinity());
  linux_node::JsonBuffer buffer{};
  const auto read = parse_json_message(linux_node::format_json_line(sent, buffer));
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->message.message.axes[1].sigma.in(core::rad_per_s),
            std::numeric_limits<float>::infinity());
}

TEST(JsonMessage, RefusesWhatIsNoMessage) {
  linux_node::JsonBuffer buffer{};
  const std::string line{linux_node::format_json_line(calibrated_message(1), buffer)};
  for (std::size_t length = 0; length + 2 < line.size(); ++length) {
    EXPECT_FALSE(parse_json_message(line.substr(0, length)).has_value()) << length;
  }
  std::string asleep = line;
  asleep.replace(asleep.find("\"still\""), 7, "\"sleep\"");
  EXPECT_FALSE(parse_json_message(asleep).has_value());
  EXPECT_FALSE(parse_json_message("[]").has_value());
  EXPECT_FALSE(parse_json_message("null").has_value());
}

TEST(JsonMessageOfAnOlderNode, HasNeitherTemperatureNorPulses) {
  linux_node::JsonBuffer buffer{};
  std::string line{linux_node::format_json_line(calibrated_message(1), buffer)};
  const std::string inputs = R"(,"temperature_c":null,"odometer_pulses":null)";
  line.erase(line.find(inputs), inputs.size());
  EXPECT_EQ(
      parse_json_message(line)->message,
      parse_json_message(std::string_view{buffer.data()}.substr(0, line.size() + inputs.size()))
          ->message);
  EXPECT_FALSE(parse_json_message(line)->message.message.temperature.has_value());
}

TEST(JsonMessageWithALearntModel, RoundTripsUpToRounding) {
  const wire::LearntModel sent = wire::testing::some_learnt_model();
  linux_node::JsonBuffer buffer{};
  const auto line =
      parse_json_message(linux_node::format_json_line(calibrated_message(1), buffer, {}, &sent));
  ASSERT_TRUE(line && line->learnt);
  EXPECT_EQ(line->learnt->stops(), sent.stops());
  for (std::size_t i = 0; i < 3; ++i) {
    for (const wire::LearntQuantity& quantity : wire::kLearntQuantities) {
      EXPECT_FLOAT_EQ((line->learnt->axes[i].*quantity.figure).value,
                      (sent.axes[i].*quantity.figure).value);
      EXPECT_FLOAT_EQ((line->learnt->axes[i].*quantity.figure).sigma,
                      (sent.axes[i].*quantity.figure).sigma);
    }
  }
}

TEST(JsonMessageWithALearntModelThatIsImpossible, IsRefused) {
  const wire::LearntModel learnt = wire::testing::some_learnt_model();
  linux_node::JsonBuffer buffer{};
  const std::string line{linux_node::format_json_line(calibrated_message(1), buffer, {}, &learnt)};
  for (const auto* const wrong : {"null", "-1", "\"many\"", "[]"}) {
    const std::string stops = "\"stops\":";
    const std::size_t begin = line.find(stops) + stops.size();
    std::string changed = line;
    changed.replace(begin, line.find(',', begin) - begin, wrong);
    EXPECT_FALSE(parse_json_message(changed).has_value()) << changed;
  }
}

TEST(TallyOfMessages, CountsGapsAndRestarts) {
  Tally tally;
  for (const std::uint32_t number : {7U, 8U, 11U, 0U, 1U}) {
    tally.take(calibrated_message(number));
  }
  EXPECT_EQ(tally.messages, 5U);
  EXPECT_EQ(tally.lost, 2U);
  EXPECT_EQ(tally.restarts, 1U);
  EXPECT_EQ(tally.stops, 1U) << "it never moved";
}

TEST(ScreenOfANode, ShowsRateBiasIntervalAndState) {
  const std::string screen =
      format_screen(tally_of(calibrated_message(7)), "udp 127.0.0.1:1", milliseconds{10});
  EXPECT_NE(screen.find("udp 127.0.0.1:1: 1 messages, 0 lost, 0 damaged\n"), std::string::npos);
  EXPECT_NE(screen.find("still: fine\n"), std::string::npos);
  EXPECT_EQ(screen.find("calm"), std::string::npos) << "nothing was judged";
  NumberedMessage judged = calibrated_message(7);
  judged.message.calm_percent = 83;
  EXPECT_NE(format_screen(tally_of(judged), "x", milliseconds{10}).find("newest stop: 83 % calm\n"),
            std::string::npos);
  // 0.001 deg/s are 3.6 deg/h; 95 % of a normal distribution lie within 1.96 deviations.
  EXPECT_NE(
      screen.find("x         -0.25000      +0.50000              7.06                    -\n"),
      std::string::npos)
      << screen;
}

TEST(ScreenOfANode, ShowsTheTurnSinceDepartureWithItsInterval) {
  NumberedMessage message = calibrated_message(7);
  message.message.turn[0] = {.angle = core::deg(-90.2F), .sigma = core::deg(0.5F)};
  const std::string screen = format_screen(tally_of(message), "x", milliseconds{10});
  EXPECT_NE(screen.find("7.06         -90.2 +- 1.0\n"), std::string::npos) << screen;
}

TEST(ScreenOfANode, ShowsAttitudeVibrationAndSharesOfTheBias) {
  NumberedMessage message = calibrated_message(7);
  message.message.up = core::Direction{0.0F, 0.6F, 0.8F};  // rolled by the arc tangent of 3/4
  message.message.vibration = core::standard_gravity(0.0123F);
  message.message.explained.emplace()[1].acceleration = core::deg_per_s(-0.0125F);
  const std::string screen = format_screen(tally_of(message), "x", milliseconds{10});
  EXPECT_NE(screen.find("tilt 36.9 deg (roll +36.9, pitch +0.0), vibration 0.0123 g\n"),
            std::string::npos)
      << screen;
  EXPECT_NE(screen.find("by acceleration          +0.00000     -0.01250     +0.00000\n"),
            std::string::npos)
      << screen;
  const std::string old = format_screen(tally_of(message), "x", milliseconds{3000});
  EXPECT_EQ(old.find("tilt"), std::string::npos);
  EXPECT_EQ(old.find("explained"), std::string::npos);
}

TEST(ScreenOfANode, ShowsNoOldOrMissingRate) {
  NumberedMessage message = calibrated_message(7);
  const std::string old = format_screen(tally_of(message), "x", milliseconds{3000});
  EXPECT_NE(old.find("no message for 3 s\n"), std::string::npos);
  EXPECT_EQ(old.find("-0.25"), std::string::npos);
  EXPECT_EQ(old.find("fine"), std::string::npos);

  message.message.health.sensor_fault = true;
  const std::string faulty = format_screen(tally_of(message), "x", milliseconds{0});
  EXPECT_NE(faulty.find("sensor_fault"), std::string::npos);
  EXPECT_EQ(faulty.find("-0.25"), std::string::npos);

  message = calibrated_message(7);
  message.message.health.calibrated = false;
  const std::string uncalibrated = format_screen(tally_of(message), "x", milliseconds{0});
  EXPECT_NE(uncalibrated.find("not calibrated"), std::string::npos);
  EXPECT_EQ(uncalibrated.find("0.50000"), std::string::npos);
}

TEST(ScreenOfANode, FitsOnATerminalOf80Columns) {
  NumberedMessage message = calibrated_message(1);
  for (const wire::HealthBit& bit : wire::kHealthBits) message.message.health.*bit.flag = true;
  Tally tally = tally_of(message);
  tally.status.emplace();
  tally.learnt = wire::testing::some_learnt_model();
  app::RateMessage& widest = tally.newest->message;
  widest.up = core::Direction{-0.6F, -0.64F, -0.48F};
  widest.vibration = core::standard_gravity(10.0F);
  const core::AngularRate share = core::deg_per_s(-100.0F);
  widest.explained.emplace().fill({share, share, share});
  const std::string screen = format_screen(tally, "serial /dev/ttyUSB0", milliseconds{0});
  std::istringstream lines{screen};
  for (std::string line; std::getline(lines, line);) EXPECT_LT(line.size(), 80U) << line;
  for (const wire::HealthBit& bit : wire::kHealthBits) {
    const bool is_shown = screen.find(bit.name) != std::string::npos;
    EXPECT_EQ(is_shown, bit.name != "calibrated") << bit.name;
  }
}

TEST(ScreenOfANode, ShowsWhatWasLearntOnceThereIsSomething) {
  Tally tally = tally_of(calibrated_message(7));
  tally.learnt.emplace();
  EXPECT_EQ(format_screen(tally, "x", milliseconds{0}).find("learnt"), std::string::npos);
  tally.learnt = wire::testing::some_learnt_model();
  const std::string screen = format_screen(tally, "x", milliseconds{0});
  EXPECT_NE(screen.find("learnt from 7.5 stops (+- one standard deviation):\n"), std::string::npos);
  EXPECT_NE(screen.find("x    0.600 +- 0.080            12.0 +- 2.0         0.00500 +- 0.00010\n"),
            std::string::npos)
      << screen;
}

TEST(LineOfAMessage, HasItsColumnsUnderTheHeader) {
  const std::string line = format_line(tally_of(calibrated_message(1)));
  EXPECT_EQ(line.substr(0, 20), "      1.234 still   ");
  EXPECT_EQ(line.substr(line.size() - 5), "fine\n");
  EXPECT_EQ(line.find("fine"), line_header().find("health"));
}

}  // namespace
}  // namespace zerorate::live
