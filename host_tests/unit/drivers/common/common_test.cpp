#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "drivers/common/acceleration.hpp"
#include "drivers/common/configuration_table.hpp"
#include "drivers/common/gyro_source.hpp"
#include "drivers/common/register_access.hpp"
#include "drivers/common/sample_clock.hpp"
#include "hal/testing/scripted_bus.hpp"

namespace zerorate::drivers {
namespace {

using hal::testing::FailureAt;
using hal::testing::reads;
using hal::testing::writes;

constexpr Register<0x22, Access::read_only> kOutput;
constexpr Register<0x11, Access::read_write> kControl;
constexpr hal::I2cAddress kDevice{0x6B};

TEST(SpiRegisters, SetBit7OfTheAddressToRead) {
  hal::testing::ScriptedSpiDevice spi;
  spi.expect({writes({0xA2}), reads({1, 2, 3})});
  SpiRegisters bus{spi};
  std::array<std::uint8_t, 3> values{};
  ASSERT_TRUE(read_registers(bus, kOutput, values));
  EXPECT_EQ(values, (std::array<std::uint8_t, 3>{1, 2, 3}));
}

TEST(SpiRegistersWithDummy, ReadsADummyByteFirst) {
  hal::testing::ScriptedSpiDevice spi;
  SpiRegistersWithDummy registers{spi};
  spi.expect({writes({0x80}), reads({0xFF}), reads({0x1E})});
  std::array<std::uint8_t, 1> identity{};
  ASSERT_TRUE(registers.read(0x00, identity));
  EXPECT_EQ(identity[0], 0x1E);
  spi.expect({writes({0x7D, 0x04})});
  EXPECT_TRUE(registers.write(0x7D, 0x04));
  spi.expect({writes({0x5E, 1, 2, 3})});
  EXPECT_TRUE(registers.write(0x5E, std::array<std::uint8_t, 3>{1, 2, 3}));
}

TEST(SpiRegisters, WriteAddressAndValueUnderOneSelection) {
  hal::testing::ScriptedSpiDevice spi;
  spi.expect({writes({0x11, 0x40})});
  SpiRegisters bus{spi};
  EXPECT_TRUE(write_register(bus, kControl, 0x40));
}

TEST(I2cRegisters, WriteTheAddressAndReadAfterARepeatedStart) {
  hal::testing::ScriptedI2cBus i2c;
  i2c.expect(kDevice, {writes({0x22}), reads({7})});
  I2cRegisters bus{i2c, kDevice};
  EXPECT_EQ(read_register(bus, kOutput).value_or(0), 7);
}

TEST(I2cRegisters, WriteAddressAndValueInOneMessage) {
  hal::testing::ScriptedI2cBus i2c;
  i2c.expect(kDevice, {writes({0x11, 0x40})});
  I2cRegisters bus{i2c, kDevice};
  EXPECT_TRUE(write_register(bus, kControl, 0x40));
}

TEST(RegisterAccess, ReportsTheBusErrorAndTheRegister) {
  hal::testing::ScriptedI2cBus i2c;
  i2c.expect(kDevice, {writes({0x22}), reads({7})}, FailureAt{1, hal::BusError::nack});
  i2c.expect(kDevice, {writes({0x11, 0x40})}, FailureAt{0, hal::BusError::timeout});
  I2cRegisters bus{i2c, kDevice};
  EXPECT_EQ(read_register(bus, kOutput).error(),
            (DriverError{DriverErrorCode::bus_failed, hal::BusError::nack, 0x22}));
  EXPECT_EQ(write_register(bus, kControl, 0x40).error(),
            (DriverError{DriverErrorCode::bus_failed, hal::BusError::timeout, 0x11}));
}

constexpr std::int16_t kMin = std::numeric_limits<std::int16_t>::min();
constexpr std::int16_t kMax = std::numeric_limits<std::int16_t>::max();

GyroSample sample_of(std::int16_t x, std::int16_t y, std::int16_t z) {
  GyroSample sample;
  set_rates(sample, {x, y, z}, core::rad_per_s(0.1F), 28571);
  return sample;
}

TEST(RateOfRawZero, IsExactlyZero) {
  for (const auto rate : sample_of(0, 0, 0).rate) EXPECT_EQ(rate.in(core::rad_per_s), 0.0F);
}

TEST(RateOfRawExtremes, IsTheLsbTimesTheCount) {
  const GyroSample sample = sample_of(kMin, kMax, -1);
  // One rounding of the constant and one of the product, each at most 2^-24 of the value.
  const double tolerance = 2.0 * std::exp2(-24);
  EXPECT_NEAR(sample.rate[0].in(core::rad_per_s), -3276.8, 3276.8 * tolerance);
  EXPECT_NEAR(sample.rate[1].in(core::rad_per_s), 3276.7, 3276.7 * tolerance);
  EXPECT_NEAR(sample.rate[2].in(core::rad_per_s), -0.1, 0.1 * tolerance);
}

TEST(Saturation, BeginsAtFullScaleOnBothSides) {
  EXPECT_EQ(sample_of(0, 28570, -28570).saturated_axes, 0);
  EXPECT_EQ(sample_of(28571, 0, 0).saturated_axes, 0b001);
  EXPECT_EQ(sample_of(0, -28571, 0).saturated_axes, 0b010);
  EXPECT_EQ(sample_of(kMin, 0, kMax).saturated_axes, 0b101);
}

TEST(Saturation, OfTheSampleBeforeIsForgotten) {
  GyroSample sample = sample_of(kMax, kMax, kMax);
  set_rates(sample, {0, 0, 0}, core::rad_per_s(0.1F), 28571);
  EXPECT_EQ(sample.saturated_axes, 0);
}

constexpr AccelerationScale kMilliG{
    .lsb = core::standard_gravity(1e-3F), .highest_raw = 2000, .lowest_raw = -2000};

TEST(Acceleration, IsTheLsbTimesTheCount) {
  GyroSample sample;
  set_acceleration(sample, {1999, 0, -1999}, kMilliG);
  EXPECT_TRUE(sample.has_acceleration);
  EXPECT_FLOAT_EQ(sample.acceleration[0].in(core::m_per_s2), 1.999F * 9.80665F);
  EXPECT_EQ(sample.acceleration[1].in(core::m_per_s2), 0.0F);
  EXPECT_FLOAT_EQ(sample.acceleration[2].in(core::m_per_s2), -1.999F * 9.80665F);
}

TEST(Acceleration, IsNoneWhereAnAxisIsAtTheEndOfItsRange) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int raw : {2000, 32767, -2000, -32768}) {
      GyroSample sample;
      sample.has_acceleration = true;
      std::array<std::int16_t, 3> counts{};
      counts.at(axis) = static_cast<std::int16_t>(raw);
      set_acceleration(sample, counts, kMilliG);
      EXPECT_FALSE(sample.has_acceleration) << axis << ' ' << raw;
      set_acceleration(sample, {}, kMilliG);
      EXPECT_TRUE(sample.has_acceleration) << "the next one is valid again";
    }
  }
}

