#include "host_tools/lib/evaluate/replay_node.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/model/node_model.hpp"
#include "host_tests/support/made_recording.hpp"

namespace zerorate::evaluate {
namespace {

core::GyroSample sample_of(const recording::Row& row) {
  constexpr core::Duration kPeriod = core::Duration::milliseconds(10);
  ReplayNode<model::kLargestLearningShape> node{
      {.model = testing::sensor_model()}, {.odometer = true}, {kPeriod, kPeriod}, row.time_ns};
  return node.arrive(row).sample;
}

TEST(RowWithAnAcceleration, GivesItToTheNode) {
  const core::GyroSample sample = sample_of({.acceleration_m_s2 = {0.5F, -9.75F, 0.25F}});
  EXPECT_TRUE(sample.has_acceleration);
  EXPECT_EQ(sample.acceleration[0].in(core::m_per_s2), 0.5F);
  EXPECT_EQ(sample.acceleration[1].in(core::m_per_s2), -9.75F);
  EXPECT_EQ(sample.acceleration[2].in(core::m_per_s2), 0.25F);
}

TEST(RowWithAPartOfTheAcceleration, GivesNoneToTheNode) {
  EXPECT_FALSE(sample_of({}).has_acceleration);
  EXPECT_FALSE(sample_of({.acceleration_m_s2 = {0.5F, NAN, 0.25F}}).has_acceleration);
  EXPECT_FALSE(sample_of({.acceleration_m_s2 = {INFINITY, 0.0F, 0.25F}}).has_acceleration);
}

}  // namespace
}  // namespace zerorate::evaluate
