/// @file
/// Promises of drivers/common about samples that wait in a chip's FIFO.

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "host_tests/contract/gyro_wirings.hpp"

namespace zerorate::contract {
namespace {

using core::deg_per_s;
using core::GyroSample;
using drivers::DriverErrorCode;

template <class Wiring>
class GyroFifo : public ::testing::Test {
 protected:
  using Gyro = typename Wiring::Gyro;

  GyroFifo() { started_ = rig_.start_and_settle().has_value(); }
  void SetUp() override { ASSERT_TRUE(started_); }

  /// Samples whose x rate counts up from `first` in steps of `step_dps`.
  void sample(int count, float first_dps = 0.0F, float step_dps = 1.0F) {
    for (int i = 0; i < count; ++i) {
      rig_.sample({deg_per_s(first_dps + step_dps * static_cast<float>(i)), {}, {}});
    }
  }
  /// Reads until there is no more, into buffers of 16 samples as the node's loop does.
  std::vector<GyroSample> read_all() {
    std::vector<GyroSample> all;
    std::array<GyroSample, 16> out{};
    std::size_t count = out.size();
    while (count == out.size()) {
      count = rig_.read(out).value_or(0);
      all.insert(all.end(), out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count));
    }
    return all;
  }

  support::GyroRig<Wiring> rig_{Gyro::kFifo};
  bool started_ = false;
};
TYPED_TEST_SUITE(GyroFifo, GyrosWithFifo, WiringName);

TYPED_TEST(GyroFifo, GivesTheSamplesOldestFirstAndOnePeriodApart) {
  this->sample(30, 1.0F);
  std::array<GyroSample, 64> out{};
  ASSERT_EQ(this->rig_.read(out).value_or(0), 30U);
  for (int i = 0; i < 30; ++i) {
    const GyroSample& sample = out[static_cast<std::size_t>(i)];
    EXPECT_NEAR(sample.rate[0].in(deg_per_s), static_cast<float>(i + 1), 0.005F);
    EXPECT_EQ(sample.time, this->rig_.clock.now() - this->rig_.driver.sample_period() * (29 - i));
  }
}

TYPED_TEST(GyroFifo, KeepsWhatDoesNotFitIntoTheBuffer) {
  this->sample(5);
  std::array<GyroSample, 2> out{};
  for (int first = 0; first < 4; first += 2) {
    ASSERT_EQ(this->rig_.read(out).value_or(0), 2U);
    for (int i = 0; i < 2; ++i) {
      const GyroSample& sample = out[static_cast<std::size_t>(i)];
      EXPECT_NEAR(sample.rate[0].in(deg_per_s), static_cast<float>(first + i), 0.005F);
      EXPECT_EQ(sample.time,
                this->rig_.clock.now() - this->rig_.driver.sample_period() * (4 - first - i));
    }
  }
  EXPECT_EQ(this->rig_.read(out).value_or(0), 1U);
  EXPECT_EQ(this->rig_.read(out).value_or(9), 0U);
}

TYPED_TEST(GyroFifo, RaisesThePinAtTheWatermark) {
  if (!TypeParam::Gyro::kHasWatermark) GTEST_SKIP() << "the chip has no watermark";
  this->sample(2);
  EXPECT_FALSE(this->rig_.chip.interrupt().take_edge());
  this->sample(1);
  EXPECT_EQ(this->rig_.chip.interrupt().take_edge(), this->rig_.clock.now());
}

TYPED_TEST(GyroFifo, ReportsAnOverrunOnceAndGoesOn) {
  constexpr int kCapacity = static_cast<int>(TypeParam::Gyro::kFifoCapacity);
  this->sample(kCapacity + 7);
  std::array<GyroSample, 16> out{};
  const auto overrun = this->rig_.read(out);
  ASSERT_FALSE(overrun);
  EXPECT_EQ(overrun.error().code, DriverErrorCode::fifo_overrun);
  this->sample(1, 77.0F);  // the chip goes on, and the FIFO overflows again
  const std::vector<GyroSample> all = this->read_all();
  ASSERT_FALSE(all.empty());
  EXPECT_NEAR(all.back().rate[0].in(deg_per_s), 77.0F, 0.005F);
  EXPECT_EQ(all.back().time, this->rig_.clock.now());
  this->sample(1, 78.0F);
  EXPECT_EQ(this->rig_.read(out).value_or(0), 1U);
}

TYPED_TEST(GyroFifo, StampsNeverRunBackwardsOverAnOverrun) {
  core::Instant last{};
  for (int round = 0; round < 3; ++round) {
    this->sample(10);
    for (const GyroSample& sample : this->read_all()) {
      EXPECT_GT(sample.time, last);
      last = sample.time;
    }
    this->sample(static_cast<int>(TypeParam::Gyro::kFifoCapacity) + 1);
    std::array<GyroSample, 16> out{};
    ASSERT_FALSE(this->rig_.read(out));
    for (const GyroSample& sample : this->read_all()) {
      EXPECT_GT(sample.time, last);
      last = sample.time;
    }
  }
}

TYPED_TEST(GyroFifo, StampsAreEvenHoweverUnevenlyItIsRead) {
  // The first reading comes with a sample and so gives the stamps their phase; the others come
  // after 1 to 9 samples and up to nine tenths of a period late.
  const core::Duration period = this->rig_.driver.sample_period();
  core::Instant converted = this->rig_.clock.now();
  std::vector<GyroSample> all;
  for (int reading = 0; reading < 50; ++reading) {
    const int count = 1 + reading * 5 % 9;
    for (int i = 0; i < count; ++i) {
      converted = converted + period;
      this->rig_.clock.advance_to(converted);
      this->rig_.chip.measure({}, {});
    }
    this->rig_.clock.advance(period * (reading * 7 % 10) / 10);
    const std::vector<GyroSample> batch = this->read_all();
    ASSERT_EQ(batch.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(batch.back().time, converted);
    all.insert(all.end(), batch.begin(), batch.end());
  }
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_EQ(all[i].time - all[i - 1].time, period) << i;
  }
}

TYPED_TEST(GyroFifo, StampsOfATooFastChipNeverRunBackwards) {
  const core::Duration fast = this->rig_.driver.sample_period() * 97 / 100;
  core::Instant last{};
  for (int batch = 0; batch < 10; ++batch) {
    for (int i = 0; i < 30; ++i) {
      this->rig_.clock.advance(fast);
      this->rig_.chip.measure({}, {});
    }
    const std::vector<GyroSample> samples = this->read_all();
    ASSERT_EQ(samples.size(), 30U);
    for (const GyroSample& sample : samples) {
      EXPECT_GT(sample.time, last);
      last = sample.time;
    }
    EXPECT_EQ(last, this->rig_.clock.now());
  }
}

}  // namespace
}  // namespace zerorate::contract
