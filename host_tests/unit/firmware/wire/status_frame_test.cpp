#include "firmware/wire/status_frame.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "firmware/wire/learnt_frame.hpp"
#include "host_tests/unit/firmware/wire/messages.hpp"

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

/// Verifies SR-IF-11.
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

TEST(LearntFrameDecoded, GivesBackEveryFigure) {
  const auto decoded = decode_learnt_frame(encode_learnt_frame(testing::some_learnt_model()));
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(*decoded, testing::some_learnt_model());
}

// The table of docs/reference/rate-frame.md, written down by hand; the checksum is zlib's.
TEST(LearntFrame, HasTheDocumentedBytes) {
  const LearntModel learnt = testing::some_learnt_model();
  const LearntFrame frame = encode_learnt_frame(learnt);
  EXPECT_EQ(frame[0], 'Z');
  EXPECT_EQ(frame[1], 'L');
  EXPECT_EQ(frame[2], 1);
  EXPECT_EQ(frame[3], 0);
  const auto number_at = [&](std::size_t at) {
    return std::bit_cast<float>(
        LittleEndianReader{std::span{frame}.subspan(at)}.take<std::uint32_t>());
  };
  EXPECT_EQ(number_at(4), 7.5F);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t at = 8 + 24 * axis;
    EXPECT_EQ(number_at(at), learnt.axes[axis].order.value);
    EXPECT_EQ(number_at(at + 4), learnt.axes[axis].order.sigma);
    EXPECT_EQ(number_at(at + 8), learnt.axes[axis].bias_instability_rad_s.value);
    EXPECT_EQ(number_at(at + 12), learnt.axes[axis].bias_instability_rad_s.sigma);
    EXPECT_EQ(number_at(at + 16), learnt.axes[axis].angle_random_walk_rad_per_sqrt_s.value);
    EXPECT_EQ(number_at(at + 20), learnt.axes[axis].angle_random_walk_rad_per_sqrt_s.sigma);
  }
  const auto checksum = static_cast<std::uint32_t>(crc32(0, frame.data(), 80));
  EXPECT_EQ(LittleEndianReader{std::span{frame}.last<4>()}.take<std::uint32_t>(), checksum);
}

/// Verifies SR-IF-11.
TEST(LearntFrameWithAnyBitFlipped, IsRefused) {
  for (std::size_t bit = 0; bit < 8 * kLearntFrameBytes; ++bit) {
    LearntFrame frame = encode_learnt_frame(testing::some_learnt_model());
    frame[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_FALSE(decode_learnt_frame(frame).has_value()) << bit;
  }
}

TEST(LearntFrameOfWhatNoModelCanBe, IsRefused) {
  for (const float impossible :
       {-1.0F, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    LearntModel learnt = testing::some_learnt_model();
    learnt.axes[1].order.sigma = impossible;
    EXPECT_EQ(decode_learnt_frame(encode_learnt_frame(learnt)).error(),
              FrameError::impossible_value);
  }
  EXPECT_EQ(decode_learnt_frame({}).error(), FrameError::wrong_size);
}

TEST(LearntFrame, IsNeitherARateNorAStatusFrame) {
  const LearntFrame frame = encode_learnt_frame(testing::some_learnt_model());
  EXPECT_FALSE(decode_rate_frame(frame).has_value());
  EXPECT_FALSE(decode_status_frame(frame).has_value());
}

}  // namespace
}  // namespace zerorate::wire