TEST(ConfigurationEntries, AreJoinedBehindTheFirst) {
  constexpr std::array kFirst{ConfigurationEntry{1, 0, 0}, ConfigurationEntry{2, 0, 0}};
  constexpr std::array kMore{ConfigurationEntry{7, 0, 0}, ConfigurationEntry{8, 0, 0}};
  constexpr std::array<std::uint8_t, 4> kOrder{1, 7, 8, 2};
  constexpr auto kAll = joined(kFirst, kMore);
  for (std::size_t i = 0; i < kAll.size(); ++i) EXPECT_EQ(kAll.at(i).address, kOrder.at(i));
}

TEST(Int16, IsTwosComplement) {
  EXPECT_EQ(decode_int16(0x34, 0x12), 0x1234);
  EXPECT_EQ(decode_int16(0xFF, 0xFF), -1);
  EXPECT_EQ(decode_int16(0x00, 0x80), kMin);
  EXPECT_EQ(decode_int16(0xFF, 0x7F), kMax);
}

constexpr Register<0x10, Access::read_write> kFirst;
constexpr Register<0x11, Access::read_write> kSecond;

/// Registers in memory; bits of `stuck_low` cannot be set.
struct MemoryBus {
  core::Result<void, hal::BusError> read(std::uint8_t first, std::span<std::uint8_t> out) {
    ++reads;
    for (std::uint8_t& value : out) value = memory[first++];
    return {};
  }
  core::Result<void, hal::BusError> write(std::uint8_t address, std::uint8_t value) {
    order.push_back(address);
    memory[address] = static_cast<std::uint8_t>(value & ~stuck_low);
    return {};
  }

