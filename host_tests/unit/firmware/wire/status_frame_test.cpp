#include "firmware/wire/status_frame.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace zerorate::wire {
namespace {

Status some_status() {
  return {.counters = {.samples = 1,
                       .pulses = 2,
                       .pulses_lost = 3,
                       .odometer_errors = 4,
                       .starts = 5,
                       .start_errors = 6,
                       .read_errors = 7,
                       .overruns = 8,
                       .configurations_lost = 0xFFFFFFFF,
                       .silences = 10,
                       .last_error = {drivers::DriverErrorCode::corrupt_data,
                                      hal::BusError::timeout, 0x0F}},
          .frames_dropped = 11};
}

TEST(StatusFrameDecoded, GivesBackEveryCounter) {
  const auto decoded = decode_status_frame(encode_status_frame(some_status()));
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(decoded->frames_dropped, 11U);
  EXPECT_EQ(decoded->counters, some_status().counters);
}

// The table of docs/reference/rate-frame.md, written down by hand; the checksum is zlib's.
TEST(StatusFrame, HasTheDocumentedBytes) {
  const StatusFrame frame = encode_status_frame(some_status());
  EXPECT_EQ(frame[0], 'Z');
  EXPECT_EQ(frame[1], 'S');
  EXPECT_EQ(frame[2], 1);
  EXPECT_EQ(frame[3], 0);
  for (std::size_t i = 0; i < 11; ++i) {
    EXPECT_EQ(frame[4 + 4 * i], i == 8 ? 0xFF : i + 1);
    EXPECT_EQ(frame[7 + 4 * i], i == 8 ? 0xFF : 0);
  }
  EXPECT_EQ(frame[48], static_cast<std::uint8_t>(drivers::DriverErrorCode::corrupt_data));
  EXPECT_EQ(frame[49], static_cast<std::uint8_t>(hal::BusError::timeout));
  EXPECT_EQ(frame[50], 0x0F);
  const auto checksum = static_cast<std::uint32_t>(crc32(0, frame.data(), 52));
  EXPECT_EQ(LittleEndianReader{std::span{frame}.last<4>()}.take<std::uint32_t>(), checksum);
}

TEST(StatusFrameWithAnyBitFlipped, IsRefused) {
  for (std::size_t bit = 0; bit < 8 * kStatusFrameBytes; ++bit) {
    StatusFrame frame = encode_status_frame(some_status());
    frame[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_FALSE(decode_status_frame(frame).has_value()) << bit;
  }
}

TEST(StatusFrameOfTheWrongLength, IsRefused) {
  const StatusFrame frame = encode_status_frame(some_status());
  EXPECT_EQ(decode_status_frame(std::span{frame}.first(55)).error(), FrameError::wrong_size);
  EXPECT_EQ(decode_status_frame({}).error(), FrameError::wrong_size);
}

}  // namespace
}  // namespace zerorate::wire
