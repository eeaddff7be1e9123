#include "firmware/boards/linux/configuration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "firmware/toml/error.hpp"
#include "firmware/toml/strict_table.hpp"
#include "host_tests/support/folders.hpp"

namespace zerorate::linux_node {
namespace {

using ::testing::HasSubstr;

constexpr const char* kOdometer =
    "[odometer]\nchip = \"/dev/gpiochip0\"\nline = 24\nedge = \"both\"\n";

constexpr const char* kFull = R"(schema = "zerorate.daemon/1"
user = "gyro"
[gyro]
chip = "lsm6dso"
bus = "i2c"
device = "/dev/i2c-1"
address = 0x6B
rate_hz = 208
full_scale_dps = 500
fifo = true
[data_ready]
chip = "/dev/gpiochip1"
line = "GYRO_DRDY"
[odometer]
chip = "/dev/gpiochip0"
line = 24
edge = "both"
[model]
name = "bmi088"
[filter]
rate_hz = 4
settle_s = 2
hold_back_s = 0.25
predictor = "moving_average"
[state]
file = "/var/lib/zerorate/state"
save_interval_s = 30
[real_time]
priority = 40
lock_memory = false
[metrics]
file = "/run/zerorate/metrics.prom"
socket = "/run/zerorate/metrics.sock"
[[sink]]
type = "json"
[[sink]]
type = "udp"
address = "::1"
port = 4000
[[sink]]
type = "unix"
path = "/run/rate"
[[sink]]
type = "can"
interface = "can0"
id = 0x310
)";

std::string message_of(const std::string& toml) {
  try {
    (void)parse_configuration(toml, "z.toml");
  } catch (const toml_file::Error& error) {
    return error.what();
  }
  return "no error";
}

/// The full file with one piece of text replaced.
std::string with(const std::string& piece, const std::string& replacement) {
  std::string toml = kFull;
  const std::size_t at = toml.find(piece);
  EXPECT_NE(at, std::string::npos) << piece;
  return toml.replace(at, piece.size(), replacement);
}

TEST(ConfigurationWithEverything, IsReadAsItStandsThere) {
  const Configuration c = parse_configuration(kFull, "z.toml");
  EXPECT_EQ(c.user, "gyro");
  EXPECT_EQ(c.gyro.chip, "lsm6dso");
  EXPECT_EQ(c.gyro.bus, BusKind::i2c);
  EXPECT_EQ(c.gyro.device, "/dev/i2c-1");
  EXPECT_EQ(c.gyro.address, 0x6B);
  EXPECT_EQ(c.gyro.rate_hz, 208.0);
  EXPECT_EQ(c.gyro.full_scale_dps, 500.0);
  EXPECT_TRUE(c.gyro.fifo);
  EXPECT_EQ(c.data_ready->chip, "/dev/gpiochip1");
  EXPECT_EQ(c.data_ready->line, "GYRO_DRDY");
  ASSERT_TRUE(c.odometer);
  EXPECT_EQ(c.odometer->line, "24");
  EXPECT_EQ(c.odometer->edge, hal::linux_os::Edge::both);
  EXPECT_EQ(c.node.model.modes.tick, core::Duration::milliseconds(250));
  EXPECT_EQ(c.node.model.sample_period, core::Duration::nanoseconds(4807692));  // 1 / 208 Hz
  EXPECT_EQ(c.node.standstill.settle, core::Duration::seconds(2));
  EXPECT_EQ(c.node.standstill.hold_back, core::Duration::milliseconds(250));
  EXPECT_EQ(c.node.published, app::Predictor::moving_average);
  EXPECT_EQ(c.state->file, "/var/lib/zerorate/state");
  EXPECT_EQ(c.state->save_interval, core::Duration::seconds(30));
  EXPECT_EQ(c.real_time.priority, 40);
  EXPECT_FALSE(c.real_time.lock_memory);
  EXPECT_EQ(c.metrics.file, "/run/zerorate/metrics.prom");
  EXPECT_EQ(c.metrics.socket, "/run/zerorate/metrics.sock");
  ASSERT_EQ(c.sinks.size(), 4U);
  EXPECT_EQ(std::get<JsonSettings>(c.sinks[0]).file, "-");
  EXPECT_EQ(std::get<UdpSettings>(c.sinks[1]).port, 4000);
  EXPECT_EQ(std::get<UnixSettings>(c.sinks[2]).path, "/run/rate");
  EXPECT_EQ(std::get<CanSettings>(c.sinks[3]).id, 0x310);
}

TEST(ConfigurationThatIsInstalled, IsValid) {
  const Configuration c =
      read_configuration(ZERORATE_REPOSITORY "/firmware/boards/linux/zerorated.toml");
  EXPECT_EQ(c.gyro.speed_hz, 8'000'000U);
  EXPECT_EQ(c.sinks.size(), 1U);
}

TEST(ConfigurationOfEachChip, MakesItsGyro) {
  for (const ChipDescription& chip : chips()) {
    const GyroSettings settings{.chip = std::string(chip.name),
                                .bus = BusKind::spi,
                                .device = "/dev/there-is-no-such-device",
                                .rate_hz = chip.rates_hz.back(),
                                .full_scale_dps = chip.full_scales_dps.front()};
    const auto gyro = chip.make(settings);
    const auto nominal_ns = static_cast<std::int64_t>(1e9 / chip.rates_hz.back());
    EXPECT_NEAR(static_cast<double>(gyro->sample_period().ns()), static_cast<double>(nominal_ns),
                1e-3 * static_cast<double>(nominal_ns))
        << chip.name;
  }
}

/// ", name" of every chip.
std::string all_chips() {
  std::string names;
  for (const ChipDescription& chip : chips()) names += ", " + std::string{chip.name};
  return names;
}

struct Mistake {
  std::string toml;
  std::string message;
};

TEST(ConfigurationWithAMistake, IsRefusedWithPlaceAndExpected) {
  const std::vector<Mistake> mistakes{
      {with("daemon/1", "daemon/2"), "z.toml:1:10: \"schema\": expected \"zerorate.daemon/1\""},
      {with("[gyro]\n", "[gyro\n"), "z.toml:3:"},
      {with("user = ", "name = \"a b\"\nuser = "),
       "z.toml:2:8: \"name\": expected 1 to 32 letters"},
      {with("user", "usr"), "z.toml:2:1: unknown key \"usr\"; did you mean \"user\"?"},
      {with("chip = \"lsm6dso\"", "chip = \"lsm6dzo\""),
       "z.toml:4:8: \"chip\" in [gyro]: no chip \"lsm6dzo\" (known are simulated" + all_chips() +
           "); did you mean \"lsm6dso\"?"},
      {with("bus = \"i2c\"", "bus = \"simulated\""),
       "z.toml:5:7: \"bus\" in [gyro]: expected \"spi\", \"i2c\", \"iio\", \"udp\" or "
       "\"unix\""},
      {with("device = \"/dev/i2c-1\"\n", ""),
       "z.toml:3:1: missing \"device\" in [gyro]; expected text in quotes"},
      {with("0x6B", "0x11"), "z.toml:7:11: \"address\" in [gyro]: the chip answers at 0x6a, 0x6b"},
      {with("0x6B", "200"), "z.toml:7:11: \"address\" in [gyro]: expected a 7-bit address"},
      {with("address = 0x6B", "speed_hz = 5"), "z.toml:7:1: unknown key \"speed_hz\" in [gyro]"},
      {with("= 208", "= 200"), "z.toml:8:11: \"rate_hz\" in [gyro]: the chip offers 12.5, 26, 52"},
      {with("= 208", "= \"208\""),
       "z.toml:8:11: \"rate_hz\" in [gyro]: expected a positive number"},
      {with("= 500", "= 300"),
       "z.toml:9:18: \"full_scale_dps\" in [gyro]: the chip offers 125, 250, 500"},
      {with("fifo = true", "fifo = 1"), "z.toml:10:8: \"fifo\" in [gyro]: expected true or false"},
      {with("\"GYRO_DRDY\"", "-1"),
       "z.toml:13:8: \"line\" in [data_ready]: expected a line's name"},
      {with("\"both\"", "\"any\""),
       "z.toml:17:8: \"edge\" in [odometer]: expected \"rising\", \"falling\" or \"both\""},
      {with("\"/dev/i2c-1\"", "\"\""),
       "z.toml:6:10: \"device\" in [gyro]: expected text that is not"},
      {with("\"GYRO_DRDY\"", "\"\""),
       "z.toml:13:8: \"line\" in [data_ready]: expected text that is not"},
      {with("name = \"bmi088\"", "file = \"/no/model\""),
       "z.toml:19:8: \"file\" in [model]: /no/model: No such file"},
      {with("bmi088", "bmi08"), "z.toml:19:8: \"name\" in [model]: no sensor model \"bmi08\""},
      {with("rate_hz = 4", "rate_hz = 400"), "z.toml:20:1: \"filter\": rate_hz may not exceed"},
      {with("rate_hz = 4", "rate_hz = 1e-10"),
       "z.toml:21:11: \"rate_hz\" in [filter]: expected a rate in Hz, from 0.001"},
      {with("0.25", "60"), "z.toml:20:1: \"filter\": hold_back_s is longer than the node can hold"},
      {with("0.25", "-1"), "z.toml:23:15: \"hold_back_s\" in [filter]: expected seconds"},
      {with("interval_s = 30", "interval_s = 0"),
       "z.toml:27:19: \"save_interval_s\" in [state]: expected seconds, from 1"},
      {with("priority = 40", "priority = 40.5"),
       "z.toml:29:12: \"priority\" in [real_time]: expected"},
      {with("\"json\"", "\"tcp\""),
       "z.toml:35:8: \"type\" in [sink]: expected \"json\", \"udp\", \"unix\" or \"can\""},
      {with("port = 4000", "port = 70000"), "z.toml:39:8: \"port\" in [sink]: expected"},
      {with("\"::1\"", "\"localhost\""),
       "z.toml:38:11: \"address\" in [sink]: udp: \"localhost\" is not a numeric address"},
      {with("/run/rate", std::string(200, 'r')), "z.toml:42:8: \"path\" in [sink]: unix: \"rrr"},
      {with("\"/run/zerorate/metrics.sock\"", "\"\""),
       "z.toml:33:10: \"socket\" in [metrics]: expected text that is not empty"},
      {with("\"/dev/i2c-1\"", R"("/dev/i2c\n-1")"),
       "z.toml:6:10: \"device\" in [gyro]: expected text without line breaks and other control"},
      {with("/run/rate", R"(/run\u0007rate)"),
       "z.toml:42:8: \"path\" in [sink]: expected text without line breaks and other control"},
      {with("\"can0\"", "\"an-interface-of-no-bus\""),
       "z.toml:45:13: \"interface\" in [sink]: can: \"an-interface-of-no-bus\" is not"},
      {with("0x310", "0x7FD"), "z.toml:46:6: \"id\" in [sink]: expected an identifier from 0 to"},
      {with("edge = \"both\"", "dead_band_mps = -1"),
       "z.toml:17:17: \"dead_band_mps\" in [odometer]: expected a speed in m/s"},
      {with("edge = \"both\"", "latency_s = -1"),
       "z.toml:17:13: \"latency_s\" in [odometer]: expected seconds"},
      {with("edge = \"both\"", "metres_per_pulse = 0"),
       "z.toml:17:20: \"metres_per_pulse\" in [odometer]: expected a distance in m"},
      {with("[model]", "[standstill]\nsource = \"wheel\"\n[model]"),
       "z.toml:19:10: \"source\" in [standstill]: expected \"odometer\""},
      {with("[model]", "[standstill]\nsource = \"gyro\"\n[model]"),
       "z.toml:14:1: \"odometer\": not beside [standstill] source = \"gyro\""},
      {with("[model]", "[earth]\nlatitude_deg = 91\n[model]"),
       "z.toml:19:16: \"latitude_deg\" in [earth]: expected degrees from -90 to 90"},
      {with("[model]", "[earth]\nlatitude_deg = 0\nup = \"w\"\n[model]"),
       "z.toml:20:6: \"up\" in [earth]: expected \"x\""},
      {with(kOdometer, ""), "\"odometer\": missing: what decides that the vehicle stands?"},
      {with("interface", "interfaces"), "z.toml:45:1: unknown key \"interfaces\" in [sink]"},
  };
  for (const Mistake& mistake : mistakes) {
    EXPECT_THAT(message_of(mistake.toml), HasSubstr(mistake.message));
  }
}

TEST(ConfigurationWithSeveralMistakes, IsRefusedWithAllOfThem) {
  const std::string message = message_of(R"(schema = "zerorate.daemon/1"
usr = "x"
[gyro]
chip = "lsm6dso"
bus = "i3c"
device = ""
rate_hz = 105
full_scale_dps = 251
fifos = true
[odometer]
chip = "/dev/gpiochip0"
lines = 24
[filter]
rate_hz = -1
settle_s = "a"
[[sink]]
type = "can"
[[sink]]
type = "tcp"
)");
  for (const char* const place :
       {"z.toml:2:1: ", "z.toml:5:7: ", "z.toml:6:10: ", "z.toml:7:11: ", "z.toml:8:18: ",
        "z.toml:9:1: ", "z.toml:12:1: ", "z.toml:14:11: ", "z.toml:15:12: ", "z.toml:16:1: ",
        "z.toml:19:8: "}) {
    EXPECT_THAT(message, HasSubstr(place));
  }
  EXPECT_EQ(std::ranges::count(message, '\n'), 10) << message;
}

TEST(ConfigurationWithoutHardware, NamesTheSimulatedChipAlone) {
  const std::string simulated = "schema = \"zerorate.daemon/1\"\n[gyro]\nchip = \"simulated\"\n";
  const Configuration c = parse_configuration(simulated, "z.toml");
  EXPECT_TRUE(c.gyro.is_simulated());
  EXPECT_EQ(c.gyro.rate_hz, 104.0);
  EXPECT_EQ(c.model_name, "lsm6dso");
  EXPECT_THAT(message_of(simulated + "device = \"/dev/i2c-1\"\n"),
              HasSubstr("z.toml:4:1: unknown key \"device\" in [gyro]"));
  EXPECT_THAT(
      message_of(simulated + kOdometer),
      HasSubstr("\"type\" in [odometer]: the simulated gyro brings an odometer of its own"));
}

TEST(ConfigurationWithoutHardware, MayHurryAndStayAtRest) {
  const std::string simulated = "schema = \"zerorate.daemon/1\"\n[gyro]\nchip = \"simulated\"\n";
  EXPECT_EQ(parse_configuration(simulated, "z.toml").gyro.time_factor, 1.0);
  EXPECT_TRUE(parse_configuration(simulated, "z.toml").gyro.drives);
  const Configuration c =
      parse_configuration(simulated + "time_factor = 20\ndrives = false\n", "z.toml");
  EXPECT_EQ(c.gyro.time_factor, 20.0);
  EXPECT_FALSE(c.gyro.drives);
  EXPECT_THAT(message_of(simulated + "time_factor = 0.5\n"), HasSubstr("a factor from 1 to 100"));
  const std::string messages =
      "[odometer]\ntype = \"udp\"\naddress = \"127.0.0.1\"\nport = 4000\ndead_band_mps = 0.1\n"
      "latency_s = 0\n";
  EXPECT_THAT(message_of(simulated + "time_factor = 2\n" + messages),
              HasSubstr("messages come in real time: time_factor of [gyro] must be 1"));
}

constexpr const char* kCan = R"([odometer]
type = "can"
interface = "can0"
id = 0x1A0
start_bit = 7
length = 16
byte_order = "big"
scale_mps = 0.01
dead_band_mps = 0.3
latency_s = 0.1
)";