  std::array<std::uint8_t, 256> memory{};
  std::uint8_t stuck_low = 0;
  int reads = 0;
  std::vector<std::uint8_t> order;
};
static_assert(RegisterBus<MemoryBus>);

ConfigurationTable<2> table() {
  return ConfigurationTable<2>{{configure(kFirst, 0x0F, 0x05), configure(kSecond, 0xC0, 0x80)}};
}

TEST(ConfigurationTable, ChangesItsFieldsOnlyAndInOrder) {
  MemoryBus bus;
  bus.memory[0x10] = 0xFF;
  bus.memory[0x11] = 0x7E;
  auto configuration = table();
  ASSERT_TRUE(configuration.apply(bus));
  EXPECT_EQ(bus.memory[0x10], 0xF5);
  EXPECT_EQ(bus.memory[0x11], 0xBE);
  EXPECT_EQ(bus.order, (std::vector<std::uint8_t>{0x10, 0x11}));
}

TEST(ConfigurationTable, StopsAtARegisterThatDoesNotTakeItsValue) {
  MemoryBus bus;
  bus.stuck_low = 0x04;
  auto configuration = table();
  const auto applied = configuration.apply(bus);
  ASSERT_FALSE(applied);
  EXPECT_EQ(applied.error(), (DriverError{DriverErrorCode::configuration_lost, {}, 0x10}));
  EXPECT_EQ(bus.order.size(), 1U);
}

TEST(ConfigurationTable, VerifiesOneEntryACallAndBeginsAgain) {
  MemoryBus bus;
  auto configuration = table();
  ASSERT_TRUE(configuration.apply(bus));
  bus.reads = 0;
  for (int call = 0; call < 4; ++call) EXPECT_TRUE(configuration.verify_next(bus));
  EXPECT_EQ(bus.reads, 4);
}

TEST(ConfigurationTable, SeesBitsThatWereLostAndBitsThatAppeared) {
  MemoryBus bus;
  auto configuration = table();
  ASSERT_TRUE(configuration.apply(bus));
  bus.memory[0x10] = 0x04;  // bit 0 lost
  EXPECT_EQ(configuration.verify_next(bus).error().reg, 0x10);
  EXPECT_FALSE(configuration.verify_next(bus)) << "stays at the entry that differs";
  bus.memory[0x10] = 0x05;
  EXPECT_TRUE(configuration.verify_next(bus));
  bus.memory[0x11] = 0xC0;  // bit 6 appeared
  EXPECT_EQ(configuration.verify_next(bus).error().reg, 0x11);
}

TEST(ConfigurationTable, IgnoresBitsThatAreNotItsOwn) {
  MemoryBus bus;
  auto configuration = table();
  ASSERT_TRUE(configuration.apply(bus));
  bus.memory[0x10] = 0xF5;
  EXPECT_TRUE(configuration.verify_next(bus));
}

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

TEST(StampsOfAChipThatKeepsItsPeriod, AreOnePeriodApart) {
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

TEST(StampsOfAChipThatIsOff, StayWithinOnePeriodOfTheTruth) {
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
