// References of the heading as zerorated is configured for them, and as they come.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/reference_source.hpp"

namespace zerorate::linux_node {
namespace {

using ::testing::HasSubstr;

/// A configuration of the simulated gyro, with a piece of its references replaced.
std::string with_reference(const std::string& piece, const std::string& replacement) {
  std::string toml = R"(schema = "zerorate.daemon/1"
[gyro]
chip = "simulated"
[reference]
type = "udp"
address = "127.0.0.1"
port = 4001
up = "-y"
sense = "clockwise"
sigma_deg = 0.5
latency_s = 0.2
)";
  return toml.replace(toml.find(piece), piece.size(), replacement);
}
std::string refusal_of(const std::string& toml) {
  try {
    (void)parse_configuration(toml, "z.toml");
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(ConfigurationOfReferences, IsReadAsItStandsThere) {
  const Configuration c = parse_configuration(with_reference("udp", "udp"), "z.toml");
  ASSERT_TRUE(c.reference);
  EXPECT_EQ(name_of(c.reference->origin), "udp:127.0.0.1:4001");
  EXPECT_TRUE(c.reference->counts_clockwise);
  EXPECT_EQ(c.reference->sigma, core::deg(0.5F));
  EXPECT_EQ(c.reference->latency, core::Duration::milliseconds(200));
  EXPECT_EQ(c.node.up->axis, 1);
  EXPECT_TRUE(c.node.up->points_down);
}

TEST(ConfigurationOfReferences, HasTheAxisThatPointsUpOfTheEarth) {
  const auto with_earth = [](const std::string& up) {
    return with_reference("[reference]", "[earth]\nlatitude_deg = 60\n" + up + "[reference]");
  };
  EXPECT_EQ(refusal_of(with_earth("up = \"-y\"\n")), "");
  EXPECT_THAT(refusal_of(with_earth("up = \"y\"\n")),
              HasSubstr("z.toml:6:6: \"up\" in [earth]: not the axis of \"up\" in [reference]"));
  EXPECT_THAT(refusal_of(with_earth("")), HasSubstr("z.toml:4:1: \"up\" in [earth]: not the axis"));
}

TEST(ConfigurationOfReferences, MayNameASignalOnCan) {
  const Configuration c = parse_configuration(
      with_reference("type = \"udp\"\naddress = \"127.0.0.1\"\nport = 4001\n",
                     "type = \"can\"\ninterface = \"can0\"\nid = 0x1A0\nstart_bit = 0\n"
                     "length = 16\nbyte_order = \"little\"\nscale_deg = 0.01\n"),
      "z.toml");
  EXPECT_EQ(std::get<CanSignal>(c.reference->origin).scale, 0.01);
}

TEST(ConfigurationOfReferences, GuessesNothing) {
  for (const char* const key :
       {"up = \"-y\"\n", "sense = \"clockwise\"\n", "sigma_deg = 0.5\n", "latency_s = 0.2\n"}) {
    EXPECT_THAT(refusal_of(with_reference(key, "")), HasSubstr("in [reference]")) << key;
  }
  EXPECT_THAT(refusal_of(with_reference("latency_s = 0.2", "latency_s = 2")),
              HasSubstr("\"latency_s\" in [reference]: expected seconds, from 0 to 1.5"));
  EXPECT_THAT(
      refusal_of(with_reference("chip = \"simulated\"", "chip = \"simulated\"\ntime_factor = 2")),
      HasSubstr("messages come in real time"));
}

const ReferenceSettings kCompass{.counts_clockwise = true,
                                 .sigma = core::deg(0.5F),
                                 .latency = core::Duration::milliseconds(200)};
constexpr core::Instant kNow = core::Instant::from_ns(100'000'000'000);

TEST(ReferenceInADatagram, IsAHeadingWithOrWithoutADeviation) {
  for (const char* const text : {"271.5", " 271.5 0.5\n", "-88.5", "631.5 0.5"}) {
    const auto reference = decode_reference(kCompass, std::string_view{text}, kNow);
    ASSERT_TRUE(reference) << text;
    const auto& heading = std::get<app::HeadingReference>(*reference);
    EXPECT_NEAR(heading.heading.in(core::deg), 88.5F, 1e-4F) << text;
    EXPECT_EQ(heading.sigma, core::deg(0.5F));
    EXPECT_EQ(heading.time, kNow - core::Duration::milliseconds(200));
  }
}

TEST(ReferenceInADatagram, IsATurnOfTheNewestSeconds) {
  const auto reference = decode_reference(kCompass, std::string_view{"turn -720 2 35.5"}, kNow);
  ASSERT_TRUE(reference);
  const auto& turn = std::get<app::TurnReference>(*reference);
  EXPECT_NEAR(turn.angle.in(core::deg), 720.0F, 1e-3F);
  EXPECT_EQ(turn.sigma, core::deg(2.0F));
  EXPECT_EQ(turn.to - turn.from, core::Duration::milliseconds(35'500));
  EXPECT_EQ(time_of(*reference), kNow - core::Duration::milliseconds(200));
}

TEST(ReferenceInADatagram, IsNothingElse) {
  for (const char* const text :
       {"", "north", "nan", "1 2 3", "1 0", "1 -1", "1 91", "1e9", "turn", "turn 1 2", "turn 1 2 0",
        "turn 1 2 3 4", "turn x 2 3", "Turn 1 2 3"}) {
    EXPECT_FALSE(decode_reference(kCompass, std::string_view{text}, kNow)) << text;
  }
}

TEST(ReferenceOnCan, IsAHeading) {
  const auto reference = decode_reference(kCompass, 90.0, kNow);
  ASSERT_TRUE(reference);
  EXPECT_NEAR(std::get<app::HeadingReference>(*reference).heading.in(core::deg), -90.0F, 1e-4F);
  EXPECT_FALSE(decode_reference(kCompass, std::numeric_limits<double>::infinity(), kNow));
}

}  // namespace
}  // namespace zerorate::linux_node
