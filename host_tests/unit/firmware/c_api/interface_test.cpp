#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "firmware/app/gyro_node.hpp"
#include "firmware/model/catalogue.hpp"
#include "firmware/model/node_model.hpp"
#include "firmware/model/source_headers.hpp"
#include "host_tests/support/allocation_counter.hpp"
#include "host_tests/unit/firmware/c_api/c_api_rig.hpp"

namespace zerorate::c_api {
namespace {

using testing::feed;
using testing::kDriveSamples;
using testing::kPeriod_ns;
using testing::kStopSamples;
using testing::Moment;
using testing::moment;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr std::int64_t kUtc_s = 1'790'000'000;

using Record = std::array<std::uint8_t, ZERORATE_SNAPSHOT_BYTES>;

/// An instance that has stood for a minute.
void stand(zerorate_node& node, std::uint64_t seed = 1) {
  ASSERT_EQ(zerorate_init(&node, &front_gyro, nullptr), ZERORATE_OK);
  for (std::int64_t k = 0; k < kStopSamples; ++k) feed(node, moment(k, seed));
}

Record save(zerorate_node& node, std::int64_t utc_s = kUtc_s) {
  Record record{};
  EXPECT_EQ(zerorate_save(&node, utc_s, record.data(), record.size()), ZERORATE_OK);
  return record;
}

/// Verifies SR-PRED-09.
TEST(CInterfaceOverThreeStopsAndDrives, IsTheNodeBitForBit) {
  using Node = app::GyroNode<model::kCApiShape>;
  const auto period = core::Duration::nanoseconds(kPeriod_ns);
  const Node::Params params{
      .model = model::make_node_model<model::kCApiShape>(model::find_model("lsm6dso"), period,
                                                         core::Duration::milliseconds(500))};
  Node expected{params};
  zerorate_node node;
  ASSERT_EQ(zerorate_init(&node, &front_gyro, nullptr), ZERORATE_OK);
  for (std::int64_t k = 0; k < 3 * (kStopSamples + kDriveSamples); ++k) {
    const Moment now = moment(k);
    core::GyroSample sample{.time = core::Instant::from_ns(now.measured.time_ns)};
    for (std::size_t i = 0; i < 3; ++i)
      sample.rate[i] = core::rad_per_s(now.measured.rate_rad_s[i]);
    if (!now.stands) expected.pulse(sample.time);
    const app::RateMessage message = expected.step(sample);
    const zerorate_rate rate = feed(node, now);
    ASSERT_EQ(rate.time_ns, now.measured.time_ns);
    ASSERT_EQ(rate.health.calibrated, message.health.calibrated);
    ASSERT_FALSE(rate.health.temperature_missing);  // the model does not ask for one
    ASSERT_EQ(rate.motion == ZERORATE_STILL, message.motion == core::Motion::still);
    ASSERT_EQ(rate.motion == ZERORATE_MOVING, message.motion == core::Motion::moving);
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_EQ(rate.corrected_rad_s[i], message.axes[i].corrected.in(core::rad_per_s)) << k;
      ASSERT_EQ(rate.bias_rad_s[i], message.axes[i].bias.in(core::rad_per_s)) << k;
      ASSERT_EQ(rate.sigma_rad_s[i], message.axes[i].sigma.in(core::rad_per_s)) << k;
    }
  }
}

TEST(CInterfaceAfterAStop, TellsTheNoiseThatItLearnt) {
  zerorate_node node;
  stand(node);
  zerorate_learnt_noise learnt{};
  ASSERT_EQ(zerorate_get_learnt_noise(&node, 0, &learnt), ZERORATE_OK);
  EXPECT_EQ(learnt.stops > 0.0F && learnt.stops <= 1.0F, true) << learnt.stops;
  EXPECT_GT(learnt.angle_random_walk_rad_per_sqrt_s.value, 0.0F);
  EXPECT_GT(learnt.bias_instability_rad_s.sigma, 0.0F);
  EXPECT_EQ(zerorate_get_learnt_noise(&node, 3, &learnt), ZERORATE_BAD_ARGUMENT);
  EXPECT_EQ(zerorate_get_learnt_noise(&node, 0, nullptr), ZERORATE_BAD_ARGUMENT);
}

TEST(CInterfaceToldNotToLearn, HasNothingToTell) {
  zerorate_model known = front_gyro;
  known.hypothesis_count = 0;
  zerorate_node node;
  ASSERT_EQ(zerorate_init(&node, &known, nullptr), ZERORATE_OK);
  for (std::int64_t k = 0; k < kStopSamples; ++k) feed(node, moment(k));
  zerorate_learnt_noise learnt{};
  ASSERT_EQ(zerorate_get_learnt_noise(&node, 0, &learnt), ZERORATE_OK);
  EXPECT_EQ(learnt.order.value, 0.0F);
}

/// Verifies SR-IF-01.
TEST(CInterfaceGivenAnImpossibleHypothesis, RefusesTheModel) {
  zerorate_node node;
  zerorate_model model = front_gyro;
  model.hypotheses[3].strength[2] = -1.0F;
  EXPECT_EQ(zerorate_init(&node, &model, nullptr), ZERORATE_BAD_MODEL);
  model = front_gyro;
  model.hypothesis_count = ZERORATE_HYPOTHESES + 1;
  EXPECT_EQ(zerorate_init(&node, &model, nullptr), ZERORATE_BAD_MODEL);
  model = front_gyro;
  model.evidence_kept = 0.0F;
  EXPECT_EQ(zerorate_init(&node, &model, nullptr), ZERORATE_BAD_MODEL);
}

TEST(CInterfaceWithPulses, IsTheSameAsWithTheVehiclesWord) {
  zerorate_node told;
  zerorate_node counting;
  ASSERT_EQ(zerorate_init(&told, &front_gyro, nullptr), ZERORATE_OK);
  ASSERT_EQ(zerorate_init(&counting, &front_gyro, nullptr), ZERORATE_OK);
  for (std::int64_t k = 0; k < 2 * (kStopSamples + kDriveSamples); ++k) {
    const Moment now = moment(k);
    const zerorate_rate expected = feed(told, now);
    zerorate_rate rate{};
    if (!now.stands) {
      ASSERT_EQ(zerorate_pulse(&counting, now.measured.time_ns), ZERORATE_OK);
    }
    zerorate_sample(&counting, &now.measured, &rate);
    ASSERT_EQ(rate.bias_rad_s[2], expected.bias_rad_s[2]) << k;
    ASSERT_EQ(rate.motion, expected.motion) << k;
  }
}

/// Verifies SR-IF-10.
TEST(CInterfaceInstances, DoNotKnowOfEachOther) {
  zerorate_node alone;
  zerorate_node first;
  zerorate_node second;
  ASSERT_EQ(zerorate_init(&alone, &front_gyro, nullptr), ZERORATE_OK);
  ASSERT_EQ(zerorate_init(&first, &front_gyro, nullptr), ZERORATE_OK);
  ASSERT_EQ(zerorate_init(&second, &front_gyro, nullptr), ZERORATE_OK);
  for (std::int64_t k = 0; k < kStopSamples; ++k) {
    const float expected = feed(alone, moment(k)).bias_rad_s[0];
    ASSERT_EQ(feed(first, moment(k)).bias_rad_s[0], expected);
    feed(second, moment(k, 2));
  }
  EXPECT_NE(feed(second, moment(kStopSamples)).bias_rad_s[0],
            feed(first, moment(kStopSamples)).bias_rad_s[0]);
}

/// Verifies SR-MEM-01.
TEST(CInterfaceWhileItRuns, AllocatesNothing) {
  zerorate_node node;
  const support::AllocationCounter counter;
  stand(node);
  (void)save(node);
  EXPECT_EQ(counter.count(), 0U);
}

/// Verifies SR-IF-04.
TEST(CInterfaceBeforeInit, AnswersThatItIsNotInitialised) {
  static zerorate_node node;  // zeros
  zerorate_rate rate{};
  zerorate_heading_error heading{};
  Record record{};
  const zerorate_measurement measured{};
  EXPECT_EQ(zerorate_pulse(&node, 0), ZERORATE_NOT_INITIALISED);
  EXPECT_EQ(zerorate_report_odometer_fault(&node, 0), ZERORATE_NOT_INITIALISED);
  EXPECT_EQ(zerorate_zero_velocity(&node, 0, true), ZERORATE_NOT_INITIALISED);
  EXPECT_EQ(zerorate_sample(&node, &measured, &rate), ZERORATE_NOT_INITIALISED);
  EXPECT_TRUE(std::isnan(rate.corrected_rad_s[0]));
  EXPECT_EQ(zerorate_predict_heading(&node, 0, 100, &heading), ZERORATE_NOT_INITIALISED);
  EXPECT_EQ(zerorate_save(&node, 0, record.data(), record.size()), ZERORATE_NOT_INITIALISED);
  EXPECT_EQ(zerorate_restore(&node, 0, record.data(), record.size()), ZERORATE_NOT_INITIALISED);
  EXPECT_EQ(zerorate_pulse(nullptr, 0), ZERORATE_NOT_INITIALISED);
}

/// Verifies SR-IF-04.
TEST(CInterfaceThatWasMoved, AnswersThatItIsNotInitialised) {
  auto original = std::make_unique<zerorate_node>();
  stand(*original);
  zerorate_node copy;
  std::memcpy(&copy, original.get(), sizeof copy);
  EXPECT_EQ(zerorate_pulse(&copy, 0), ZERORATE_NOT_INITIALISED);
}

/// Verifies SR-IF-03.
TEST(CInterfaceWithNullPointers, RefusesThem) {
  zerorate_node node;
  stand(node);
  zerorate_rate rate{};
  zerorate_heading_error heading{};
  const zerorate_measurement measured{};
  EXPECT_EQ(zerorate_init(nullptr, &front_gyro, nullptr), ZERORATE_BAD_ARGUMENT);
  EXPECT_EQ(zerorate_sample(&node, nullptr, &rate), ZERORATE_BAD_ARGUMENT);
  EXPECT_TRUE(std::isnan(rate.corrected_rad_s[0]));
  EXPECT_EQ(zerorate_sample(&node, &measured, nullptr), ZERORATE_BAD_ARGUMENT);
  EXPECT_EQ(zerorate_predict_heading(&node, 3, 100, &heading), ZERORATE_BAD_ARGUMENT);
  EXPECT_EQ(zerorate_predict_heading(&node, 0, 100, nullptr), ZERORATE_BAD_ARGUMENT);
  EXPECT_EQ(zerorate_save(&node, 0, nullptr, 4096), ZERORATE_BAD_ARGUMENT);
  EXPECT_EQ(zerorate_restore(&node, 0, nullptr, 4096), ZERORATE_BAD_ARGUMENT);
  EXPECT_EQ(zerorate_init(&node, nullptr, nullptr), ZERORATE_BAD_ARGUMENT);
}

/// Verifies SR-PRED-06.
TEST(CInterfaceAtALatitude, TakesTheEarthsRotationOutOfTheBias) {
  zerorate_config config = zerorate_default_config();
  zerorate_node unaware;
  ASSERT_EQ(zerorate_init(&unaware, &front_gyro, &config), ZERORATE_OK);
  config.up_axis = -2;
  config.latitude_deg = 90.0F;
  zerorate_node aware;
  ASSERT_EQ(zerorate_init(&aware, &front_gyro, &config), ZERORATE_OK);
  zerorate_rate without{};
  zerorate_rate with{};
  for (std::int64_t k = 0; k < kStopSamples; ++k) {
    without = feed(unaware, moment(k, 1));
    with = feed(aware, moment(k, 1));
  }
  EXPECT_NEAR(with.bias_rad_s[1] - without.bias_rad_s[1], 7.292e-5F, 1e-6F);
  EXPECT_NEAR(with.corrected_rad_s[1], without.corrected_rad_s[1], 1e-6F);
  EXPECT_EQ(with.bias_rad_s[0], without.bias_rad_s[0]);
}

/// Verifies SR-IF-06.
TEST(CInterfaceFedWithATimeThatNoClockShows, RefusesIt) {
  constexpr std::int64_t kCentury_ns = 3'155'760'000'000'000'000;
  zerorate_node node;
  ASSERT_EQ(zerorate_init(&node, &front_gyro, nullptr), ZERORATE_OK);
  zerorate_rate rate{};
  for (const std::int64_t time_ns : {-kCentury_ns, 2 * kCentury_ns}) {
    const zerorate_measurement measured{.time_ns = time_ns};
    EXPECT_EQ(zerorate_sample(&node, &measured, &rate), ZERORATE_BAD_ARGUMENT);
    EXPECT_EQ(zerorate_pulse(&node, time_ns), ZERORATE_BAD_ARGUMENT);
    EXPECT_EQ(zerorate_report_odometer_fault(&node, time_ns), ZERORATE_BAD_ARGUMENT);
    EXPECT_EQ(zerorate_zero_velocity(&node, time_ns, true), ZERORATE_BAD_ARGUMENT);
  }
}

/// Verifies SR-HEALTH-01, SR-HEALTH-02, SR-IF-05.
TEST(CInterfaceWithBadSamples, FlagsThemAndChangesNothing) {
  zerorate_node node;
  stand(node);
  const Moment last = moment(kStopSamples);
  const float bias = feed(node, last).bias_rad_s[0];
  zerorate_rate rate{};

  zerorate_measurement broken = moment(kStopSamples + 1).measured;
  broken.rate_rad_s[1] = kNan;
  EXPECT_EQ(zerorate_sample(&node, &broken, &rate), ZERORATE_SAMPLE_REFUSED);
  EXPECT_TRUE(rate.health.sample_refused);
  EXPECT_EQ(rate.bias_rad_s[0], bias);
  for (const float corrected : rate.corrected_rad_s) EXPECT_TRUE(std::isnan(corrected));

  EXPECT_EQ(zerorate_sample(&node, &last.measured, &rate), ZERORATE_TIME_REFUSED);
  EXPECT_TRUE(rate.health.time_refused);
  EXPECT_EQ(rate.bias_rad_s[0], bias);
  for (const float corrected : rate.corrected_rad_s) EXPECT_TRUE(std::isnan(corrected));

  zerorate_measurement saturated = moment(kStopSamples + 1).measured;
  saturated.saturated_axes = 4;
  EXPECT_EQ(zerorate_sample(&node, &saturated, &rate), ZERORATE_OK);
  EXPECT_TRUE(rate.health.saturated);
}

// 1 mrad/s a degree, known to a percent: ten degrees more move the bias by 10 mrad/s at once.
TEST(CInterfaceWithATemperature, FollowsItAndSaysWhereThereIsNone) {
  zerorate_model model = front_gyro;
  model.temperature = {
      .reference_degc = 25.0F, .slope_rad_s_per_k = 1e-3F, .slope_sigma_rad_s_per_k = 1e-5F};
  zerorate_node node;
  ASSERT_EQ(zerorate_init(&node, &model, nullptr), ZERORATE_OK);
  const auto feed_at = [&](std::int64_t k, float degc, bool has_temperature) {
    Moment now = moment(k);
    now.stands = k < kStopSamples;
    now.measured.temperature_degc = degc;
    now.measured.has_temperature = has_temperature;
    return feed(node, now);
  };
  for (std::int64_t k = 0; k < kStopSamples; ++k) feed_at(k, 25.0F, true);
  zerorate_rate rate{};
  for (std::int64_t k = 0; k < 200; ++k) rate = feed_at(kStopSamples + k, 35.0F, true);
  EXPECT_FALSE(rate.health.temperature_missing);
  EXPECT_NEAR(rate.bias_rad_s[0], testing::kBias[0] + 0.01F, 4.0F * rate.sigma_rad_s[0]);
  // A percent of 10 mrad/s, at a scale of all variances that is known to a fifth.
  EXPECT_GT(rate.sigma_rad_s[0], 0.9e-4F);
  for (std::int64_t k = 200; k < 2000; ++k) rate = feed_at(kStopSamples + k, 0.0F, false);
  EXPECT_TRUE(rate.health.temperature_missing);
}

/// Verifies SR-HEALTH-06.
TEST(CInterfaceWhoseInputLostPulses, SaysSoOnce) {
  zerorate_node node;
  stand(node);
  ASSERT_EQ(zerorate_report_odometer_fault(&node, kStopSamples * kPeriod_ns), ZERORATE_OK);
  EXPECT_TRUE(feed(node, moment(kStopSamples)).health.odometer_fault);
  EXPECT_FALSE(feed(node, moment(kStopSamples + 1)).health.odometer_fault);
}

/// Verifies SR-INT-05.
TEST(CInterfaceAskedForAHeading, WidensItWithTheDriveAndNeedsAStop) {
  zerorate_node node;
  zerorate_heading_error minute{};
  zerorate_heading_error hour{};
  ASSERT_EQ(zerorate_init(&node, &front_gyro, nullptr), ZERORATE_OK);
  EXPECT_EQ(zerorate_predict_heading(&node, 2, 6000, &minute), ZERORATE_NOTHING_LEARNT);
  stand(node);
  ASSERT_EQ(zerorate_predict_heading(&node, 2, 6000, &minute), ZERORATE_OK);
  ASSERT_EQ(zerorate_predict_heading(&node, 2, 360'000, &hour), ZERORATE_OK);
  EXPECT_NEAR(minute.angle_rad, testing::kBias[2] * 60.0F, 4.0F * minute.sigma_rad);
  EXPECT_GT(hour.sigma_rad, 60.0F * minute.sigma_rad);  // the bias does not stay where it is
}

/// Verifies SR-SNAP-02.
TEST(CInterfaceRestored, GoesOnWithTheBiasAndAWiderInterval) {
  zerorate_node node;
  stand(node);
  const zerorate_rate before = feed(node, moment(kStopSamples));
  const Record record = save(node);
  zerorate_node restarted;
  ASSERT_EQ(zerorate_init(&restarted, &front_gyro, nullptr), ZERORATE_OK);
  ASSERT_EQ(zerorate_restore(&restarted, kUtc_s + 10, record.data(), record.size()), ZERORATE_OK);
  const zerorate_rate after = feed(restarted, moment(kStopSamples));
  EXPECT_TRUE(after.health.calibrated);
  // The loss of ten seconds is smaller than the uncertainty before.
  EXPECT_NEAR(after.bias_rad_s[0], before.bias_rad_s[0], before.sigma_rad_s[0]);
  EXPECT_GT(after.sigma_rad_s[0], before.sigma_rad_s[0]);
}

/// Verifies SR-SNAP-04.
TEST(CInterfaceOfferedAWrongRecord, ReportsItAndStartsAnew) {
  zerorate_node node;
  stand(node);
  const Record good = save(node);
  const auto refusal = [&](const Record& record, std::size_t size, const zerorate_model& model,
                           std::uint32_t sensor) {
    zerorate_node restarted;
    zerorate_config config = zerorate_default_config();
    config.sensor_id = sensor;
    EXPECT_EQ(zerorate_init(&restarted, &model, &config), ZERORATE_OK);
    const zerorate_result result = zerorate_restore(&restarted, kUtc_s, record.data(), size);
    EXPECT_FALSE(feed(restarted, moment(0)).health.calibrated);
    return result;
  };
  EXPECT_EQ(refusal(good, 10, front_gyro, 0), ZERORATE_SNAPSHOT_NOT_OURS);
  EXPECT_EQ(refusal(Record{}, good.size(), front_gyro, 0), ZERORATE_SNAPSHOT_NOT_OURS);
  for (std::size_t byte = 4; byte < good.size(); byte += 37) {
    Record damaged = good;
    damaged[byte] ^= 0x10U;
    EXPECT_EQ(refusal(damaged, damaged.size(), front_gyro, 0), ZERORATE_SNAPSHOT_DAMAGED) << byte;
  }
  EXPECT_EQ(refusal(good, good.size(), front_gyro, 7), ZERORATE_SNAPSHOT_SENSOR);
  zerorate_model other = front_gyro;
  other.turn_on_variance_rad2_s2 = ZERORATE_UNKNOWN_VARIANCE;
  zerorate_node unknown;
  ASSERT_EQ(zerorate_init(&unknown, &other, nullptr), ZERORATE_OK);
  for (std::int64_t k = 0; k < kStopSamples; ++k) feed(unknown, moment(k));
  EXPECT_EQ(refusal(save(unknown), good.size(), other, 0), ZERORATE_SNAPSHOT_NOT_USABLE);
}

/// Verifies SR-SNAP-07.
TEST(CInterfaceOfferedARecordOfAnotherModel, GoesOnWithTheBias) {
  zerorate_node node;
  stand(node);
  const Record record = save(node);
  zerorate_model other = front_gyro;
  other.white_variance_rad2_s2 *= 2.0F;
  zerorate_node restarted;
  ASSERT_EQ(zerorate_init(&restarted, &other, nullptr), ZERORATE_OK);
  EXPECT_EQ(zerorate_restore(&restarted, kUtc_s, record.data(), record.size()), ZERORATE_OK);
  EXPECT_TRUE(feed(restarted, moment(0)).health.calibrated);
}

/// Verifies SR-SNAP-08.
TEST(CInterfaceSaving, NeedsRoomAndAStop) {
  zerorate_node node;
  Record record{};
  ASSERT_EQ(zerorate_init(&node, &front_gyro, nullptr), ZERORATE_OK);
  EXPECT_EQ(zerorate_save(&node, kUtc_s, record.data(), record.size() - 1),
            ZERORATE_BUFFER_TOO_SMALL);
  EXPECT_EQ(zerorate_save(&node, kUtc_s, record.data(), record.size()), ZERORATE_NOTHING_LEARNT);
  stand(node);
  record = save(node);
  EXPECT_EQ(zerorate_restore(&node, kUtc_s, record.data(), record.size()), ZERORATE_TOO_LATE);
}

}  // namespace
}  // namespace zerorate::c_api
