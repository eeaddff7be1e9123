#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "host_tests/support/checksum.hpp"
#include "host_tests/unit/firmware/c_api/c_api_rig.hpp"
#include "host_tests/unit/firmware/c_api/forged_model.hpp"

namespace zerorate::c_api {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Verifies SR-IF-01.
TEST(CInterfaceWithAModelThatCannotBe, StaysUninitialised) {
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
      {ZERORATE_BAD_MODEL, [](auto& m) { m.temperature.slope_sigma_rad_s_per_k = 1e4F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.temperature.curvature_rad_s_per_k2 = -1e4F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.largest_bias_rad_s = -1.0F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.scale_factor_error[2] = 0.2F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.slope_variance_rad2 = -1e-6F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.scale_factor_sigma_per_k = -1e-4F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.scale_factor_at_k = 600.0F; }},
      {ZERORATE_BAD_MODEL, [](auto& m) { m.scale_factor_error[0] = -0.2F; }},
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

/// Verifies SR-IF-01.
TEST(CInterfaceWithOneImpossibleFigure, RefusesTheModel) {
  testing::expect_each_impossible_figure_refused(front_gyro);
}

/// Verifies SR-IF-02.
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

/// Verifies SR-IF-02.
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

/// Verifies SR-IF-02.
TEST(CInterfaceGivenAChoiceThatThereIsNot, RefusesIt) {
  zerorate_node node;
  for (const std::int32_t choice : {-1, 3, 9, 77, 256}) {
    zerorate_config config = zerorate_default_config();
    config.predictor = choice;
    EXPECT_EQ(zerorate_init(&node, &front_gyro, &config), ZERORATE_BAD_ARGUMENT) << choice;
    config = zerorate_default_config();
    config.standstill = choice == ZERORATE_BY_WORD ? ZERORATE_BY_WORD + 1 : choice;
    EXPECT_EQ(zerorate_init(&node, &front_gyro, &config), ZERORATE_BAD_ARGUMENT) << choice;
  }
  for (const std::int32_t choice : {0, 1, 2}) {
    zerorate_config config = zerorate_default_config();
    config.predictor = config.standstill = choice;
    EXPECT_EQ(zerorate_init(&node, &front_gyro, &config), ZERORATE_OK) << choice;
  }
}

TEST(CInterfaceToldOfAnAxisThatThereIsNot, RefusesTheSample) {
  zerorate_node node;
  ASSERT_EQ(zerorate_init(&node, &front_gyro, nullptr), ZERORATE_OK);
  zerorate_rate rate{};
  const zerorate_measurement measured{.saturated_axes = 1U << ZERORATE_AXES};
  EXPECT_EQ(zerorate_sample(&node, &measured, &rate), ZERORATE_BAD_ARGUMENT);
}

/// A compiler with -fshort-enums reads and writes the same bytes: test foreign.makefile.
/// Verifies SR-IF-08.
TEST(CInterfaceEnumerations, AreOf32Bits) {
  static_assert(sizeof(zerorate_result) == 4 && sizeof(zerorate_predictor) == 4);
  static_assert(sizeof(zerorate_motion) == 4 && sizeof(zerorate_standstill) == 4);
  EXPECT_EQ(offsetof(zerorate_rate, health), 12U);
}

/// Verifies SR-SNAP-06.
TEST(CInterfaceGivenAForgedRecord, RefusesItOrPublishesNumbers) {
  static zerorate_node learnt;
  ASSERT_EQ(zerorate_init(&learnt, &front_gyro, nullptr), ZERORATE_OK);
  for (std::int64_t k = 0; k < testing::kStopSamples; ++k) {
    (void)testing::feed(learnt, testing::moment(k));
  }
  std::vector<std::uint8_t> good(ZERORATE_SNAPSHOT_BYTES);
  ASSERT_EQ(zerorate_save(&learnt, 0, good.data(), good.size()), ZERORATE_OK);
  constexpr std::size_t kHeader = 64;
  std::mt19937 random(11);
  std::uniform_int_distribution<std::size_t> place(kHeader, good.size() - 5);
  std::uniform_int_distribution<int> byte(0, 255);
  static zerorate_node node;
  for (int record = 0; record < 1000; ++record) {
    auto forged = good;
    for (int change = 0; change <= record % 8; ++change) {
      forged[place(random)] = static_cast<std::uint8_t>(byte(random));
    }
    zerorate::testing::put_checksum(forged);
    ASSERT_EQ(zerorate_init(&node, &front_gyro, nullptr), ZERORATE_OK);
    const zerorate_result result = zerorate_restore(&node, 60, forged.data(), forged.size());
    ASSERT_TRUE(result == ZERORATE_OK || result == ZERORATE_SNAPSHOT_DAMAGED) << result;
    if (result != ZERORATE_OK) continue;
    for (std::int64_t k = 0; k < 100; ++k) {
      const zerorate_rate rate = testing::feed(node, testing::moment(k));
      for (std::size_t i = 0; i < ZERORATE_AXES; ++i) {
        ASSERT_TRUE(std::isfinite(rate.bias_rad_s[i])) << record;
        ASSERT_TRUE(std::isfinite(rate.sigma_rad_s[i]) && rate.sigma_rad_s[i] >= 0.0F) << record;
      }
    }
  }
}

// The bytes of an instance in a buffer that a cast made of bytes.
/// Verifies SR-IF-04.
TEST(CInterfaceWithStorageAtAnOddAddress, RefusesIt) {
  alignas(zerorate_node) static std::array<std::uint8_t, sizeof(zerorate_node) + 8> aligned;
  auto* odd = static_cast<zerorate_node*>(static_cast<void*>(aligned.data() + 1));
  EXPECT_EQ(zerorate_init(odd, &front_gyro, nullptr), ZERORATE_BAD_ARGUMENT);
  EXPECT_EQ(zerorate_pulse(odd, 0), ZERORATE_NOT_INITIALISED);
}

TEST(CInterfaceAskedForAHeadingBeyondItsClock, RefusesIt) {
  zerorate_model model = front_gyro;
  model.sample_period_ns = model.tick_ns = 3'600'000'000'000;
  zerorate_node node;
  ASSERT_EQ(zerorate_init(&node, &model, nullptr), ZERORATE_OK);
  zerorate_heading_error error{};
  EXPECT_EQ(zerorate_predict_heading(&node, 0, 1'000'000, &error), ZERORATE_NOTHING_LEARNT);
  EXPECT_EQ(zerorate_predict_heading(&node, 0, 2'000'000, &error), ZERORATE_BAD_ARGUMENT);
  EXPECT_EQ(zerorate_predict_heading(&node, 0, 0, &error), ZERORATE_BAD_ARGUMENT);
}

}  // namespace
}  // namespace zerorate::c_api
