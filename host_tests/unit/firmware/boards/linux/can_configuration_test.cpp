/// @file
/// Sinks of CAN in a configuration, and the DBC files of their frames.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/outputs/can_dbc.hpp"
#include "firmware/toml/error.hpp"

namespace zerorate::linux_node {
namespace {

using ::testing::HasSubstr;

Configuration with_sink(const std::string& keys, const std::string& tables = "") {
  return parse_configuration(R"(schema = "zerorate.daemon/1"
[gyro]
chip = "lsm6dso"
bus = "spi"
device = "/dev/spidev0.0"
rate_hz = 104
full_scale_dps = 250
[odometer]
chip = "/dev/gpiochip0"
line = 17
[[sink]]
type = "can"
interface = "can0"
)" + keys + tables,
                             "z.toml");
}

std::string refusal_of_sink(const std::string& keys, const std::string& tables = "") {
  try {
    (void)with_sink(keys, tables);
  } catch (const toml_file::Error& error) {
    return error.what();
  }
  return "";
}

CanSettings can_of(const Configuration& configuration) {
  return std::get<CanSettings>(configuration.sinks.at(0));
}

TEST(CanSinkInAConfiguration, HasLayoutDividerAndProtection) {
  const Configuration c =
      with_sink("id = 0x123\nlayout = \"yaw\"\nevery = 10\nup = \"-x\"\ne2e_variant = \"11A\"\n");
  EXPECT_EQ(can_of(c).layout, CanLayout::yaw);
  EXPECT_EQ(can_of(c).every, 10U);
  EXPECT_EQ(can_of(c).e2e.data_id, 0x123);
  EXPECT_EQ(can_of(c).e2e.variant, wire::E2eVariant::both);
  ASSERT_TRUE(c.node.up);
  EXPECT_EQ(c.node.up->direction(), (core::Direction{-1.0F, 0.0F, 0.0F}));
  EXPECT_EQ(can_of(with_sink("layout = \"fd\"\ne2e_data_id = 0x456\n")).e2e.data_id, 0x456);
}

TEST(CanSinkInAConfiguration, IsRefusedWhereItCannotBe) {
  EXPECT_THAT(refusal_of_sink("layout = \"yaw\"\n"), HasSubstr("nothing shows the vertical"));
  EXPECT_THAT(refusal_of_sink("layout = \"fd\"\nid = 0x80\n"),
              HasSubstr("\"e2e_data_id\" in [sink]: 0x080 by \"id\": variant 11C takes"));
  EXPECT_THAT(refusal_of_sink("layout = \"fd\"\ne2e_data_id = 0xF00\n"), HasSubstr("0xf00"));
  EXPECT_THAT(refusal_of_sink("every = 0\n"), HasSubstr("from 1 to 10 000"));
  EXPECT_THAT(refusal_of_sink("e2e_data_id = 0x200\n"), HasSubstr("e2e_data_id"));
  EXPECT_THAT(refusal_of_sink("layout = \"one\"\n"), HasSubstr("axes"));
  EXPECT_THAT(refusal_of_sink("up = \"x\"\n",
                              "[[sink]]\ntype = \"can\"\ninterface = \"can1\"\nup = \"z\"\n"),
              HasSubstr("another axis"));
  EXPECT_THAT(refusal_of_sink("up = \"x\"\n", "[earth]\nlatitude_deg = 52\nup = \"z\"\n"),
              HasSubstr("not the axis"));
}

std::string text_of(const std::string& name) {
  std::ifstream file{std::string{ZERORATE_REPOSITORY "/firmware/wire/"} + name};
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string dbc_of(const std::string& keys) {
  const CanSettings can = can_of(with_sink(keys));
  return format_dbc({&can, 1}, {.rate_hz = 104.0, .receivers = {}});
}

/// `zerorate export --dbc` makes them anew.
TEST(DbcFilesThatAreInstalled, AreThoseOfEachLayout) {
  EXPECT_EQ(dbc_of(""), text_of("zerorate.dbc"));
  EXPECT_EQ(dbc_of("layout = \"yaw\"\nup = \"z\"\n"), text_of("zerorate_yaw.dbc"));
  EXPECT_EQ(dbc_of("layout = \"fd\"\n"), text_of("zerorate_fd.dbc"));
}

TEST(DbcFile, RefusesFramesThatShareAnIdentifierAndOddReceivers) {
  const CanSettings axes{.interface = "can0", .id = 0x300};
  CanSettings yaw{.interface = "can0", .id = 0x2FF, .layout = CanLayout::yaw};
  const auto dbc = [&](const std::string& receiver) {
    const std::array both{axes, yaw};
    return format_dbc(both, {.rate_hz = 100.0, .receivers = {receiver}});
  };
  EXPECT_THAT(dbc("BRAKE"), HasSubstr("BO_ 767 ZERORATE_YAW: 8 ZERORATE"));
  EXPECT_THROW((void)dbc("brake pedal"), std::invalid_argument);
  EXPECT_THROW((void)dbc("2ND"), std::invalid_argument);
  EXPECT_THROW((void)dbc("ZERORATE"), std::invalid_argument);
  yaw.id = 0x305;
  EXPECT_THROW((void)dbc("BRAKE"), std::invalid_argument);
}

}  // namespace
}  // namespace zerorate::linux_node
