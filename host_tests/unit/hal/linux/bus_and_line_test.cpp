#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "hal/linux/bus_error.hpp"
#include "hal/linux/clock.hpp"
#include "hal/linux/gpio_line.hpp"
#include "hal/linux/gpio_request.hpp"
#include "hal/linux/i2c_dev.hpp"
#include "hal/linux/spidev.hpp"
#include "hal/sim/odometer.hpp"
#include "host_tests/support/allocation_counter.hpp"
#include "host_tests/unit/firmware/boards/linux/made_iio.hpp"
#include "host_tests/unit/hal/linux/kernel_double.hpp"

namespace zerorate::hal::linux_os {
namespace {

constexpr I2cAddress kAddress{0x6A};

/// A register read, the transaction of every driver: one byte out, some bytes in.
struct RegisterRead {
  std::array<std::uint8_t, 1> command{0x8F};
  std::array<std::uint8_t, 6> answer{};
  std::array<Operation, 2> operations{Operation::write(command), Operation::read(answer)};
};

struct SpiRig {
  KernelState kernel;
  SpidevDevice<KernelDouble> bus{{.device = "/dev/spidev1.0", .speed_hz = 8'000'000, .mode = 3},
                                 KernelDouble{kernel}};
  RegisterRead read;
  auto transact() { return bus.transaction(read.operations); }
};

struct I2cRig {
  KernelState kernel;
  I2cDevBus<KernelDouble> bus{"/dev/i2c-7", KernelDouble{kernel}};
  RegisterRead read;
  auto transact() { return bus.transaction(kAddress, read.operations); }
};

TEST(SpidevDevice, SetsModeWidthAndSpeedWhenItOpensItsNode) {
  SpiRig rig;
  EXPECT_EQ(rig.kernel.opens, 0);
  ASSERT_TRUE(rig.transact());
  EXPECT_EQ(rig.kernel.opened_path, "/dev/spidev1.0");
  EXPECT_EQ(rig.kernel.spi_mode, 3);
  EXPECT_EQ(rig.kernel.spi_bits, 8);
  EXPECT_EQ(rig.kernel.spi_speed_hz, 8'000'000U);
  ASSERT_TRUE(rig.transact());
  EXPECT_EQ(rig.kernel.opens, 1);
}

TEST(SpidevDevice, HoldsChipSelectOverATransaction) {
  SpiRig rig;
  ASSERT_TRUE(rig.transact());
  EXPECT_EQ(rig.kernel.transfers, 1);
  ASSERT_EQ(rig.kernel.last_spi.size(), 2U);
  EXPECT_EQ(rig.kernel.last_spi[0].cs_change, 0);
  EXPECT_EQ(rig.kernel.last_spi[0].len, 1U);
  EXPECT_EQ(rig.kernel.last_spi[1].len, 6U);
}

TEST(I2cDevBus, DoesATransactionInOneMessageList) {
  I2cRig rig;
  ASSERT_TRUE(rig.transact());
  EXPECT_EQ(rig.kernel.opened_path, "/dev/i2c-7");
  EXPECT_EQ(rig.kernel.i2c_timeout, 5U) << "silence is told four times a second";
  EXPECT_EQ(rig.kernel.transfers, 1);
  ASSERT_EQ(rig.kernel.last_i2c.size(), 2U);
  EXPECT_EQ(rig.kernel.last_i2c[0].addr, 0x6A);
  EXPECT_EQ(rig.kernel.last_i2c[0].flags, 0);
  EXPECT_EQ(rig.kernel.last_i2c[1].flags, I2C_M_RD);
  EXPECT_EQ(rig.kernel.last_i2c[1].len, 6);
}

TEST(I2cDevBusWhoseAdapterStopsShort, ReportsANack) {
  for (const int messages : {0, 1}) {
    I2cRig rig;
    rig.kernel.next_answer = messages;
    const auto done = rig.transact();
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error(), BusError::nack);
    EXPECT_TRUE(rig.transact());
  }
}

TEST(SpidevDeviceWhoseTransferIsShort, ReportsAnError) {
  for (const int bytes : {0, 6}) {
    SpiRig rig;
    rig.kernel.next_answer = bytes;
    const auto done = rig.transact();
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error(), BusError::io);
    EXPECT_TRUE(rig.transact());
  }
}

template <class Rig>
BusError error_of(int number) {
  Rig rig;
  EXPECT_TRUE(rig.transact());
  rig.kernel.next_error = number;
  const auto done = rig.transact();
  EXPECT_FALSE(done);
  EXPECT_TRUE(rig.transact()) << "no recovery after error number " << number;
  return done.error();
}

