#include "firmware/boards/linux/chips/watched_gyro.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "firmware/boards/linux/chips/iio_gyro.hpp"
#include "firmware/boards/linux/speed_source.hpp"
#include "host_tests/unit/firmware/boards/linux/made_iio.hpp"

namespace zerorate::linux_node {
namespace {

using drivers::DriverErrorCode;
using drivers::GyroSample;
using drivers::Repetition;

/// Gives what it is told.
class ToldGyro final : public drivers::AnyGyro {
 public:
  explicit ToldGyro(const std::vector<GyroSample>& next) : next_(next) {}
  core::Result<void, drivers::DriverError> start(core::Instant) override { return {}; }
  core::Result<std::size_t, drivers::DriverError> read(core::Instant,
                                                       std::span<GyroSample> out) override {
    std::ranges::copy(next_, out.begin());
    return next_.size();
  }
  core::Result<void, drivers::DriverError> verify_next() override { return {}; }
  [[nodiscard]] core::Duration sample_period() const override {
    return core::Duration::milliseconds(10);
  }
  [[nodiscard]] bool is_batched() const override { return false; }

 private:
  const std::vector<GyroSample>& next_;
};

GyroSample sample_of(float dps, std::uint8_t saturated_axes = 0) {
  GyroSample sample;
  sample.rate.fill(core::deg_per_s(dps));
  sample.saturated_axes = saturated_axes;
  return sample;
}

struct Rig {
  core::Result<std::size_t, drivers::DriverError> read(std::vector<GyroSample> samples) {
    next = std::move(samples);
    return gyro.read({}, out);
  }
  std::vector<GyroSample> next;
  std::array<GyroSample, 16> out{};
  WatchedGyro gyro{std::make_unique<ToldGyro>(next), Repetition{4}};
};

TEST(WatchedGyroThatRepeatsItself, IsFaultyAfterTheLongestTime) {
  Rig rig;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(rig.read({sample_of(1.0F)}).value_or(0), 1U);
  const auto frozen = rig.read({sample_of(1.0F)});
  ASSERT_FALSE(frozen);
  EXPECT_EQ(frozen.error().code, DriverErrorCode::frozen);
}

TEST(WatchedGyroThatRepeatsItself, StaysFaultyOverAStart) {
  Rig rig;
  for (int i = 0; i < 5; ++i) (void)rig.read({sample_of(1.0F)});
  ASSERT_TRUE(rig.gyro.start({}));
  EXPECT_FALSE(rig.read({sample_of(1.0F)}));
  EXPECT_EQ(rig.read({sample_of(1.01F)}).value_or(0), 1U);
  EXPECT_EQ(rig.read({sample_of(1.0F)}).value_or(0), 1U);
}

TEST(WatchedGyroThatRepeatsItself, IsFaultyWithinABatchToo) {
  Rig rig;
  EXPECT_EQ(rig.read({3, sample_of(1.0F)}).value_or(0), 3U);
  EXPECT_FALSE(rig.read({2, sample_of(1.0F)}));
}

TEST(WatchedGyroWhereOneAxisMoves, IsNotFaulty) {
  Rig rig;
  for (int i = 0; i < 20; ++i) {
    GyroSample sample = sample_of(1.0F);
    sample.rate[2] = core::deg_per_s(static_cast<float>(i));
    EXPECT_TRUE(rig.read({sample}));
  }
}

TEST(WatchedGyroAtFullScale, IsNotFaulty) {
  Rig rig;
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(rig.read({sample_of(250.0F, 0b111)}));
}

/// In the middle of a count, noise of two million samples at the sigma that is stated. The limit
/// holds for half of that sigma at 10^-12 a sample: at the whole one, nothing comes near.
TEST(LongestRepetition, IsNotReachedByNoiseThatSpansAFewCounts) {
  std::mt19937 random{20251121};
  for (const double sigma_lsb : {0.4, 0.8, 3.2}) {
    std::normal_distribution<double> noise{0.0, sigma_lsb};
    std::uint32_t alike = 0;
    std::uint32_t longest = 0;
    double before = 0.0;
    for (int i = 0; i < 2'000'000; ++i) {
      const double count = std::round(noise(random));
      alike = count == before ? alike + 1 : 1;
      before = count;
      longest = std::max(longest, alike);
    }
    EXPECT_LT(longest, longest_repetition(sigma_lsb, 1.0, 1.0)) << sigma_lsb;
  }
}

/// Calculation by hand: sigma 1 LSB, of which half counts: a value stays with erf(0.7071) =
/// 0.68269, and log(1e-12) / log(0.68269) = 72.4.
TEST(LongestRepetition, IsThatOfHalfTheNoise) {
  EXPECT_EQ(longest_repetition(1.0, 1.0, 1.0), 73U);
  EXPECT_EQ(longest_repetition(0.02, 0.02, 1.0), 73U);
}

TEST(LongestRepetition, IsAtLeastHalfASecond) {
  EXPECT_EQ(longest_repetition(10.0, 1.0, 1000.0), 500U);
}

TEST(LongestRepetition, IsEndlessWhereTheNoiseIsTooSmallToTell) {
  EXPECT_EQ(longest_repetition(0.1, 1.0, 100.0), Repetition::kEndless);
  EXPECT_EQ(longest_repetition(0.0, 1.0, 100.0), Repetition::kEndless);
}

/// Eight bytes as one number, as the byte order says.
std::uint64_t number_of(const std::array<std::uint8_t, 8>& payload, bool is_big_endian) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < payload.size(); ++i) {
    number = number << 8U | payload.at(is_big_endian ? i : payload.size() - 1 - i);
  }
  return number;
}

