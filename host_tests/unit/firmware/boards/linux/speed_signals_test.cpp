#include "firmware/boards/linux/speed_signals.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/speed_source.hpp"

namespace zerorate::linux_node {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(SpeedInADatagram, IsTheFastestOfSeveralNumbersOrAWord) {
  EXPECT_EQ(decode_text(" -1.5\n"), 1.5);
  EXPECT_EQ(decode_text("still\n"), 0.0);
  EXPECT_EQ(decode_text("moving"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(decode_text("0 0.0\t-0.25 0.1"), 0.25);
  EXPECT_EQ(decode_text("0 0 0 0"), 0.0);
  for (const char* const text : {"", " ", "nan", "inf", "1,5", "1.5 m/s", "Still", "1e999", "0 nan",
                                 "0 still", "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0"}) {
    EXPECT_FALSE(decode_text(text)) << text;
  }
}

constexpr std::uint32_t kWheels = 0x1A0;
constexpr std::uint32_t kEngine = 0x2B0;

SpeedSignal byte_of(std::uint32_t id, unsigned byte, SignalRole role = SignalRole::speed) {
  SpeedSignal signal;
  signal.signal.id = id;
  signal.signal.start_bit = 8 * byte;
  signal.signal.length = 8;
  signal.signal.scale = 0.1;
  signal.role = role;
  return signal;
}

/// Signals with a dead band of 0.25 m/s and a timeout of 1 s.
class Signals : public ::testing::Test {
 protected:
  void watch(const std::vector<SpeedSignal>& signals) { signals_.emplace(signals, 0.25); }

  bool hear(double at_s, std::uint32_t id, std::vector<std::uint8_t> payload) {
    return signals_->hear({.id = id, .payload = payload}, at(at_s));
  }
  [[nodiscard]] bool is_known(double at_s) const {
    return signals_->is_known(at(at_s), core::Duration::seconds(1));
  }
  static core::Instant at(double time_s) {
    return core::Instant::from_ns(static_cast<std::int64_t>(time_s * 1e9));
  }

  std::optional<SpeedSignals> signals_;
};

TEST_F(Signals, ShowMotionByAnyWheel) {
  watch({byte_of(kWheels, 0), byte_of(kWheels, 1)});
  EXPECT_FALSE(is_known(0.0));
  EXPECT_FALSE(hear(0.0, kWheels, {0, 0}));
  EXPECT_TRUE(is_known(1.0));
  EXPECT_FALSE(is_known(1.1));
  EXPECT_FALSE(hear(2.0, kWheels, {2, 2}));
  EXPECT_TRUE(hear(2.1, kWheels, {0, 3}));
  EXPECT_TRUE(hear(2.2, kWheels, {3, 0}));
  EXPECT_FALSE(hear(2.3, kEngine, {9, 9}));
}

TEST_F(Signals, AreUnknownWhileOneOfThemIsSilentOrInvalid) {
  auto right = byte_of(kEngine, 0);
  right.invalid_from = 0xFE;
  watch({byte_of(kWheels, 0), right});
  EXPECT_FALSE(hear(0.0, kWheels, {0}));
  EXPECT_FALSE(is_known(0.0));
  EXPECT_FALSE(hear(0.0, kEngine, {0xFF}));
  EXPECT_TRUE(signals_->was_refused());
  EXPECT_FALSE(is_known(0.0));
  EXPECT_TRUE(hear(0.1, kEngine, {0xFD}));
  EXPECT_TRUE(is_known(0.1));
  EXPECT_FALSE(hear(0.9, kWheels, {0}));
  EXPECT_FALSE(is_known(1.2));
  EXPECT_FALSE(hear(1.3, kEngine, {}));
  EXPECT_TRUE(signals_->was_refused());
}

TEST_F(Signals, AreUnknownWhereTheVehicleCallsThemInvalid) {
  auto ignition = byte_of(kEngine, 0, SignalRole::valid);
  ignition.valid_value = 4;
  watch({byte_of(kWheels, 0), ignition});
  EXPECT_FALSE(hear(0.0, kWheels, {0}));
  EXPECT_FALSE(is_known(0.0));
  EXPECT_TRUE(signals_->is_valid());
  EXPECT_FALSE(hear(0.0, kEngine, {4}));
  EXPECT_TRUE(is_known(0.0));
  EXPECT_FALSE(hear(0.1, kEngine, {5}));
  EXPECT_FALSE(is_known(0.1));
  EXPECT_FALSE(signals_->is_valid());
}

TEST_F(Signals, OfAFrameThatIsSentAgainDoNotCount) {
  watch({byte_of(kWheels, 0), byte_of(kWheels, 1, SignalRole::counter)});
  EXPECT_FALSE(hear(0.0, kWheels, {0, 14}));
  EXPECT_TRUE(is_known(0.0));
  EXPECT_FALSE(hear(0.9, kWheels, {9, 14}));
  EXPECT_TRUE(signals_->was_refused());
  EXPECT_FALSE(is_known(1.1));
  EXPECT_TRUE(hear(1.2, kWheels, {9, 15}));
  EXPECT_TRUE(is_known(1.2));
}

TEST_F(Signals, StandOnlyInFramesOfTheirMultiplexer) {
  auto wheel = byte_of(kWheels, 1);
  wheel.multiplexer.emplace();
  wheel.multiplexer->signal.length = 4;
  wheel.multiplexer->value = 2;
  watch({wheel});
  EXPECT_FALSE(hear(0.0, kWheels, {0x11, 9}));
  EXPECT_FALSE(is_known(0.0));
  EXPECT_TRUE(hear(0.0, kWheels, {0x12, 9}));
  EXPECT_TRUE(is_known(0.0));
}

constexpr const char* kConfiguration = R"(schema = "zerorate.daemon/1"
[gyro]
chip = "simulated"
[[sink]]
type = "json"
[odometer]
type = "can"
interface = "can0"
dead_band_mps = 0.3
latency_s = 0.1
)";

constexpr const char* kSignals = R"([[odometer.signal]]
id = 0x1A0
start_bit = 7
length = 16
byte_order = "big"
scale_mps = 0.01
invalid_from = 0xFFFE
[[odometer.signal]]
id = 0x1A0
role = "counter"
start_bit = 48
length = 4
byte_order = "little"
[[odometer.signal]]
id = 0x2B0
role = "valid"
start_bit = 8
length = 3
byte_order = "little"
value = 4
multiplexer = {start_bit = 0, length = 4, byte_order = "little", value = 2}
)";

TEST(ConfigurationOfSpeedSignals, IsReadAsItStandsThere) {
  const Configuration c = parse_configuration(std::string(kConfiguration) + kSignals, "z.toml");
  ASSERT_TRUE(c.speed);
  EXPECT_EQ(name_of(c.speed->origin), "can:can0 ids 0x1a0, 0x2b0");
  EXPECT_THAT(std::get<CanFrames>(c.speed->origin).ids, ElementsAre(0x1A0U, 0x2B0U));
  ASSERT_EQ(c.speed->signals.size(), 3U);
  EXPECT_EQ(c.speed->signals[0].invalid_from, 0xFFFEU);
  EXPECT_EQ(c.speed->signals[0].signal.scale, 0.01);
  EXPECT_EQ(c.speed->signals[1].role, SignalRole::counter);
  EXPECT_EQ(c.speed->signals[2].valid_value, 4U);
  EXPECT_EQ(c.speed->signals[2].multiplexer->value, 2U);
}

std::string message_with(const std::string& piece, const std::string& replacement) {
  std::string signals = kSignals;
  signals.replace(signals.find(piece), piece.size(), replacement);
  try {
    static_cast<void>(parse_configuration(kConfiguration + signals, "z.toml"));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "none";
}

TEST(ConfigurationOfSpeedSignals, IsRefusedWhereItCannotBe) {
  EXPECT_THAT(message_with("value = 4\n", ""), HasSubstr("missing \"value\""));
  EXPECT_THAT(message_with("role = \"valid\"", "role = \"gear\""), HasSubstr("\"role\""));
  EXPECT_THAT(message_with("start_bit = 48", "start_bit = 62"),
              HasSubstr("the signal does not fit into eight bytes"));
  EXPECT_THAT(message_with("role = \"counter\"", "role = \"counter\"\nscale_mps = 1"),
              HasSubstr("unknown key \"scale_mps\""));
  EXPECT_THAT(message_with("scale_mps = 0.01\ninvalid_from = 0xFFFE", "role = \"counter\""),
              HasSubstr("at least one of them has to have the role \"speed\""));
}

}  // namespace
}  // namespace zerorate::linux_node
