// Messages as lines of JSON.

#include "firmware/boards/linux/outputs/json_line.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string>
#include <string_view>

#include "host_tests/support/allocation_counter.hpp"
#include "host_tests/unit/firmware/wire/messages.hpp"

namespace zerorate::linux_node {
namespace {

using wire::NumberedMessage;
using wire::testing::random_message;

NumberedMessage widest_message() {
  NumberedMessage widest{.sequence = std::numeric_limits<std::uint32_t>::max(), .message = {}};
  widest.message.time = core::Instant::from_ns(std::numeric_limits<std::int64_t>::min());
  widest.message.motion = core::Motion::settling;
  for (app::AxisRate& axis : widest.message.axes) {
    axis.measured = axis.corrected = axis.bias = axis.sigma = core::rad_per_s(-1.17549435e-38F);
  }
  for (app::AxisTurn& turn : widest.message.turn) {
    turn.angle = turn.sigma = core::rad(-1.17549435e-38F);
  }
  widest.message.turn_time = core::Duration::nanoseconds(1);
  widest.message.heading = {.angle = core::rad(-1.17549435e-38F),
                            .sigma = core::rad(-1.17549435e-38F)};
  constexpr float kWidest = -1.17549435e-38F;
  widest.message.vertical_turn = {.angle = core::rad(kWidest), .sigma = core::rad(kWidest)};
  widest.message.up = core::Direction{kWidest, kWidest, kWidest};
  widest.message.slope = core::rad(kWidest);
  widest.message.vibration = core::m_per_s2(kWidest);
  widest.message.acceleration.emplace().fill(core::m_per_s2(kWidest));
  const core::AngularRate share = core::rad_per_s(kWidest);
  widest.message.explained.emplace().fill({share, share, share});
  widest.message.temperature = core::Temperature::from_degc(-1.17549435e-38F);
  widest.message.odometer_pulses = std::numeric_limits<std::uint32_t>::max();
  return widest;
}

/// Three numbers, or null where the message has none.
template <class Element, class Figure>
void expect_list(const nlohmann::json& list, const std::optional<std::array<Element, 3>>& sent,
                 Figure figure) {
  EXPECT_EQ(list.is_null(), !sent);
  for (std::size_t i = 0; i < 3 && sent; ++i) EXPECT_EQ(list[i].get<float>(), figure((*sent)[i]));
}

TEST(JsonLineOfAnyMessage, IsOneLineOfJsonWithTheSameBits) {
  std::mt19937_64 random{6};
  JsonBuffer buffer{};
  for (int i = 0; i < 500; ++i) {
    const NumberedMessage sent = random_message(random);
    const std::string_view line = format_json_line(sent, buffer);
    ASSERT_EQ(line.find('\n'), line.size() - 1);
    const auto json = nlohmann::json::parse(line);
    EXPECT_EQ(json["sequence"], sent.sequence);
    EXPECT_EQ(json["time_ns"], sent.message.time.ns());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const app::AxisRate& rate = sent.message.axes[axis];
      EXPECT_EQ(json["bias_dps"][axis].get<float>(), rate.bias.in(core::deg_per_s));
      EXPECT_EQ(json["sigma_dps"][axis].get<float>(), rate.sigma.in(core::deg_per_s));
      EXPECT_EQ(json["rate_dps"][axis].is_null(), !sent.message.has_rate());
      if (sent.message.has_rate()) {
        EXPECT_EQ(json["rate_dps"][axis].get<float>(), rate.corrected.in(core::deg_per_s));
        EXPECT_EQ(json["measured_dps"][axis].get<float>(), rate.measured.in(core::deg_per_s));
      }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const app::AxisTurn& turn = sent.message.turn[axis];
      EXPECT_EQ(json["turn_deg"][axis].get<float>(), turn.angle.in(core::deg));
      EXPECT_EQ(json["turn_sigma_deg"][axis].get<float>(), turn.sigma.in(core::deg));
    }
    EXPECT_EQ(json["turn_s"].get<float>(), sent.message.turn_time.in_seconds());
    EXPECT_EQ(json["heading_deg"].get<float>(), sent.message.heading.angle.in(core::deg));
    EXPECT_EQ(json["heading_sigma_deg"].get<float>(), sent.message.heading.sigma.in(core::deg));
    const bool has_vertical = sent.message.up && sent.message.has_rate();
    expect_list(json["up"], sent.message.up, [](float share) { return share; });
    EXPECT_EQ(json["slope_deg"].is_null(), !sent.message.slope);
    if (sent.message.slope) {
      EXPECT_EQ(json["slope_deg"].get<float>(), sent.message.slope->in(core::deg));
    }
    EXPECT_EQ(json["vertical_turn_deg"].is_null(), !sent.message.up);
    if (sent.message.up) {
      const app::AxisTurn& turn = sent.message.vertical_turn;
      EXPECT_EQ(json["vertical_turn_deg"].get<float>(), turn.angle.in(core::deg));
      EXPECT_EQ(json["vertical_turn_sigma_deg"].get<float>(), turn.sigma.in(core::deg));
    }
    expect_list(json["acceleration_mps2"], sent.message.acceleration,
                [](core::Acceleration force) { return force.in(core::m_per_s2); });
    EXPECT_EQ(json["vibration_mps2"].is_null(), !sent.message.vibration);
    if (sent.message.vibration) {
      EXPECT_EQ(json["vibration_mps2"].get<float>(), sent.message.vibration->in(core::m_per_s2));
    }
    expect_list(json["explained_temperature_dps"], sent.message.explained,
                [](auto axis) { return axis.temperature.in(core::deg_per_s); });
    expect_list(json["explained_acceleration_dps"], sent.message.explained,
                [](auto axis) { return axis.acceleration.in(core::deg_per_s); });
    expect_list(json["explained_vibration_dps"], sent.message.explained,
                [](auto axis) { return axis.vibration.in(core::deg_per_s); });
    EXPECT_EQ(json["vertical_rate_dps"].is_null(), !has_vertical);
    if (has_vertical) {
      EXPECT_EQ(json["vertical_rate_dps"].get<float>(),
                sent.message.vertical_rate().in(core::deg_per_s));
    }
    EXPECT_EQ(json["temperature_c"].is_null(), !sent.message.temperature);
    if (sent.message.temperature) {
      EXPECT_EQ(json["temperature_c"].get<float>(), sent.message.temperature->degc());
    }
    EXPECT_EQ(json["odometer_pulses"].is_null(), !sent.message.odometer_pulses);
    if (sent.message.odometer_pulses) {
      EXPECT_EQ(json["odometer_pulses"], *sent.message.odometer_pulses);
    }
    for (const wire::HealthBit& bit : wire::kHealthBits) {
      EXPECT_EQ(json[std::string(bit.name)], sent.message.health.*bit.flag);
    }
  }
}

TEST(JsonLineOfTheWidestMessage, FitsIntoItsBufferWithoutAHeap) {
  constexpr std::string_view kLongestName = "front-left-of-the-second-machine";
  JsonBuffer buffer{};
  const NumberedMessage widest = widest_message();
  wire::LearntModel learnt;
  for (app::LearntNoise& axis : learnt.axes) {
    axis.order = axis.bias_instability_rad_s =
        axis.angle_random_walk_rad_per_sqrt_s = {1.17549435e-38F, 1.17549435e-38F};
  }
  const support::AllocationCounter allocations;
  const std::string_view line = format_json_line(widest, buffer, kLongestName, &learnt);
  EXPECT_EQ(allocations.count(), 0U);
  EXPECT_LT(line.size(), buffer.size());
  EXPECT_EQ(line.back(), '\n');
}

TEST(JsonLineWithoutCalibration, HasNoDeviation) {
  NumberedMessage sent;
  sent.message.axes[0].sigma = core::rad_per_s(std::numeric_limits<float>::infinity());
  JsonBuffer buffer{};
  const auto json = nlohmann::json::parse(format_json_line(sent, buffer));
  EXPECT_TRUE(json["sigma_dps"][0].is_null());
  EXPECT_EQ(json["sigma_dps"][1], 0.0);
}

TEST(JsonLineOfANodeWithAName, BeginsWithIt) {
  std::mt19937_64 random{6};
  JsonBuffer buffer{};
  const std::string_view line = format_json_line(random_message(random), buffer, "front");
  EXPECT_EQ(line.find("{\"node\":\"front\",\"sequence\":"), 0U);
  EXPECT_EQ(nlohmann::json::parse(line)["node"], "front");
}

}  // namespace
}  // namespace zerorate::linux_node