TEST(I2cDevBusWhoseKernelFails, GivesTheContractsReason) {
  EXPECT_EQ(error_of<I2cRig>(ENXIO), BusError::nack);
  EXPECT_EQ(error_of<I2cRig>(EREMOTEIO), BusError::nack);
  EXPECT_EQ(error_of<I2cRig>(EAGAIN), BusError::arbitration_lost);
  EXPECT_EQ(error_of<I2cRig>(ETIMEDOUT), BusError::timeout);
  EXPECT_EQ(error_of<I2cRig>(EBUSY), BusError::timeout);
  EXPECT_EQ(error_of<I2cRig>(EOVERFLOW), BusError::overrun);
  EXPECT_EQ(error_of<I2cRig>(ENODEV), BusError::not_present);
  EXPECT_EQ(error_of<I2cRig>(ESHUTDOWN), BusError::not_present);
  EXPECT_EQ(error_of<I2cRig>(EIO), BusError::io);
  EXPECT_EQ(error_of<I2cRig>(EPROTO), BusError::io);
}

TEST(SpidevDeviceWhoseKernelFails, GivesTheContractsReason) {
  EXPECT_EQ(error_of<SpiRig>(ENXIO), BusError::not_present);
  EXPECT_EQ(error_of<SpiRig>(ESHUTDOWN), BusError::not_present);
  EXPECT_EQ(error_of<SpiRig>(ENODEV), BusError::not_present);
  EXPECT_EQ(error_of<SpiRig>(ETIMEDOUT), BusError::timeout);
  EXPECT_EQ(error_of<SpiRig>(EIO), BusError::io);
  EXPECT_EQ(error_of<SpiRig>(EMSGSIZE), BusError::io);
}

template <class Rig>
void expect_reopened_after_unplugging() {
  Rig rig;
  ASSERT_TRUE(rig.transact());
  rig.kernel.next_error = ENODEV;
  EXPECT_EQ(rig.transact().error(), BusError::not_present);
  EXPECT_EQ(rig.kernel.closes, 1);
  rig.kernel.open_error = ENOENT;  // the node has gone from /dev
  EXPECT_EQ(rig.transact().error(), BusError::not_present);
  EXPECT_EQ(rig.transact().error(), BusError::not_present);
  rig.kernel.open_error.reset();  // and is back
  EXPECT_TRUE(rig.transact());
  EXPECT_EQ(rig.kernel.opens, 2);
}

TEST(SpidevDeviceThatWasUnplugged, OpensItsNodeAgainWhenItIsBack) {
  expect_reopened_after_unplugging<SpiRig>();
}

TEST(I2cDevBusThatWasUnplugged, OpensItsNodeAgainWhenItIsBack) {
  expect_reopened_after_unplugging<I2cRig>();
}

TEST(SpidevDeviceAtATemporaryError, KeepsItsNodeOpen) {
  SpiRig rig;
  ASSERT_TRUE(rig.transact());
  rig.kernel.next_error = ETIMEDOUT;
  ASSERT_FALSE(rig.transact());
  ASSERT_TRUE(rig.transact());
  EXPECT_EQ(rig.kernel.opens, 1);
  EXPECT_EQ(rig.kernel.closes, 0);
}

TEST(SpidevDeviceWithoutOperations, DoesNotEvenOpenItsNode) {
  SpiRig rig;
  EXPECT_TRUE(rig.bus.transaction({}));
  EXPECT_EQ(rig.kernel.opens, 0);
}

TEST(BusWhoseChipAnotherProgramReads, IsClosedAndSaysWhy) {
  SpiRig spi;
  spi.kernel.is_reserved = true;
  EXPECT_EQ(spi.transact().error(), BusError::not_present);
  EXPECT_EQ(spi.bus.error_number(), EBUSY);
  I2cRig i2c;
  i2c.kernel.is_reserved = true;
  EXPECT_EQ(i2c.transact().error(), BusError::not_present);
  EXPECT_EQ(i2c.bus.error_number(), EBUSY);
  EXPECT_EQ(i2c.kernel.transfers, 0);
  i2c.kernel.is_reserved = false;
  EXPECT_TRUE(i2c.transact()) << "at the first use after that";
}

/// The locks of the real kernel, on a file in place of the node.
TEST(ChipsBehindOneNode, AreReservedEachOnItsOwn) {
  const testing::ScratchFolder folder;
  const std::string node = (folder.path() / "i2c-7").string();
  std::ofstream{node} << "node";
  const auto open = [&] {
    auto file = std::make_unique<DeviceFile<SystemCalls>>(node, Subsystem::i2c, SystemCalls{});
    EXPECT_TRUE(file->open());
    return file;
  };
  const auto first = open();
  EXPECT_TRUE(first->reserve(0x6A));
  EXPECT_TRUE(first->reserve(0x6A)) << "its own";
  const auto second = open();
  EXPECT_TRUE(second->reserve(0x6B));
  EXPECT_FALSE(second->reserve(0x6A));
  EXPECT_EQ(second->error_number(), EBUSY);
  first->close();
  const auto third = open();
  EXPECT_TRUE(third->reserve(0x6A));
}

