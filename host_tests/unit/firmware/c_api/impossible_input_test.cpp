#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "host_tests/unit/firmware/c_api/c_api_rig.hpp"

namespace zerorate::c_api {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(CInterfaceWithAModelThatCannotBe, RefusesItAndStaysUninitialised) {
  const std::vector<std::pair<zerorate_result, std::function<void(zerorate_model&)>>> defects = {
      {ZERORATE_BAD_MODEL, [](auto& m) { m.white_variance_rad2_s2 = 0.0F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.white_variance_rad2_s2 = kNan; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.walk_variance_rad2_s2 = -1e-9F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.measurement_floor_variance_rad2_s2 = kNan; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.turn_on_variance_rad2_s2 = -0.5F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.gate_threshold_sigma = kNan; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.decaying[0].one_minus_phi = 1.5F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.decaying[0].one_minus_phi = 0.0F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.decaying[0].noise_variance = kNan; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.decaying[0].initial_mean = kNan; }},
      {ZERORATE_BAD_MODEL,
       [](auto& m) {
         m.rotating[0].one_minus_phi = {2.5F, 0.0F};
       }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.rotating[0].initial_variance = -1.0F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.temperature.slope_sigma_rad_s_per_k = -1.0F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.temperature.reference_degc = kNan; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.temperature.reference_degc = 1e7F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.white_variance_rad2_s2 = 1e7F; }},
      {ZERORATE_BAD_TIMES, [](auto& m) { m.tick_ns = 0; }},
      {ZERORATE_BAD_TIMES, [](auto& m) { m.sample_period_ns = -1; }},
      {ZERORATE_BAD_TIMES, [](auto& m) { m.tick_ns = m.sample_period_ns / 2; }},
  };
  for (std::size_t i = 0; i < defects.size(); ++i) {
    zerorate_model model = front_gyro;
    defects[i].second(model);
    zerorate_node node;
    EXPECT_EQ(zerorate_init(&node, &model, nullptr), defects[i].first) << "defect " << i;
    EXPECT_EQ(zerorate_pulse(&node, 0), ZERORATE_NOT_INITIALISED) << "defect " << i;
  }
}

TEST(CInterfaceWithTimesThatCannotBe, RefusesThem) {
  zerorate_node node;
  zerorate_config config = zerorate_default_config();
  config.settle_ns = -1;
  EXPECT_EQ(zerorate_init(&node, &front_gyro, &config), ZERORATE_BAD_TIMES);
  config = zerorate_default_config();
  config.hold_back_ns = 3'600'000'000'000;
  EXPECT_EQ(zerorate_init(&node, &front_gyro, &config), ZERORATE_BAD_TIMES);
  zerorate_model model = front_gyro;
  model.sample_period_ns = model.tick_ns = 3'600'000'000'001;
  EXPECT_EQ(zerorate_init(&node, &model, nullptr), ZERORATE_BAD_TIMES);
}

TEST(CInterfaceAtAPlaceThatCannotBe, RefusesIt) {
  zerorate_node node;
  for (const auto& [up_axis, latitude_deg] :
       {std::pair{4, 0.0F}, {-4, 0.0F}, {3, 90.1F}, {3, -90.1F}, {3, kNan}}) {
    zerorate_config config = zerorate_default_config();
    config.up_axis = static_cast<std::int8_t>(up_axis);
    config.latitude_deg = latitude_deg;
    EXPECT_EQ(zerorate_init(&node, &front_gyro, &config), ZERORATE_BAD_ARGUMENT) << latitude_deg;
  }
}

TEST(CInterfaceAskedForAHeadingBeyondItsClock, RefusesIt) {
  zerorate_model model = front_gyro;
  model.sample_period_ns = model.tick_ns = 3'600'000'000'000;
  zerorate_node node;
  ASSERT_EQ(zerorate_init(&node, &model, nullptr), ZERORATE_OK);
  zerorate_heading_error error{};
  EXPECT_EQ(zerorate_predict_heading(&node, 0, 1'000'000, &error), ZERORATE_NOTHING_LEARNT);
  EXPECT_EQ(zerorate_predict_heading(&node, 0, 2'000'000, &error), ZERORATE_BAD_ARGUMENT);
}

}  // namespace
}  // namespace zerorate::c_api
