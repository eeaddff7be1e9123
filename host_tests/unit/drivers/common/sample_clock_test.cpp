#include "drivers/common/sample_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace zerorate::drivers {
namespace {

constexpr core::Duration kPeriod = core::Duration::milliseconds(10);

constexpr core::Instant at_us(std::int64_t us) {
  return core::Instant{} + core::Duration::microseconds(us);
}

/// A chip whose k-th sample comes at (k + 0.3) true periods, read at random times.
struct Chip {
  core::Duration true_period;
  std::mt19937 random{7};
  core::Instant now;
  std::int64_t read_samples = 0;
  SampleClock clock;

  explicit Chip(double slower)
      : true_period(core::Duration::nanoseconds(std::llround(1e7 * slower))) {
    clock.restart(now, kPeriod);
  }
  [[nodiscard]] core::Instant true_time(std::int64_t sample) const {
    return core::Instant{} + true_period * sample + true_period * 3 / 10;
  }

  /// Waits for 20 to 80 ms, reads, and gives each stamp and the time when it was true.
  std::vector<std::pair<core::Instant, core::Instant>> read_batch() {
    std::uniform_int_distribution<std::int64_t> wait_us{20'000, 80'000};
    now = now + core::Duration::microseconds(wait_us(random));
    std::vector<std::pair<core::Instant, core::Instant>> stamps;
    std::int64_t last = read_samples;
    while (true_time(last) <= now) ++last;
    clock.begin_batch(now, static_cast<std::size_t>(last - read_samples));
    for (; read_samples < last; ++read_samples) {
      stamps.emplace_back(clock.next(), true_time(read_samples));
    }
    return stamps;
  }
};

TEST(StampsOfAChipThatKeepsItsPeriod, AreExactlyOnePeriodApartWheneverItIsRead) {
  Chip chip{1.0};
  for (int i = 0; i < 200; ++i) chip.read_batch();  // readings soon after a sample set the phase
  core::Instant last = chip.read_batch().back().first;
  for (int i = 0; i < 200; ++i) {
    for (const auto& [stamp, true_time] : chip.read_batch()) {
      EXPECT_EQ(stamp - last, kPeriod);
      last = stamp;
    }
  }
}

TEST(StampsOfAChipThatKeepsItsPeriod, ComeNearTheTruth) {
  Chip chip{1.0};
  for (int i = 0; i < 200; ++i) chip.read_batch();
  const auto [stamp, true_time] = chip.read_batch().back();
  // The phase is set by the reading that came soonest after a sample. The waits are a multiple of
  // the period plus something uniform in it, so of 200 the soonest is later than 1 ms with a
  // probability of 0.9^200 = 7e-10.
  EXPECT_GE(stamp, true_time);
  EXPECT_LT(stamp - true_time, core::Duration::milliseconds(1));
}

TEST(StampsOfAChipThatIsOff, StayWithinOnePeriodOfTheTruthAndNeverRunBackwards) {
  for (const double slower : {0.97, 0.999, 1.001, 1.03}) {
    Chip chip{slower};
    core::Instant last;
    for (int i = 0; i < 2000; ++i) {
      for (const auto& [stamp, true_time] : chip.read_batch()) {
        EXPECT_GT(stamp, last);
        // A batch holds at most nine samples, and the rate is at most 3 % off: the samples of a
        // batch move against its newest by 0.27 periods at most.
        EXPECT_LT(stamp - true_time, kPeriod * 13 / 10) << slower;
        EXPECT_LT(true_time - stamp, kPeriod * 13 / 10) << slower;
        last = stamp;
      }
      EXPECT_LE(last, chip.now);
    }
  }
}

TEST(StampsOfTheFirstBatch, EndAtTheReadingAndGoBackByThePeriod) {
  SampleClock clock;
  clock.restart(at_us(0), kPeriod);
  clock.begin_batch(at_us(50'000), 3);
  EXPECT_EQ(clock.next(), at_us(30'000));
  EXPECT_EQ(clock.next(), at_us(40'000));
  EXPECT_EQ(clock.next(), at_us(50'000));
}

TEST(StampsOfTheFirstBatch, AreNotBeforeTheStart) {
  SampleClock clock;
  clock.restart(at_us(0), kPeriod);
  clock.begin_batch(at_us(15'000), 3);
  EXPECT_EQ(clock.next(), at_us(5'000));
  EXPECT_EQ(clock.next(), at_us(10'000));
  EXPECT_EQ(clock.next(), at_us(15'000));
}

TEST(SamplesThatStayInTheFifo, KeepTheirStampsInTheNextBatch) {
  SampleClock clock;
  clock.restart(at_us(0), kPeriod);
  clock.begin_batch(at_us(100'000), 5);
  EXPECT_EQ(clock.next(), at_us(60'000));
  EXPECT_EQ(clock.next(), at_us(70'000));
  clock.begin_batch(at_us(100'500), 3);
  EXPECT_EQ(clock.next(), at_us(80'000));
  EXPECT_EQ(clock.next(), at_us(90'000));
  EXPECT_EQ(clock.next(), at_us(100'000));
}

TEST(StampsAfterALoss, BeginANewCountAtTheReading) {
  SampleClock clock;
  clock.restart(at_us(0), kPeriod);
  clock.begin_batch(at_us(20'000), 1);
  EXPECT_EQ(clock.next(), at_us(20'000));
  clock.lose_count();
  clock.begin_batch(at_us(1'003'000), 2);
  EXPECT_EQ(clock.next(), at_us(993'000));
  EXPECT_EQ(clock.next(), at_us(1'003'000));
}

}  // namespace
}  // namespace zerorate::drivers
