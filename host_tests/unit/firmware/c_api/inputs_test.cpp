// A library that was compiled for three inputs (ZERORATE_INPUTS=3), and forces handed over in C.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "firmware/app/gyro_node.hpp"
#include "firmware/c_api/node_of_model.hpp"
#include "firmware/model/catalogue.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tests/unit/firmware/c_api/forged_model.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate {
namespace {

constexpr std::int64_t kPeriod_ns = 20'000'000;
constexpr std::int64_t kMinute = 3000;  ///< samples
constexpr float kBias_rad_s = 0.01F;
constexpr float kNoise_rad_s = 3.3e-4F;        ///< deviation of a sample, as the model has it
constexpr float kSensitivity_rad_s_g = 1e-3F;  ///< sensitivity of z to x; 0.057 deg/s

/// The model of the catalogue as the C structure, with coefficients of forces that are not known.
zerorate_model leaning_model() {
  const auto node = model::make_node_model<c_api::kShape>(model::find_model("lsm6dso"),
                                                          core::Duration::nanoseconds(kPeriod_ns),
                                                          core::Duration::milliseconds(500));
  zerorate_model model{.sample_period_ns = kPeriod_ns, .tick_ns = node.modes.tick.ns()};
  model.starts_stationary = true;
  model.is_stationary = node.modes.is_stationary;
  model.white_variance_rad2_s2 = node.white_variance_rad2_s2;
  model.turn_on_variance_rad2_s2 = node.turn_on_variance_rad2_s2;
  for (std::size_t i = 0; i < ZERORATE_DECAYING_MODES; ++i) {
    const auto& mode = node.modes.decaying[i];
    model.decaying[i] = {mode.one_minus_phi, mode.noise_variance, mode.initial_variance, 0.0F};
    if (mode.initial_variance == 0.0F) model.decaying[i] = {};
  }
  for (std::int32_t i = 0; i < 3; ++i) {
    model.inputs[i] = {.quantity = ZERORATE_ACCELERATION_X + i, .sigma = 2e-3F, .coefficient = {}};
  }
  return model;
}

/// Minutes of rest and of driving in turn; each stop leans otherwise along x.
struct Moment {
  bool stands = false;
  float force_g = 0.0F;
};
Moment moment(std::int64_t k) {
  const std::int64_t minute = k / kMinute;
  const bool stands = minute % 2 == 0;
  return {stands, stands ? 0.1F * static_cast<float>(minute % 5) - 0.2F : 0.3F};
}
zerorate_rate feed(zerorate_node& node, std::int64_t k, bool has_force) {
  const Moment now = moment(k);
  zerorate_measurement measured{.time_ns = k * kPeriod_ns};
  const random::RandomStream noise{1};
  for (std::int64_t i = 0; i < 3; ++i) {
    measured.rate_rad_s[i] =
        kBias_rad_s + kNoise_rad_s * static_cast<float>(noise.normal(3 * k + i));
  }
  measured.rate_rad_s[2] += kSensitivity_rad_s_g * now.force_g;
  if (!now.stands) {
    EXPECT_EQ(zerorate_pulse(&node, measured.time_ns), ZERORATE_OK);
  }
  zerorate_rate rate{};
  EXPECT_EQ(zerorate_sample(&node, &measured, &rate), ZERORATE_OK);
  const std::array<float, 3> force_m_s2{now.force_g * core::kStandardGravity_m_s2, 0.0F,
                                        core::kStandardGravity_m_s2};
  if (has_force) {
    EXPECT_EQ(zerorate_acceleration(&node, measured.time_ns, force_m_s2.data()), ZERORATE_OK);
  }
  return rate;
}

/// Verifies SR-IF-01.
TEST(CModelWithInputsAndOneImpossibleFigure, IsRefused) {
  zerorate_model model = leaning_model();
  model.hypothesis_count = 1;
  model.evidence_kept = 1.0F;
  c_api::testing::expect_each_impossible_figure_refused(model);
}

TEST(CInterfaceWithForces, PredictsTheBiasOfALeaningVehicle) {
  zerorate_node node{};
  const zerorate_model model = leaning_model();
  ASSERT_EQ(zerorate_init(&node, &model, nullptr), ZERORATE_OK);
  zerorate_rate rate{};
  for (std::int64_t k = 0; k < 12 * kMinute; ++k) rate = feed(node, k, true);
  EXPECT_NEAR(rate.bias_rad_s[2], kBias_rad_s + 0.3F * kSensitivity_rad_s_g, 3e-5F);
  EXPECT_NEAR(rate.bias_rad_s[0], kBias_rad_s, 3e-5F);
  EXPECT_FALSE(rate.health.acceleration_missing);
}

/// Verifies SR-INT-07, SR-HEALTH-23.
TEST(CInterfaceWithoutTheForcesOfItsModel, FlagsAndWidens) {
  zerorate_node node{};
  const zerorate_model model = leaning_model();
  ASSERT_EQ(zerorate_init(&node, &model, nullptr), ZERORATE_OK);
  zerorate_rate with{};
  for (std::int64_t k = 0; k < kMinute + kMinute / 2; ++k) with = feed(node, k, true);
  zerorate_rate without{};
  for (std::int64_t k = kMinute + kMinute / 2; k < 2 * kMinute; ++k) without = feed(node, k, false);
  EXPECT_TRUE(without.health.acceleration_missing);
  EXPECT_TRUE(without.health.usable) << "the interval is wider, and holds";
  EXPECT_GT(without.sigma_rad_s[2], 1.5F * with.sigma_rad_s[2]);
}

TEST(CInterfaceGivenImpossibleForces, RefusesThem) {
  zerorate_node node{};
  const zerorate_model model = leaning_model();
  std::array<float, 3> force{0.0F, 0.0F, 9.8F};
  EXPECT_EQ(zerorate_acceleration(&node, 0, force.data()), ZERORATE_NOT_INITIALISED);
  ASSERT_EQ(zerorate_init(&node, &model, nullptr), ZERORATE_OK);
  EXPECT_EQ(zerorate_acceleration(&node, 0, nullptr), ZERORATE_BAD_ARGUMENT);
  for (const float nonsense :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e5F}) {
    force[1] = nonsense;
    EXPECT_EQ(zerorate_acceleration(&node, 0, force.data()), ZERORATE_SAMPLE_REFUSED);
  }
}

/// Verifies SR-IF-01.
TEST(CModelWithImpossibleInputs, IsRefused) {
  zerorate_node node{};
  zerorate_model model = leaning_model();
  model.inputs[1].quantity = ZERORATE_ACCELERATION_X;
  EXPECT_EQ(zerorate_init(&node, &model, nullptr), ZERORATE_BAD_MODEL) << "twice";
  model = leaning_model();
  model.inputs[1].quantity = ZERORATE_TEMPERATURE_RATE + 1;
  EXPECT_EQ(zerorate_init(&node, &model, nullptr), ZERORATE_BAD_MODEL);
  model = leaning_model();
  model.inputs[2].sigma = -1.0F;
  EXPECT_EQ(zerorate_init(&node, &model, nullptr), ZERORATE_BAD_MODEL);
}

}  // namespace
}  // namespace zerorate