std::string with_can(const std::string& piece, const std::string& replacement) {
  std::string can = kCan;
  return with(kOdometer, can.replace(can.find(piece), piece.size(), replacement));
}

TEST(ConfigurationOfASpeedOnCan, IsReadAsItStandsThere) {
  const Configuration c = parse_configuration(with(kOdometer, kCan), "z.toml");
  EXPECT_FALSE(c.odometer);
  ASSERT_TRUE(c.speed);
  EXPECT_EQ(name_of(c.speed->origin), "can:can0 id 0x1a0");
  EXPECT_TRUE(std::get<CanSignal>(c.speed->origin).is_big_endian);
  EXPECT_EQ(c.speed->dead_band_mps, 0.3);
  EXPECT_EQ(c.speed->timeout, core::Duration::seconds(1));
  EXPECT_EQ(c.node.standstill.hold_back.ns() / 1'000'000, 250 + 100 + 300);
}

TEST(ConfigurationOfASpeedOnCan, IsRefusedWhereTheSignalCannotBe) {
  EXPECT_THAT(message_of(with_can("start_bit = 7", "start_bit = 57")),
              HasSubstr("\"length\" in [odometer]: the signal does not fit into eight bytes"));
  EXPECT_THAT(message_of(with_can("0x1A0", "0x800")), HasSubstr("\"id\" in [odometer]: expected"));
  EXPECT_THAT(message_of(with_can("scale_mps = 0.01", "scale_mps = 0")),
              HasSubstr("\"scale_mps\" in [odometer]: expected the value of one count"));
  EXPECT_THAT(message_of(with_can("dead_band_mps = 0.3\n", "")),
              HasSubstr("missing \"dead_band_mps\" in [odometer]"));
  EXPECT_THAT(message_of(with_can("latency_s = 0.1\n", "")),
              HasSubstr("missing \"latency_s\" in [odometer]"));
}