TEST(BusesOnceOpened, DoNotAllocate) {
  KernelState kernel;
  // The double itself allocates; what is counted is the path to the real kernel, which refuses.
  SpidevDevice<> spi{{.device = "/dev/null"}};
  I2cDevBus<> i2c{"/dev/null"};
  RegisterRead read;
  const support::AllocationCounter allocations;
  EXPECT_FALSE(spi.transaction(read.operations));
  EXPECT_FALSE(i2c.transaction(kAddress, read.operations));
  EXPECT_EQ(allocations.count(), 0U);
}

TEST(RealKernelWithoutTheDevice, SaysThatItIsNotPresent) {
  SpidevDevice<> spi{{.device = "/dev/there-is-no-such-device"}};
  RegisterRead read;
  const auto done = spi.transaction(read.operations);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error(), BusError::not_present);
}

using linux_node::Attributes;
using linux_node::buffered;
using linux_node::contains;
using linux_node::kernel_error_of;
using linux_node::MadeIio;

TEST(IioElement, DecodesOrderSignWidthAndShift) {
  const std::array<std::uint8_t, 8> bytes{0xFF, 0x81, 0x23, 0x45, 0x67, 0x89, 0xAB, 0xCD};
  const auto value = [&](const char* type, std::size_t offset) {
    IioElement element = parse_iio_type(type, "path");
    element.offset = offset;
    return element.decode(bytes);
  };
  EXPECT_EQ(value("le:s16/16>>0", 0), static_cast<std::int16_t>(0x81FF));
  EXPECT_EQ(value("be:s16/16>>0", 0), -127);
  EXPECT_EQ(value("be:u16/16>>0", 0), 0xFF81);
  EXPECT_EQ(value("be:u12/16>>4", 2), 0x234);
  EXPECT_EQ(value("be:s12/16>>4", 0), -8);
  EXPECT_EQ(value("le:s24/32>>8", 4), static_cast<std::int32_t>(0xCDAB8900) >> 8);
  EXPECT_EQ(value("be:s64/64>>0", 0), static_cast<std::int64_t>(0xFF8123456789ABCD));
  EXPECT_EQ(value("le:s16/16", 0), static_cast<std::int16_t>(0x81FF));
}

TEST(IioElement, RefusesALayoutThatIsNotOne) {
  for (const char* const type : {"", "le:s16", "xe:s16/16>>0", "le:s16/24>>0", "le:s16/16>>1",
                                 "le:s0/16>>0", "le:s16/16X2>>0", "le:f32/32>>0"}) {
    EXPECT_TRUE(contains(kernel_error_of([&] { return parse_iio_type(type, "/p"); }), "/p: "))
        << type;
  }
}

TEST(FindIioGyro, TakesNumberNodeNameAndLabelAndTellsWhatThereIs) {
  MadeIio made;
  made.add("iio:device0", buffered());
  Attributes second = buffered();
  second["label"] = "roof";
  made.add("iio:device12", second);
  made.add("iio:device3", {{"name", "lsm6dso_accel"}, {"in_accel_x_raw", "0"}});
  const auto node = [&](const char* wanted) {
    return find_iio_device(made.places(), kIioRate, wanted).node;
  };
  EXPECT_EQ(node("0"), "iio:device0");
  EXPECT_EQ(node("iio:device12"), "iio:device12");
  EXPECT_EQ(node("/dev/iio:device12"), "iio:device12");
  EXPECT_EQ(node("roof"), "iio:device12");
  const std::string sys = made.places().sysfs;
  const std::string list =
      "iio:device0 \"lsm6dso_gyro\", iio:device12 \"lsm6dso_gyro\" labelled \"roof\")";
  EXPECT_EQ(kernel_error_of([&] { return node("lsm6dso_gyro"); }),
            sys + ": several gyros are called \"lsm6dso_gyro\" (give its number or label: " + list);
  EXPECT_EQ(kernel_error_of([&] { return node("3"); }),
            sys + ": no gyro is called \"3\" (there are " + list);
  EXPECT_EQ(find_iio_device(made.places(), kIioAcceleration, "3").name, "lsm6dso_accel");
  EXPECT_EQ(
      kernel_error_of([&] { return find_iio_device(made.places(), kIioAcceleration, "0").node; }),
      sys + ": no accelerometer is called \"0\" (there are iio:device3 \"lsm6dso_accel\")");
  EXPECT_TRUE(contains(kernel_error_of([] {
                         return find_iio_device({"/nowhere", "/nowhere"}, kIioRate, "x").node;
                       }),
                       "is the driver's module loaded and bound?"));
}