TEST(SignalOfACanFrame, IsThatOfTheDbcFile) {
  std::mt19937_64 random{18};
  int tried = 0;
  for (int i = 0; i < 20'000; ++i) {
    CanSignal signal{.start_bit = static_cast<unsigned>(random() % 64),
                     .length = static_cast<unsigned>(1 + random() % 32),
                     .is_big_endian = random() % 2 == 0};
    std::array<std::uint8_t, 8> payload{};
    for (std::uint8_t& byte : payload) byte = static_cast<std::uint8_t>(random());
    // Bits above the signal in the number of all eight bytes.
    const unsigned above = signal.is_big_endian
                               ? signal.start_bit / 8 * 8 + 7 - signal.start_bit % 8
                               : 64 - signal.length - signal.start_bit;
    if (above > 64 - signal.length) {
      EXPECT_EQ(signal.bytes(), 0U);
      EXPECT_FALSE(decode_signal(signal, payload));
      continue;
    }
    const std::uint64_t shifted = number_of(payload, signal.is_big_endian) << above;
    ASSERT_EQ(decode_signal(signal, payload), static_cast<double>(shifted >> (64 - signal.length)));
    signal.is_signed = true;
    signal.scale_mps = 0.5;
    signal.offset_mps = -3.0;
    const auto value = static_cast<std::int64_t>(shifted) >> (64 - signal.length);
    ASSERT_EQ(decode_signal(signal, payload), 0.5 * static_cast<double>(value) - 3.0);
    ++tried;
  }
  EXPECT_GT(tried, 10'000);
}

TEST(SignalOfACanFrame, IsNoneInAFrameThatIsTooShort) {
  const CanSignal signal{.start_bit = 7, .length = 16, .is_big_endian = true};
  const std::array<std::uint8_t, 2> payload{0x12, 0x34};
  EXPECT_EQ(decode_signal(signal, payload), 4660.0);
  EXPECT_FALSE(decode_signal(signal, std::span{payload}.first(1)));
}

TEST(SpeedInADatagram, IsANumberOrAWord) {
  EXPECT_EQ(decode_text(" -1.5\n"), -1.5);
  EXPECT_EQ(decode_text("still\n"), 0.0);
  EXPECT_EQ(decode_text("moving"), std::numeric_limits<double>::infinity());
  for (const char* const text : {"", " ", "nan", "inf", "1,5", "1.5 m/s", "Still", "1e999"}) {
    EXPECT_FALSE(decode_text(text)) << text;
  }
}

TEST(ChipOfIio, IsTheOneWhoseNameTheDeviceBears) {
  EXPECT_EQ(chip_of_iio("lsm6dso_gyro"), "lsm6dso");
  EXPECT_EQ(chip_of_iio("bmi088_gyro"), "bmi088");
  EXPECT_EQ(chip_of_iio("iio:device0"), "");
}

TEST(MakeGyro, RefusesAChipThatADriverOfTheKernelHolds) {
  const testing::ScratchFolder sys;
  const auto bind = [&](const std::string& device, const std::string& driver) {
    std::filesystem::create_directories(sys.path() / "bus" / device);
    std::filesystem::create_symlink("/drivers/" + driver, sys.path() / "bus" / device / "driver");
  };
  bind("i2c/devices/1-006a", "st_lsm6dsx_i2c");
  bind("spi/devices/spi0.0", "spidev");
  bind("spi/devices/spi0.1", "adxrs450");
  GyroSettings wired{.chip = "lsm6dso",
                     .bus = BusKind::i2c,
                     .device = "/dev/i2c-1",
                     .address = 0x6A,
                     .rate_hz = 104,
                     .full_scale_dps = 250};
  EXPECT_EQ(kernel_error_of([&] { return make_gyro(wired, sys.path()); }),
            "/dev/i2c-1: the kernel's driver st_lsm6dsx_i2c holds the chip (read it with bus = "
            "\"iio\", see zerorate probe; or unbind the driver)");
  wired.address = 0x6B;
  EXPECT_NE(make_gyro(wired, sys.path()), nullptr);
  wired.bus = BusKind::spi;
  wired.device = "/dev/spidev0.0";
  EXPECT_NE(make_gyro(wired, sys.path()), nullptr);
  wired.device = "/dev/spidev0.1";
  EXPECT_TRUE(
      contains(kernel_error_of([&] { return make_gyro(wired, sys.path()); }), "adxrs450 holds"));
}

}  // namespace
}  // namespace zerorate::linux_node
