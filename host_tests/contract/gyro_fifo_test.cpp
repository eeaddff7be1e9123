/// @file
/// Promises of drivers/common about samples that wait in a chip's FIFO.

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "host_tests/contract/any_gyro.hpp"

namespace zerorate::contract {
namespace {

using core::deg_per_s;
using core::GyroSample;
using drivers::DriverErrorCode;

class GyroFifo : public ::testing::TestWithParam<AnyGyro> {
 protected:
  void SetUp() override { ASSERT_TRUE(rig_->start_and_settle()); }

  /// Samples whose x rate counts up from `first` in steps of `step_dps`.
  void sample(int count, float first_dps = 0.0F, float step_dps = 1.0F) {
    for (int i = 0; i < count; ++i) {
      rig_->sample({deg_per_s(first_dps + step_dps * static_cast<float>(i)), {}, {}});
    }
  }

  std::unique_ptr<AnyRig> rig_ = GetParam().rig(kFifo);
};
INSTANTIATE_TEST_SUITE_P(Every, GyroFifo, ::testing::ValuesIn(gyros_with_fifo()), name_of);

TEST_P(GyroFifo, GivesTheSamplesOldestFirstAndOnePeriodApart) {
  sample(30, 1.0F);
  std::array<GyroSample, 64> out{};
  ASSERT_EQ(rig_->read(out).value_or(0), 30U);
  for (int i = 0; i < 30; ++i) {
    const GyroSample& sample = out[static_cast<std::size_t>(i)];
    EXPECT_NEAR(sample.rate[0].in(deg_per_s), static_cast<float>(i + 1), 0.005F);
    EXPECT_EQ(sample.time, rig_->clock().now() - rig_->sample_period() * (29 - i));
  }
}

TEST_P(GyroFifo, KeepsWhatDoesNotFitIntoTheBuffer) {
  sample(5);
  std::array<GyroSample, 2> out{};
  for (int first = 0; first < 4; first += 2) {
    ASSERT_EQ(rig_->read(out).value_or(0), 2U);
    for (int i = 0; i < 2; ++i) {
      const GyroSample& sample = out[static_cast<std::size_t>(i)];
      EXPECT_NEAR(sample.rate[0].in(deg_per_s), static_cast<float>(first + i), 0.005F);
      EXPECT_EQ(sample.time, rig_->clock().now() - rig_->sample_period() * (4 - first - i));
    }
  }
  EXPECT_EQ(rig_->read(out).value_or(0), 1U);
  EXPECT_EQ(rig_->read(out).value_or(9), 0U);
}

TEST_P(GyroFifo, RaisesThePinAtTheWatermark) {
  if (!GetParam().has_watermark) GTEST_SKIP() << "the chip has no watermark";
  sample(2);
  EXPECT_FALSE(rig_->interrupt()->take_edge());
  sample(1);
  EXPECT_EQ(rig_->interrupt()->take_edge(), rig_->clock().now());
}

TEST_P(GyroFifo, ReportsAnOverrunOnceAndGoesOn) {
  sample(static_cast<int>(GetParam().fifo_capacity) + 7);
  std::array<GyroSample, 16> out{};
  const auto overrun = rig_->read(out);
  ASSERT_FALSE(overrun);
  EXPECT_EQ(overrun.error().code, DriverErrorCode::fifo_overrun);
  sample(1, 77.0F);  // the chip goes on, and the FIFO overflows again
  const std::vector<GyroSample> all = rig_->read_all();
  ASSERT_FALSE(all.empty());
  EXPECT_NEAR(all.back().rate[0].in(deg_per_s), 77.0F, 0.005F);
  EXPECT_EQ(all.back().time, rig_->clock().now());
  sample(1, 78.0F);
  EXPECT_EQ(rig_->read(out).value_or(0), 1U);
}

TEST_P(GyroFifo, StampsNeverRunBackwardsOverAnOverrun) {
  core::Instant last{};
  for (int round = 0; round < 3; ++round) {
    sample(10);
    for (const GyroSample& sample : rig_->read_all()) {
      EXPECT_GT(sample.time, last);
      last = sample.time;
    }
    sample(static_cast<int>(GetParam().fifo_capacity) + 1);
    std::array<GyroSample, 16> out{};
    ASSERT_FALSE(rig_->read(out));
    for (const GyroSample& sample : rig_->read_all()) {
      EXPECT_GT(sample.time, last);
      last = sample.time;
    }
  }
}

TEST_P(GyroFifo, StampsAreEvenHoweverUnevenlyItIsRead) {
  // The first reading comes with a sample and so gives the stamps their phase; the others come
  // after 1 to 9 samples and up to nine tenths of a period late.
  const core::Duration period = rig_->sample_period();
  core::Instant converted = rig_->clock().now();
  std::vector<GyroSample> all;
  for (int reading = 0; reading < 50; ++reading) {
    const int count = 1 + reading * 5 % 9;
    for (int i = 0; i < count; ++i) {
      converted = converted + period;
      rig_->clock().advance_to(converted);
      rig_->measure({}, {});
    }
    rig_->clock().advance(period * (reading * 7 % 10) / 10);
    const std::vector<GyroSample> batch = rig_->read_all();
    ASSERT_EQ(batch.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(batch.back().time, converted);
    all.insert(all.end(), batch.begin(), batch.end());
  }
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_EQ(all[i].time - all[i - 1].time, period) << i;
  }
}

TEST_P(GyroFifo, StampsOfATooFastChipNeverRunBackwards) {
  const core::Duration fast = rig_->sample_period() * 97 / 100;
  core::Instant last{};
  for (int batch = 0; batch < 10; ++batch) {
    for (int i = 0; i < 30; ++i) {
      rig_->clock().advance(fast);
      rig_->measure({}, {});
    }
    const std::vector<GyroSample> samples = rig_->read_all();
    ASSERT_EQ(samples.size(), 30U);
    for (const GyroSample& sample : samples) {
      EXPECT_GT(sample.time, last);
      last = sample.time;
    }
    EXPECT_EQ(last, rig_->clock().now());
  }
}

}  // namespace
}  // namespace zerorate::contract
