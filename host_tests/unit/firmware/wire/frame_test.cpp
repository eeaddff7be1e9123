#include "firmware/wire/frame.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace zerorate::wire {
namespace {

app::RateMessage some_message() {
  app::RateMessage message{.time = core::Instant::from_ns(0x0102030405060708),
                           .motion = core::Motion::still,
                           .health = {.calibrated = true, .pulses_lost = true}};
  message.axes[0] = {core::rad_per_s(1.0F), core::rad_per_s(-0.5F), core::rad_per_s(1.5F),
                     core::rad_per_s(std::numeric_limits<float>::infinity())};
  message.axes[2].bias = core::rad_per_s(std::numeric_limits<float>::denorm_min());
  return message;
}

StatusReport some_report() {
  return {.counters = {.samples = 1,
                       .pulses = 2,
                       .pulses_lost = 3,
                       .odometer_errors = 4,
                       .starts = 5,
                       .start_errors = 6,
                       .read_errors = 7,
                       .overruns = 8,
                       .configurations_lost = 0xFFFFFFFF,
                       .last_error = {drivers::DriverErrorCode::bus_failed, hal::BusError::timeout,
                                      0x0F}},
          .frames_dropped = 10};
}

TEST(RateFrameDecoded, GivesBackEveryBitOfTheMessageAndItsNumber) {
  const auto decoded = decode_rate(encode(some_message(), 0xDEADBEEF));
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(decoded->number, 0xDEADBEEFU);
  EXPECT_EQ(decoded->message, some_message());
}

TEST(StatusFrameDecoded, GivesBackEveryCounter) {
  const auto decoded = decode_status(encode(some_report(), 3));
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(decoded->number, 3U);
  EXPECT_EQ(decoded->message, some_report());
}

// The layout as docs/reference/wire-format.md states it, written down by hand.
TEST(RateFrame, HasTheDocumentedBytes) {
  const auto frame = encode(some_message(), 7);
  ASSERT_EQ(frame.size(), 68U);
  const std::vector<std::uint8_t> head{0x52, 0x01, 7,    0,    0,    0,    0x08, 0x07, 0x06, 0x05,
                                       0x04, 0x03, 0x02, 0x01, 0x02, 0x21, 0,    0,    0x80, 0x3F};
  EXPECT_EQ(std::vector<std::uint8_t>(frame.begin(), frame.begin() + 20), head);
}

TEST(RateFrameWithAnyBitFlipped, IsRefused) {
  const auto intact = encode(some_message(), 1);
  for (std::size_t bit = 0; bit < 8 * intact.size(); ++bit) {
    auto frame = intact;
    frame[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    const auto decoded = decode_rate(frame);
    ASSERT_FALSE(decoded.has_value());
    EXPECT_EQ(decoded.error(), FrameError::corrupt) << bit;
  }
}

TEST(RateFrameCutShort, IsRefusedAtEveryLength) {
  const auto frame = encode(some_message(), 1);
  for (std::size_t size = 0; size < frame.size(); ++size) {
    EXPECT_FALSE(decode_rate(std::span{frame}.first(size)).has_value()) << size;
  }
}

TEST(FrameOfAnotherKind, IsUnknownAndNotCorrupt) {
  EXPECT_EQ(decode_rate(encode(some_report(), 0)).error(), FrameError::unknown_kind);
  EXPECT_EQ(decode_status(encode(some_message(), 0)).error(), FrameError::unknown_kind);
}

template <std::size_t Size>
std::array<std::uint8_t, Size> sealed(std::array<std::uint8_t, Size> frame) {
  const std::uint32_t checksum = core::crc32(std::span{frame}.first(Size - 4));
  for (std::size_t i = 0; i < 4; ++i) {
    frame[Size - 4 + i] = static_cast<std::uint8_t>(checksum >> (8 * i));
  }
  return frame;
}

TEST(FrameOfALaterVersion, IsRefusedAlthoughIntact) {
  auto frame = encode(some_message(), 0);
  frame[1] = kVersion + 1;
  EXPECT_EQ(decode_rate(sealed(frame)).error(), FrameError::unknown_version);
}

TEST(RateFrameWithAMotionThatDoesNotExist, IsRefused) {
  auto frame = encode(some_message(), 0);
  frame[14] = 3;
  EXPECT_EQ(decode_rate(sealed(frame)).error(), FrameError::corrupt);
}

TEST(IntactFrameOfTheWrongLength, IsRefused) {
  const auto frame = encode(some_message(), 0);
  std::array<std::uint8_t, kRateFrameBytes + 1> longer{};
  std::copy(frame.begin(), frame.end() - 4, longer.begin());
  EXPECT_EQ(decode_rate(sealed(longer)).error(), FrameError::wrong_length);
}

}  // namespace
}  // namespace zerorate::wire
