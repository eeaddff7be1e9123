#include "firmware/wire/cobs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace zerorate::wire {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes encoded(const Bytes& frame) {
  Bytes target(cobs_bytes(frame.size()));
  target.resize(encode_cobs(frame, target));
  return target;
}

template <std::size_t Longest = 1024>
std::vector<Bytes> frames_in(const Bytes& stream) {
  CobsReader<Longest> reader;
  std::vector<Bytes> frames;
  for (const std::uint8_t byte : stream) {
    if (const auto frame = reader.take(byte)) frames.emplace_back(frame->begin(), frame->end());
  }
  return frames;
}

Bytes counting(std::uint8_t first, std::size_t size) {
  Bytes bytes(size);
  for (std::uint8_t& byte : bytes) byte = first++;
  return bytes;
}

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(Cobs, EncodesTheExamplesOfThePaperAndItsEdges) {
  EXPECT_EQ(encoded({}), (Bytes{1, 0}));
  EXPECT_EQ(encoded({0}), (Bytes{1, 1, 0}));
  EXPECT_EQ(encoded({0, 0}), (Bytes{1, 1, 1, 0}));
  EXPECT_EQ(encoded({0x11, 0x22, 0, 0x33}), (Bytes{3, 0x11, 0x22, 2, 0x33, 0}));
  EXPECT_EQ(encoded({0x11, 0x22, 0x33, 0x44}), (Bytes{5, 0x11, 0x22, 0x33, 0x44, 0}));
  EXPECT_EQ(encoded({0x11, 0, 0, 0}), (Bytes{2, 0x11, 1, 1, 1, 0}));
  EXPECT_EQ(encoded(counting(1, 253)), Bytes{254} + counting(1, 253) + Bytes{0});
  EXPECT_EQ(encoded(Bytes{0} + counting(1, 253)), (Bytes{1, 254}) + counting(1, 253) + Bytes{0});
}

TEST(CobsOfAFullBlock, MayEndWithAnEmptyBlock) {
  const Bytes frame = counting(1, 254);
  EXPECT_EQ(encoded(frame), Bytes{255} + frame + (Bytes{1, 0}));
  EXPECT_EQ(frames_in(encoded(frame)), std::vector<Bytes>{frame});
  EXPECT_EQ(frames_in(Bytes{255} + frame + Bytes{0}),
            std::vector<Bytes>{frame});  // the paper's own form
}

TEST(CobsOfRandomFrames, HasNoZeroInsideAndIsReadBack) {
  std::mt19937 random{3};
  Bytes stream;
  std::vector<Bytes> frames;
  for (std::size_t size = 1; size < 700; size += 3) {
    Bytes frame(size);
    for (std::uint8_t& byte : frame) {
      byte = random() % 5 == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(random());
    }
    const Bytes coded = encoded(frame);
    EXPECT_EQ(std::ranges::find(coded, 0) - coded.begin(),
              static_cast<std::ptrdiff_t>(coded.size()) - 1);
    stream = stream + coded;
    frames.push_back(frame);
  }
  EXPECT_EQ(frames_in(stream), frames);
}

/// Verifies SR-IF-15.
TEST(CobsReaderThatJoinsInTheMiddle, IsInStepAtTheNextFrame) {
  const Bytes frame = counting(1, 40);
  const Bytes one = encoded(frame);
  for (std::size_t missed = 1; missed < one.size(); ++missed) {
    const Bytes tail(one.begin() + static_cast<std::ptrdiff_t>(missed), one.end());
    const auto frames = frames_in(tail + one);
    ASSERT_FALSE(frames.empty());
    EXPECT_EQ(frames.back(), frame) << missed;
    EXPECT_LE(frames.size(), 2U);
  }
}

/// Verifies SR-IF-15.
TEST(CobsReader, DropsAndCountsWhatIsTooLongOrCutShort) {
  CobsReader<8> reader;
  const auto feed = [&](const Bytes& bytes) {
    bool any = false;
    for (const std::uint8_t byte : bytes) any |= reader.take(byte).has_value();
    return any;
  };
  EXPECT_TRUE(feed(encoded(counting(1, 8))));
  EXPECT_FALSE(feed(encoded(counting(1, 9))));
  EXPECT_EQ(reader.dropped(), 1U);
  EXPECT_FALSE(feed({5, 1, 2, 0}));
  EXPECT_EQ(reader.dropped(), 2U);
  EXPECT_FALSE(feed({0, 0, 0}));  // an idle line is no frame and no loss
  EXPECT_EQ(reader.dropped(), 2U);
  EXPECT_TRUE(feed(encoded(counting(1, 3))));
}

}  // namespace
}  // namespace zerorate::wire
