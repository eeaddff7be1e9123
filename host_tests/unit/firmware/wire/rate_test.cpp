#include "firmware/wire/rate_frame.hpp"

#include <gtest/gtest.h>

#include <zlib.h>
#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "firmware/wire/rate_text.hpp"
#include "host_tests/unit/firmware/wire/messages.hpp"

namespace zerorate::wire {
namespace {

using testing::random_message;

TEST(RateFrameOfAnyMessage, IsReadBackBitForBit) {
  std::mt19937_64 random{1};
  for (int i = 0; i < 1000; ++i) {
    const NumberedMessage sent = random_message(random);
    const auto received = decode_rate_frame(encode_rate_frame(sent).bytes());
    ASSERT_TRUE(received);
    EXPECT_EQ(*received, sent);
  }
}

TEST(RateFrameWithoutCalibration, CarriesAnInfiniteSigma) {
  NumberedMessage sent;
  sent.message.axes[1].sigma = core::rad_per_s(std::numeric_limits<float>::infinity());
  EXPECT_EQ(*decode_rate_frame(encode_rate_frame(sent).bytes()), sent);
}

std::vector<std::uint8_t> bytes_of(const RateFrame& frame) {
  return {frame.bytes().begin(), frame.bytes().end()};
}

TEST(RateFrame, LiesInTheBytesThatItsPageNames) {
  NumberedMessage sent{.sequence = 0x01020304, .message = {}};
  sent.message.time = core::Instant::from_ns(0x0123456789ABCDEF);
  sent.message.motion = core::Motion::still;
  sent.message.health.calibrated = true;
  sent.message.health.sensor_fault = true;
  sent.message.health.odometer_dead_band = true;
  sent.message.calm_percent = 87;
  sent.message.axes[0].measured = core::rad_per_s(1.0F);
  sent.message.axes[2].sigma = core::rad_per_s(-2.0F);
  sent.message.temperature = core::Temperature::from_degc(25.5F);
  sent.message.odometer_pulses = 0x0A0B0C0D;
  sent.message.turn[1].angle = core::rad(-2.0F);
  sent.message.turn_time = core::Duration::nanoseconds(0x0123456789ABCDEF);
  sent.message.heading = {.angle = core::rad(1.0F), .sigma = core::rad(-2.0F)};
  const std::vector<std::uint8_t> frame = bytes_of(encode_rate_frame(sent));
  ASSERT_EQ(frame.size(), 120U);
  const std::vector<std::uint8_t> head(frame.begin(), frame.begin() + 24);
  EXPECT_EQ(head, (std::vector<std::uint8_t>{'Z',  'R',  5,    0x03, 0x04, 0x03, 0x02, 0x01,
                                             0xEF, 0xCD, 0xAB, 0x89, 0x67, 0x45, 0x23, 0x01,
                                             2,    0x41, 0x04, 87,   0,    0,    0x80, 0x3F}));
  EXPECT_EQ(frame[66], 0x00);  // -2.0F = 0xC0000000, sigma of z
  EXPECT_EQ(frame[67], 0xC0);
  const std::vector<std::uint8_t> inputs(frame.begin() + 68, frame.begin() + 76);
  EXPECT_EQ(inputs, (std::vector<std::uint8_t>{0, 0, 0xCC, 0x41, 0x0D, 0x0C, 0x0B, 0x0A}));
  std::uint32_t checksum = 0;
  EXPECT_EQ(frame[87], 0xC0);  // -2.0F, turn of y
  const std::vector<std::uint8_t> time(frame.begin() + 100, frame.begin() + 108);
  EXPECT_EQ(time, (std::vector<std::uint8_t>{0xEF, 0xCD, 0xAB, 0x89, 0x67, 0x45, 0x23, 0x01}));
  const std::vector<std::uint8_t> heading(frame.begin() + 108, frame.begin() + 116);
  EXPECT_EQ(heading, (std::vector<std::uint8_t>{0, 0, 0x80, 0x3F, 0, 0, 0, 0xC0}));
  std::memcpy(&checksum, &frame[116], 4);  // the test runs on little-endian machines
  EXPECT_EQ(checksum, ::crc32(0, frame.data(), 116));
}

TEST(RateFrameWithEveryBlock, HasThemInTheOrderOfItsPage) {
  NumberedMessage sent;
  sent.message.up = core::Direction{1.0F, 2.0F, 3.0F};
  sent.message.vertical_turn = {.angle = core::rad(4.0F), .sigma = core::rad(5.0F)};
  sent.message.acceleration =
      std::array{core::m_per_s2(6.0F), core::m_per_s2(7.0F), core::m_per_s2(8.0F)};
  sent.message.vibration = core::m_per_s2(9.0F);
  sent.message.slope = core::rad(19.0F);
  float figure = 10.0F;
  for (app::ExplainedBias& axis : sent.message.explained.emplace()) {
    for (auto* const share : {&axis.temperature, &axis.acceleration, &axis.vibration}) {
      *share = core::rad_per_s(figure++);
    }
  }
  const std::vector<std::uint8_t> frame = bytes_of(encode_rate_frame(sent));
  ASSERT_EQ(frame.size(), 196U);
  EXPECT_EQ(frame[3], 0x7C);
  std::array<float, 19> figures{};
  std::memcpy(figures.data(), &frame[116], 76);  // the test runs on little-endian machines
  for (std::size_t i = 0; i < figures.size(); ++i) EXPECT_EQ(figures[i], static_cast<float>(i + 1));
}

/// Puts the checksum behind the bytes.
std::vector<std::uint8_t> checked(std::vector<std::uint8_t> bytes) {
  const auto checksum =
      static_cast<std::uint32_t>(::crc32(0, bytes.data(), static_cast<uInt>(bytes.size())));
  bytes.resize(bytes.size() + 4);
  std::memcpy(&bytes[bytes.size() - 4], &checksum, 4);
  return bytes;
}
/// The frame of an older node: without the last values.
std::vector<std::uint8_t> older(const RateFrame& frame, std::uint8_t version, std::size_t size) {
  std::vector<std::uint8_t> old = bytes_of(frame);
  old.resize(size);
  old[2] = version;
  old[3] = version == 1 ? 0 : old[3] & 3;
  return checked(old);
}
void without_accelerometer(app::RateMessage& message) {
  message.up.reset();
  message.vertical_turn = {};
  message.slope.reset();
  message.acceleration.reset();
  message.vibration.reset();
  message.explained.reset();
}
void without_heading(app::RateMessage& message) {
  message.heading = {};
  without_accelerometer(message);
}
void without_turn(app::RateMessage& message) {
  message.turn = {};
  message.turn_time = {};
  without_heading(message);
}
void without_inputs(app::RateMessage& message) {
  message.temperature.reset();
  message.odometer_pulses.reset();
  without_turn(message);
}
std::vector<std::uint8_t> version_1(const RateFrame& frame) {
  return older(frame, 1, 68);
}

/// Random messages, read back as a node of that version sent them.
/// @param forget takes out of a message what that version does not have
void expect_reading(std::uint8_t version, std::size_t size, std::uint64_t seed,
                    void (*forget)(app::RateMessage&)) {
  std::mt19937_64 random{seed};
  for (int i = 0; i < 100; ++i) {
    NumberedMessage sent = random_message(random);
    const auto received = decode_rate_frame(older(encode_rate_frame(sent), version, size));
    ASSERT_TRUE(received);
    forget(sent.message);
    EXPECT_EQ(*received, sent);
  }
}

/// Verifies SR-IF-12.
TEST(RateFrameOfVersion4, IsReadWithoutTheAccelerometer) {
  expect_reading(4, 116, 6, without_accelerometer);
}

TEST(RateFrameOfVersion4, HasTheVerticalAsAnAxis) {
  std::vector<std::uint8_t> frame = bytes_of(encode_rate_frame({}));
  frame.resize(116);
  frame[2] = 4;
  frame[3] = 0x2C;  // given, y, down
  EXPECT_EQ(decode_rate_frame(checked(frame))->message.up, (core::Direction{0.0F, -1.0F, 0.0F}));
  frame[3] = 0x1C;  // no axis
  EXPECT_EQ(decode_rate_frame(checked(frame)).error(), FrameError::impossible_value);
}

/// Verifies SR-IF-12.
TEST(RateFrameOfVersion3, IsReadWithoutTheHeading) {
  expect_reading(3, 108, 5, without_heading);
}

/// Verifies SR-IF-12.
TEST(RateFrameOfVersion2, IsReadWithoutTheTurn) {
  expect_reading(2, 76, 4, without_turn);
}

/// Verifies SR-IF-12.
TEST(RateFrameOfVersion1, IsReadWithoutTemperatureAndPulses) {
  expect_reading(1, 68, 3, without_inputs);
  std::vector<std::uint8_t> damaged = version_1(encode_rate_frame({}));
  damaged[40] ^= 1;
  EXPECT_EQ(decode_rate_frame(damaged).error(), FrameError::wrong_checksum);
}

/// Verifies SR-IF-11.
TEST(RateFrameWithAnyWrongBit, IsRefused) {
  std::mt19937_64 random{2};
  const std::vector<std::uint8_t> good = bytes_of(encode_rate_frame(random_message(random)));
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::vector<std::uint8_t> bad = good;
    bad[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    EXPECT_FALSE(decode_rate_frame(bad)) << bit;
  }
}

/// Verifies SR-IF-12.
TEST(BytesThatAreNoRateFrame, AreRefusedForTheirReason) {
  const auto reason = [](const std::vector<std::uint8_t>& bytes) {
    return decode_rate_frame(bytes).error();
  };
  const std::vector<std::uint8_t> bytes = bytes_of(encode_rate_frame({}));
  EXPECT_EQ(reason({}), FrameError::wrong_size);
  EXPECT_EQ(reason({bytes.begin(), bytes.end() - 1}), FrameError::wrong_size);
  auto changed = bytes;
  changed[0] = 'z';
  EXPECT_EQ(reason(changed), FrameError::not_a_frame);
  changed = bytes;
  for (const std::uint8_t version : {std::uint8_t{0}, std::uint8_t{6}}) {
    changed[2] = version;
    EXPECT_EQ(reason(changed), FrameError::unknown_version);
  }
  changed = bytes;
  changed[3] = 4;  // a direction, for which there is no room
  EXPECT_EQ(reason(changed), FrameError::wrong_size);
  changed = bytes;
  changed[30] ^= 1;
  EXPECT_EQ(reason(changed), FrameError::wrong_checksum);
  changed = bytes;
  changed.resize(116);
  changed[16] = 3;  // no motion, under a checksum that fits
  EXPECT_EQ(reason(checked(changed)), FrameError::impossible_value);
}

std::string line_of(const app::RateMessage& message) {
  TextLine text{};
  const auto line = write_rate(message, text);
  return {line.begin(), line.end()};
}

app::RateMessage message_with(float x_dps, float y_dps, float z_dps) {
  app::RateMessage message{.time = core::Instant::from_ns(12'345'678'901),
                           .motion = core::Motion::still,
                           .health = {.calibrated = true}};
  message.axes[0].corrected = core::deg_per_s(x_dps);
  message.axes[1].corrected = core::deg_per_s(y_dps);
  message.axes[2].corrected = core::deg_per_s(z_dps);
  return message;
}

TEST(RateText, ShowsTimeMotionAndCorrectedRates) {
  EXPECT_EQ(line_of(message_with(1.5F, -0.00002F, 245.0F)),
            "     12.345 s  still    +   1.50000 -   0.00002 + 245.00000 deg/s\r\n");
}

TEST(RateTextOfWhatHasNoFiveDecimals, ShowsDashes) {
  EXPECT_EQ(line_of(message_with(std::numeric_limits<float>::quiet_NaN(),
                                 std::numeric_limits<float>::infinity(), -1e6F)),
            "     12.345 s  still     ----.-----  ----.-----  ----.----- deg/s\r\n");
}

TEST(RateTextBeforeTheFirstCalibration, EndsWithAQuestionMark) {
  app::RateMessage message = message_with(0.0F, 0.0F, 0.0F);
  message.health.calibrated = false;
  message.motion = core::Motion::moving;
  EXPECT_EQ(line_of(message),
            "     12.345 s  moving   +   0.00000 +   0.00000 +   0.00000 deg/s ?\r\n");
}

TEST(RateTextOfAnythingUnhealthy, EndsWithAnExclamationMark) {
  app::RateMessage message = message_with(0.0F, 0.0F, 0.0F);
  message.health.saturated = true;
  EXPECT_TRUE(line_of(message).ends_with(" deg/s !\r\n"));
}

TEST(RateTextAtItsLongest, FitsItsLine) {
  app::RateMessage message = message_with(9999.0F, -9999.0F, -9999.0F);
  message.time = core::Instant::from_ns(std::numeric_limits<std::int64_t>::max());
  message.motion = core::Motion::settling;
  message.health = {.saturated = true};
  EXPECT_LE(line_of(message).size(), TextLine{}.size());
}

}  // namespace
}  // namespace zerorate::wire