TEST(ConfigurationOfAnOdometer, HoldsBackByWhatIsKnownOfIt) {
  const Configuration c = parse_configuration(
      with("edge = \"both\"", "dead_band_mps = 0.75\nlatency_s = 0.1\nmetres_per_pulse = 0.05"),
      "z.toml");
  EXPECT_EQ(c.node.standstill.hold_back, core::Duration::milliseconds(1100));
  EXPECT_LT(c.node.standstill.slowest, core::Duration::milliseconds(134));
  EXPECT_EQ(c.node.standstill.source, core::StandstillSource::odometer);
}

TEST(ConfigurationAtALatitude, KnowsTheEarthsRotation) {
  const Configuration c = parse_configuration(
      with("[model]", "[earth]\nlatitude_deg = 60.2\nup = \"-x\"\n[model]"), "z.toml");
  EXPECT_EQ(c.node.earth, core::earth_rate(60.2F, {.axis = 0, .points_down = true}));
  EXPECT_EQ(c.node.up, (core::UpAxis{.axis = 0, .points_down = true}));
}

TEST(ConfigurationWithoutAnOdometer, TakesTheCalmOfTheGyro) {
  const Configuration c =
      parse_configuration(with(kOdometer, "[standstill]\nsource = \"gyro\"\n"), "z.toml");
  EXPECT_FALSE(c.odometer);
  EXPECT_EQ(c.node.standstill.source, core::StandstillSource::gyro);
}

