#include "firmware/wire/rate_frame.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <vector>

#include "host_tests/unit/firmware/wire/messages.hpp"

namespace zerorate::wire {
namespace {

using testing::random_message;

TEST(RateFrameOfAnyMessage, IsReadBackBitForBit) {
  std::mt19937_64 random{1};
  for (int i = 0; i < 1000; ++i) {
    const NumberedMessage sent = random_message(random);
    const auto received = decode_rate_frame(encode_rate_frame(sent));
    ASSERT_TRUE(received);
    EXPECT_EQ(*received, sent);
  }
}

TEST(RateFrameWithoutCalibration, CarriesAnInfiniteSigma) {
  NumberedMessage sent;
  sent.message.axes[1].sigma = core::rad_per_s(std::numeric_limits<float>::infinity());
  EXPECT_EQ(*decode_rate_frame(encode_rate_frame(sent)), sent);
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
  const RateFrame frame = encode_rate_frame(sent);
  const std::vector<std::uint8_t> head(frame.begin(), frame.begin() + 24);
  EXPECT_EQ(head, (std::vector<std::uint8_t>{'Z',  'R',  1,    0,    0x04, 0x03, 0x02, 0x01,
                                             0xEF, 0xCD, 0xAB, 0x89, 0x67, 0x45, 0x23, 0x01,
                                             2,    0x41, 0x04, 87,   0,    0,    0x80, 0x3F}));
  EXPECT_EQ(frame[66], 0x00);  // -2.0F = 0xC0000000, sigma of z
  EXPECT_EQ(frame[67], 0xC0);
  std::uint32_t checksum = 0;
  std::memcpy(&checksum, &frame[68], 4);  // the test runs on little-endian machines
  EXPECT_EQ(checksum, ::crc32(0, frame.data(), 68));
}

TEST(RateFrameWithAnyWrongBit, IsRefused) {
  std::mt19937_64 random{2};
  const RateFrame good = encode_rate_frame(random_message(random));
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    RateFrame bad = good;
    bad[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    EXPECT_FALSE(decode_rate_frame(bad)) << bit;
  }
}

TEST(BytesThatAreNoRateFrame, AreRefusedForTheirReason) {
  const auto reason = [](const std::vector<std::uint8_t>& bytes) {
    return decode_rate_frame(bytes).error();
  };
  const RateFrame good = encode_rate_frame({});
  std::vector<std::uint8_t> bytes(good.begin(), good.end());
  EXPECT_EQ(reason({}), FrameError::wrong_size);
  EXPECT_EQ(reason({bytes.begin(), bytes.end() - 1}), FrameError::wrong_size);
  auto changed = bytes;
  changed[0] = 'z';
  EXPECT_EQ(reason(changed), FrameError::not_a_frame);
  changed = bytes;
  changed[2] = 2;
  EXPECT_EQ(reason(changed), FrameError::unknown_version);
  changed = bytes;
  changed[30] ^= 1;
  EXPECT_EQ(reason(changed), FrameError::wrong_checksum);
  changed = bytes;
  changed[16] = 3;  // no such motion, under a checksum that fits
  const auto checksum = static_cast<std::uint32_t>(::crc32(0, changed.data(), 68));
  std::memcpy(&changed[68], &checksum, 4);
  EXPECT_EQ(reason(changed), FrameError::impossible_value);
}

}  // namespace
}  // namespace zerorate::wire
