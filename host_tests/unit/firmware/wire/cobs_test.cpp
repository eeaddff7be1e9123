#include "firmware/wire/cobs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace zerorate::wire {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::size_t kLongest = 600;

Bytes stuffed(const Bytes& frame) {
  Bytes line(frame.size() + frame.size() / 254 + 2, 0xAA);
  line.resize(stuff(frame, line));
  return line;
}

std::vector<Bytes> frames_in(const Bytes& line, CobsReader<kLongest>& reader) {
  std::vector<Bytes> frames;
  for (const std::uint8_t byte : line) {
    if (const auto frame = reader.take(byte)) frames.emplace_back(frame->begin(), frame->end());
  }
  return frames;
}

Bytes counting(std::size_t from, std::size_t to) {
  Bytes bytes;
  for (std::size_t i = from; i <= to; ++i) bytes.push_back(static_cast<std::uint8_t>(i));
  return bytes;
}

// From the paper's and the Wikipedia article's tables of examples.
TEST(StuffedFrame, IsThePublishedExample) {
  EXPECT_EQ(stuffed({0x00}), (Bytes{0x01, 0x01, 0x00}));
  EXPECT_EQ(stuffed({0x00, 0x00}), (Bytes{0x01, 0x01, 0x01, 0x00}));
  EXPECT_EQ(stuffed({0x11, 0x22, 0x00, 0x33}), (Bytes{0x03, 0x11, 0x22, 0x02, 0x33, 0x00}));
  EXPECT_EQ(stuffed({0x11, 0x00, 0x00, 0x00}), (Bytes{0x02, 0x11, 0x01, 0x01, 0x01, 0x00}));
  Bytes longest_group = counting(0x01, 0xFE);
  Bytes expected = longest_group;
  expected.insert(expected.begin(), 0xFF);
  expected.push_back(0x00);
  EXPECT_EQ(stuffed(longest_group), expected);
  longest_group.push_back(0xFF);
  expected.back() = 0x02;
  expected.insert(expected.end(), {0xFF, 0x00});
  EXPECT_EQ(stuffed(longest_group), expected);
}

TEST(AnyFrameStuffed, HasOneZeroAtItsEndAndIsReadBack) {
  std::mt19937 random{20};  // NOLINT(cert-msc51-cpp): the same frames every time
  CobsReader<kLongest> reader;
  for (std::size_t size = 1; size <= kLongest; ++size) {
    Bytes frame(size);
    const unsigned zeros = 1U + static_cast<unsigned>(size % 300);  // from many to hardly any
    for (auto& byte : frame) {
      byte =
          random() % zeros == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(1 + random() % 255);
    }
    const Bytes line = stuffed(frame);
    ASSERT_EQ(std::count(line.begin(), line.end(), std::uint8_t{0}), 1);
    ASSERT_EQ(line.back(), 0);
    ASSERT_EQ(frames_in(line, reader), (std::vector<Bytes>{frame}));
  }
  EXPECT_EQ(reader.dropped(), 0U);
}

TEST(ReaderThatComesInTheMiddleOfAFrame, IsInStepAtTheNext) {
  const Bytes frame{1, 2, 0, 4, 5};
  const Bytes line = stuffed(frame);
  for (std::size_t missed = 1; missed < line.size(); ++missed) {
    CobsReader<kLongest> reader;
    Bytes rest(line.begin() + static_cast<std::ptrdiff_t>(missed), line.end());
    (void)frames_in(rest, reader);  // may look like a frame; its checksum will not
    EXPECT_EQ(frames_in(line, reader), (std::vector<Bytes>{frame}));
  }
}

TEST(FrameThatIsCutOffOrTooLong, IsDroppedAndCounted) {
  CobsReader<4> reader;
  for (const std::uint8_t byte : Bytes{5, 1, 0}) EXPECT_FALSE(reader.take(byte));
  EXPECT_EQ(reader.dropped(), 1U);
  for (const std::uint8_t byte : Bytes{6, 1, 2, 3, 4, 5, 0}) EXPECT_FALSE(reader.take(byte));
  EXPECT_EQ(reader.dropped(), 2U);
  for (const std::uint8_t byte : Bytes{0, 0, 0}) EXPECT_FALSE(reader.take(byte));
  EXPECT_EQ(reader.dropped(), 2U);
}

}  // namespace
}  // namespace zerorate::wire