TEST(ConfigurationsOfSeveralNodes, HaveNamesOfTheirOwn) {
  const zerorate::testing::ScratchFolder folder;
  const auto file = [&](const std::string& name, const std::string& more) {
    std::string path = (folder.path() / name).string();
    std::ofstream{path} << more << "schema = \"zerorate.daemon/1\"\n[gyro]\nchip = \"simulated\"\n";
    return path;
  };
  const std::string front = file("a.toml", "name = \"front\"\nuser = \"u\"\n");
  const std::string rear = file("rear.toml", "");
  const auto two = read_configurations({front, rear});
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0].name, "front");
  EXPECT_EQ(two[1].name, "rear");
  EXPECT_EQ(read_configurations({rear}).front().name, "") << "the only one needs none";
  for (const auto& bad : {std::pair{file("b.toml", "name = \"front\"\n"), "one name, \"front\""},
                          std::pair{file("c.toml", "user = \"v\"\n"), "\"user\" is another one"},
                          std::pair{file("no name.toml", ""), "is no name for a node"}}) {
    EXPECT_THAT(
        [&] {
          (void)read_configurations({front, bad.first});
        },
        ::testing::ThrowsMessage<std::invalid_argument>(HasSubstr(bad.second)));
  }
}

TEST(ConfigurationWithFastSpi, IsRefusedBeyondTheChipsLimit) {
  const std::string toml = with("bus = \"i2c\"", "bus = \"spi\"");
  const std::string fast = [&] {
    std::string text = toml;
    const std::string address = "address = 0x6B";
    return text.replace(text.find(address), address.size(), "speed_hz = 20_000_000");
  }();
  EXPECT_THAT(message_of(fast),
              HasSubstr("z.toml:7:12: \"speed_hz\" in [gyro]: the chip takes at most 10000000"));
}

}  // namespace
}  // namespace zerorate::linux_node
