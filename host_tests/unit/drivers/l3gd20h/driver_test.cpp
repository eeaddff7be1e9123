/// @file
/// Particulars of the L3GD20H and of its codec; the rest is in host_tests/contract.

#include "drivers/l3gd20h/driver.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "host_tests/support/simulated_gyros.hpp"

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using l3gd20h::FullScale;
using l3gd20h::Mode;
using l3gd20h::OutputDataRate;
using l3gd20h::Part;
using Rig = support::GyroRig<support::OverSpi<support::L3gd20h>>;

TEST(L3gd20hLsb, IsTheSensitivityOfTheDatasheet) {
  const double tolerance = 3.0 * std::exp2(-24);  // three roundings in single precision
  const auto expect_mdps = [&](FullScale full_scale, double mdps) {
    const double expected = mdps * 1e-3 * std::numbers::pi / 180.0;
    EXPECT_NEAR(l3gd20h::lsb(full_scale).in(core::rad_per_s), expected, expected * tolerance);
  };
  expect_mdps(FullScale::dps_250, 8.75);
  expect_mdps(FullScale::dps_500, 17.5);
  expect_mdps(FullScale::dps_2000, 70.0);
}

TEST(L3gd20hFifoSrc, HoldsLevelAndFullAndEmpty) {
  EXPECT_EQ(l3gd20h::decode_fifo_src(0x20).frames, 0);
  EXPECT_EQ(l3gd20h::decode_fifo_src(0x9F).frames, 31);
  EXPECT_FALSE(l3gd20h::decode_fifo_src(0x9F).is_full);
  EXPECT_TRUE(l3gd20h::decode_fifo_src(0xDF).is_full);
  EXPECT_TRUE(l3gd20h::decode_fifo_src(0x20).is_plausible);
  EXPECT_FALSE(l3gd20h::decode_fifo_src(0x21).is_plausible);
  EXPECT_FALSE(l3gd20h::decode_fifo_src(0xFF).is_plausible) << "a stuck line";
  EXPECT_EQ(l3gd20h::decode_fifo_src(0x00).frames, 0);
}

TEST(L3gd20hSamplePeriod, IsThatOfTheNamedRate) {
  const auto period_ns = [](Part part, OutputDataRate rate) {
    return l3gd20h::sample_period(l3gd20h::variant(part), rate).ns();
  };
  EXPECT_EQ(period_ns(Part::l3gd20h, OutputDataRate::times_1), 10'000'000);
  EXPECT_EQ(period_ns(Part::l3g4200d, OutputDataRate::times_8), 1'250'000);
  EXPECT_EQ(period_ns(Part::l3gd20, OutputDataRate::times_2), 5'263'157);
  EXPECT_EQ(l3gd20h::L3gd20::kRates[3].value, 760.0);
}

TEST(L3gd20h, ConfiguresTheRegistersThatTheDatasheetNames) {
  Rig rig{{.full_scale = FullScale::dps_500,
           .rate = OutputDataRate::times_4,
           .mode = Mode::fifo,
           .fifo_watermark = 16}};
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x20), 0x8F);  // CTRL1: 400 Hz, on
  EXPECT_EQ(rig.chip.read_register(0x21), 0x00);  // CTRL2: no high-pass filter
  EXPECT_EQ(rig.chip.read_register(0x22), 0x04);  // CTRL3: watermark
  EXPECT_EQ(rig.chip.read_register(0x23), 0x90);  // CTRL4: BDU, 500 deg/s
  EXPECT_EQ(rig.chip.read_register(0x24), 0x40);  // CTRL5: FIFO on
  EXPECT_EQ(rig.chip.read_register(0x2E), 0x50);  // FIFO_CTRL: stream, 16
  EXPECT_EQ(rig.chip.sample_period(), rig.driver.sample_period());
}

template <class Settings>
bool starts(std::uint8_t identity) {
  hal::sim::SimulatedClock clock;
  hal::sim::SimulatedL3gd20h chip{clock, identity};
  hal::sim::SimulatedSpiDevice<hal::sim::SimulatedL3gd20h> bus{chip};
  L3gd20h driver{SpiRegisters{bus}, Settings{}};
  return driver.start(clock.now()).error().code == DriverErrorCode::not_ready;
}

TEST(L3gd20hRelatives, AreNotTakenForEachOther) {
  for (const auto identity : std::to_array<std::uint8_t>({0xD3, 0xD4, 0xD7})) {
    EXPECT_EQ(starts<l3gd20h::L3g4200d::Settings>(identity), identity == 0xD3);
    EXPECT_EQ(starts<l3gd20h::L3gd20::Settings>(identity), identity == 0xD4);
    EXPECT_EQ(starts<l3gd20h::Settings>(identity), identity == 0xD7);
  }
}

TEST(L3gd20hRelatives, HaveNoLowRates) {
  support::GyroRig<support::OverI2c<support::L3g4200d>> rig;
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.reserved_writes(), 0U);
}

TEST(L3gd20hFifo, ThatIsFullCountsAsAnOverrun) {
  Rig rig{{.mode = Mode::fifo}};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 31; ++i) rig.sample({deg_per_s(1.0F), {}, {}});
  std::array<GyroSample, 40> out{};
  EXPECT_EQ(rig.read(out).value_or(0), 31U);
  for (int i = 0; i < 32; ++i) rig.sample({deg_per_s(1.0F), {}, {}});
  const auto full = rig.read(out);
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error(), (DriverError{DriverErrorCode::fifo_overrun, {}, 0x2F}));
  EXPECT_EQ(rig.read(out).value_or(9), 0U) << "it was emptied";
}

TEST(L3gd20hOutputs, AskForTheIncrementOfTheAddress) {
  EXPECT_EQ(l3gd20h::kOutputs<true>.address, 0x68);   // SPI: bit 6
  EXPECT_EQ(l3gd20h::kOutputs<false>.address, 0xA8);  // I2C: bit 7
}

}  // namespace
}  // namespace zerorate::drivers
