#include "firmware/boards/linux/datagram_gyro.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>
#include <vector>

#include "firmware/boards/linux/configuration.hpp"
#include "hal/linux/clock.hpp"
#include "hal/linux/named_socket.hpp"
#include "host_tests/support/folders.hpp"

namespace zerorate::linux_node {
namespace {

using hal::linux_os::KernelClock;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(SampleInADatagram, HasTemperatureAndAccelerationOrNot) {
  const auto all = decode_sample("4294967295 81234567890123 0.5 -1e-3 2 25.5 0.25 -0.5 9.75\n");
  ASSERT_TRUE(all);
  EXPECT_EQ(all->sequence, 4294967295U);
  EXPECT_EQ(all->time_ns, 81234567890123);
  EXPECT_THAT(all->rate_rad_s, ElementsAre(0.5, -1e-3, 2.0));
  EXPECT_EQ(all->temperature_degc, 25.5);
  EXPECT_THAT(*all->acceleration_m_s2, ElementsAre(0.25, -0.5, 9.75));
  const auto without = decode_sample("1 0 0 0 0 - 1 2 3");
  ASSERT_TRUE(without);
  EXPECT_FALSE(without->temperature_degc);
  EXPECT_TRUE(without->acceleration_m_s2);
  const auto least = decode_sample("1 0 0 0 0");
  ASSERT_TRUE(least);
  EXPECT_FALSE(least->acceleration_m_s2);
  for (const char* const text :
       {"", "1", "1 0 0 0", "-1 0 0 0 0", "1 -5 0 0 0", "1 0 nan 0 0", "1 0 0 0 0 x", "1.5 0 0 0 0",
        "1 0 0 0 0 25 1 2", "1 0 0 0 0 25 1 2 3 4", "4294967296 0 0 0 0"}) {
    EXPECT_FALSE(decode_sample(text)) << text;
  }
}

/// A gyro of 100 Hz with 250 deg/s and 4 g, and its sender.
class Datagrams : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(gyro_.start(KernelClock::now()));
    const auto address = hal::linux_os::unix_address(path_);
    sender_ = socket(AF_UNIX, SOCK_DGRAM, 0);
    ASSERT_EQ(connect(sender_, address.get(), address.size), 0);
  }
  void TearDown() override { close(sender_); }

  void send(const std::string& text) {
    ASSERT_EQ(::send(sender_, text.data(), text.size(), 0), static_cast<ssize_t>(text.size()));
  }
  /// Sends a sample some milliseconds after the first one's time.
  void sample(int sequence, int after_ms, const std::string& rest = "0 0 0") {
    const auto at = begin_ + core::Duration::milliseconds(after_ms);
    send(std::to_string(sequence) + " " + std::to_string(at.ns()) + " " + rest);
  }
  std::vector<drivers::GyroSample> read() {
    std::array<drivers::GyroSample, 32> samples{};
    const auto count = gyro_.read(KernelClock::now(), samples);
    EXPECT_TRUE(count);
    return {samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(count ? *count : 0)};
  }

  static GyroSettings settings() {
    GyroSettings settings;
    settings.bus = BusKind::unix_socket;
    settings.rate_hz = 100.0;
    settings.full_scale_dps = 250.0;
    settings.acceleration_range_g = 4.0;
    return settings;
  }

  testing::ScratchFolder folder_;
  std::string path_ = (folder_.path() / "samples").string();
  DatagramGyro gyro_{settings(), UnixSettings{path_}};
  core::Instant begin_ = KernelClock::now() - core::Duration::milliseconds(500);
  int sender_ = -1;
};