constexpr core::Instant at_ms(std::int64_t ms) {
  return core::Instant::from_ns(ms * 1'000'000);
}

TEST(SequenceGapsOfConsecutiveNumbers, AreNone) {
  SequenceGaps gaps;
  for (std::uint32_t number = 1; number < 100; ++number) EXPECT_EQ(gaps.take(number), 0U);
}

TEST(SequenceGaps, CountTheNumbersThatAreMissing) {
  SequenceGaps gaps;
  EXPECT_EQ(gaps.take(4), 3U);  // also before the first one that was seen
  EXPECT_EQ(gaps.take(5), 0U);
  EXPECT_EQ(gaps.take(16), 10U);
}

TEST(SequenceGapsAtTheEndOfTheNumbers, GoOnFromZero) {
  SequenceGaps gaps;
  (void)gaps.take(std::numeric_limits<std::uint32_t>::max());
  EXPECT_EQ(gaps.take(0), 0U);
  EXPECT_EQ(gaps.take(2), 1U);
}

TEST(LatestEdgeOfManyEdges, IsTheNewestOnce) {
  sim::SimulatedOdometer line{100};
  LatestEdge pin{line};
  EXPECT_EQ(pin.take_edge(), std::nullopt);
  for (int ms = 0; ms < 32; ++ms) line.pulse(at_ms(ms));  // two full batches
  EXPECT_EQ(pin.take_edge(), at_ms(31));
  EXPECT_EQ(pin.take_edge(), std::nullopt);
}

TEST(LatestEdgeOfALineThatFloats, EndsThoughEdgesNeverDo) {
  struct Floating {
    std::int64_t edges = 0;
    core::Result<PulseBatch, BusError> read_pulses(std::span<core::Instant> stamps) {
      for (core::Instant& stamp : stamps) stamp = at_ms(static_cast<int>(++edges));
      return PulseBatch{.count = stamps.size()};
    }
  } line;
  LatestEdge pin{line};
  EXPECT_EQ(pin.take_edge(), at_ms(1024));
  EXPECT_EQ(pin.take_edge(), at_ms(2048));
}

TEST(LatestEdgeOfALineThatFails, IsNone) {
  struct Failing {
    core::Result<PulseBatch, BusError> read_pulses(std::span<core::Instant>) {
      return core::Unexpected{BusError::io};
    }
  } line;
  LatestEdge pin{line};
  EXPECT_EQ(pin.take_edge(), std::nullopt);
}

TEST(Debounce, LeavesOutEdgesThatFollowAnotherTooSoon) {
  const auto ms = [](std::int64_t at) { return core::Instant::from_ns(at * 1'000'000); };
  Debounce debounce{core::Duration::milliseconds(5)};
  std::array stamps{ms(100), ms(102), ms(106), ms(111), ms(200)};
  PulseBatch batch{.count = stamps.size(), .lost = 3};
  debounce.drop_bounces(stamps, batch);
  EXPECT_EQ(batch.count, 3U);
  EXPECT_EQ(batch.lost, 3U);
  EXPECT_EQ(stamps[1], ms(111)) << "the line bounced until 106";
  batch.count = 1;
  stamps[0] = ms(203);
  debounce.drop_bounces(stamps, batch);
  EXPECT_EQ(batch.count, 0U) << "over the end of a batch";
}

TEST(DebounceOfNoTime, KeepsAll) {
  Debounce debounce{core::Duration{}};
  std::array stamps{core::Instant::from_ns(1), core::Instant::from_ns(1)};
  PulseBatch batch{.count = 2};
  debounce.drop_bounces(stamps, batch);
  EXPECT_EQ(batch.count, 2U);
}

TEST(GpioLineOnAChipThatIsNotThere, SaysSoAtEveryRead) {
  GpioLine line{{.chip = "/dev/there-is-no-such-chip", .line = "3"}};
  std::array<core::Instant, 4> stamps{};
  for (int i = 0; i < 2; ++i) {
    const auto batch = line.read_pulses(stamps);
    ASSERT_FALSE(batch);
    EXPECT_EQ(batch.error(), BusError::not_present);
    EXPECT_EQ(line.descriptor(), -1);
  }
}

TEST(KernelClock, DoesNotRunBackwards) {
  core::Instant before = KernelClock::now();
  EXPECT_GT(before, core::Instant{});
  for (int i = 0; i < 1000; ++i) {
    const core::Instant now = KernelClock::now();
    ASSERT_GE(now, before);
    before = now;
  }
}

}  // namespace
}  // namespace zerorate::hal::linux_os