TEST_F(Datagrams, AreSamplesInTheOrderOfTheirStamps) {
  sample(7, 0, "0.5 -0.25 4.4 25.5 0.5 0 9.75");
  sample(8, 10);
  sample(8, 10);   // twice
  sample(12, 50);  // three are missing
  sample(11, 40);  // one of them, late
  sample(0, 60);   // the sender began anew
  sample(1, 70);
  const auto samples = read();
  ASSERT_EQ(samples.size(), 5U);
  EXPECT_EQ(samples[0].time, begin_);
  EXPECT_EQ(samples[0].rate[1], core::rad_per_s(-0.25F));
  EXPECT_EQ(samples[0].saturated_axes, 4U);  // 250 deg/s are 4.36 rad/s
  EXPECT_TRUE(samples[0].has_temperature);
  EXPECT_TRUE(samples[0].has_acceleration);
  EXPECT_EQ(samples[0].acceleration[2], core::m_per_s2(9.75F));
  EXPECT_FALSE(samples[1].has_temperature || samples[1].has_acceleration);
  EXPECT_EQ(samples[4].time - begin_, core::Duration::milliseconds(70));
  EXPECT_EQ(gyro_.counters(), (SampleCounters{.lost = 3, .late = 1, .doubled = 1}));
}

TEST_F(Datagrams, OfAnotherClockOrWithoutSenseAreCounted) {
  sample(1, 3'600'000);
  sample(2, -10'000);
  send("3 now 0 0 0");
  send("4 0 0 0 0 25 0 0 " + std::string(300, '9'));
  EXPECT_TRUE(read().empty());
  EXPECT_EQ(gyro_.counters(), (SampleCounters{.unreadable = 2, .foreign = 2}));
  EXPECT_THAT(gyro_.reason(drivers::DriverErrorCode::no_new_samples).told,
              HasSubstr("their stamps are not of CLOCK_MONOTONIC"));
}

TEST_F(Datagrams, WithoutStampsHaveTheTimeOfTheReading) {
  send("1 0 0 0 0");
  send("2 0 0 0 0");
  send("2 0 0 0 0");
  const core::Instant before = KernelClock::now();
  const auto samples = read();
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_GE(samples[0].time, before);
  EXPECT_GT(samples[1].time, samples[0].time);
  EXPECT_EQ(gyro_.counters(), (SampleCounters{.doubled = 1}));
}

TEST_F(Datagrams, WithAnAccelerationAtItsRangeHaveNone) {
  sample(1, 0, "0 0 0 - 0 0 39.3");
  sample(2, 10, "0 0 0 - 0 0 39.1");
  const auto samples = read();
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_FALSE(samples[0].has_acceleration);
  EXPECT_TRUE(samples[1].has_acceleration);
}

std::string configuration(const std::string& gyro) {
  return "schema = \"zerorate.daemon/1\"\n[gyro]\n" + gyro +
         "[model]\nname = \"icm42688\"\n[standstill]\nsource = \"gyro\"\n[[sink]]\ntype = "
         "\"json\"\n";
}

std::string wrong_with(const std::string& toml) {
  try {
    static_cast<void>(parse_configuration(toml, "z.toml"));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "none";
}

TEST(ConfigurationOfSamplesByMessage, IsReadAsItStandsThere) {
  const std::string udp =
      "bus = \"udp\"\naddress = \"127.0.0.1\"\nport = 4010\nrate_hz = 102.27\nfull_scale_dps = "
      "250\n";
  const Configuration c = parse_configuration(configuration(udp), "z.toml");
  ASSERT_TRUE(c.samples);
  EXPECT_EQ(c.gyro.device, "udp:127.0.0.1:4010");
  EXPECT_EQ(c.gyro.rate_hz, 102.27);
  EXPECT_FALSE(c.gyro.acceleration_range_g);
  EXPECT_THAT(wrong_with(configuration("bus = \"unix\"\nrate_hz = 100\nfull_scale_dps = 250\n")),
              HasSubstr("missing \"path\" in [gyro]"));
  EXPECT_THAT(wrong_with(configuration("bus = \"unix\"\npath = \"samples\"\nrate_hz = 100\n")),
              HasSubstr("missing \"full_scale_dps\" in [gyro]"));
  EXPECT_THAT(wrong_with(configuration(udp) + "[data_ready]\nchip = \"a\"\nline = 1\n"),
              HasSubstr("not beside samples from messages"));
}

}  // namespace
}  // namespace zerorate::linux_node
