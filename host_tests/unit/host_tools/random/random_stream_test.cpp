#include "host_tools/lib/random/random_stream.hpp"

#include <gtest/gtest.h>

#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <vector>

namespace zerorate::random {
namespace {

using Block = std::array<std::uint32_t, 4>;

// The known answers that come with Random123, the authors' implementation (kat_vectors, philox4x32
// 10).
TEST(Philox, GivesTheAuthorsKnownAnswers) {
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}),
            (Block{0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8}));
  EXPECT_EQ(philox4x32({0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF}, {0xFFFFFFFF, 0xFFFFFFFF}),
            (Block{0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD}));
  EXPECT_EQ(philox4x32({0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344}, {0xA4093822, 0x299F31D0}),
            (Block{0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1}));
}

TEST(NormalQuantile, EqualsBoostToTheLastDigits) {
  const boost::math::normal_distribution<long double> normal;
  const auto compare = [&](double p) {
    const auto expected =
        static_cast<double>(boost::math::quantile(normal, static_cast<long double>(p)));
    EXPECT_NEAR(normal_quantile(p), expected, 2e-15 * std::abs(expected)) << p;
  };
  for (int step = 0; step < 1300; ++step) compare(1e-17 * std::pow(1.03, step));
  for (int step = 513; step < 1024; ++step) compare(step / 1024.0);
  EXPECT_EQ(normal_quantile(0.5), 0.0);
}

TEST(RandomStream, GivesTheSameNumbersForEver) {
  const RandomStream stream(1, 2);
  EXPECT_EQ(stream.bits(0), 10154990248698053839U);
  EXPECT_EQ(stream.normal(3), -0x1.99765973d5d2fp+0);
  EXPECT_EQ(stream.normal(-7), 0x1.0f54023882eecp-1);
  EXPECT_EQ(stream.substream("white_noise").substream(5).bits(11), 13795484792236433269U);
}

TEST(RandomStream, FillsWithTheNumbersThatItHasOneByOne) {
  const RandomStream stream(20120416);
  for (const std::int64_t first : {-5, -4, 0, 7}) {
    for (const std::size_t size : {0U, 1U, 2U, 5U, 6U}) {
      std::vector<double> values(size);
      stream.fill_normal(first, values);
      for (std::size_t i = 0; i < size; ++i) {
        EXPECT_EQ(values[i], stream.normal(first + static_cast<std::int64_t>(i)));
      }
    }
  }
}

// With n independent standard normals the mean has variance 1/n, the mean square 2/n, the mean cube
// 15/n, the mean fourth power 96/n; five standard deviations each.
TEST(RandomStream, HasTheMomentsOfTheNormalDistribution) {
  constexpr int kCount = 1'000'000;
  const RandomStream stream(20120416);
  std::array<double, 4> sums{};
  for (int k = 0; k < kCount; ++k) {
    const double x = stream.normal(k);
    sums[0] += x;
    sums[1] += x * x;
    sums[2] += x * x * x;
    sums[3] += x * x * x * x;
  }
  EXPECT_NEAR(sums[0] / kCount, 0.0, 5.0 * std::sqrt(1.0 / kCount));
  EXPECT_NEAR(sums[1] / kCount, 1.0, 5.0 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(sums[2] / kCount, 0.0, 5.0 * std::sqrt(15.0 / kCount));
  EXPECT_NEAR(sums[3] / kCount, 3.0, 5.0 * std::sqrt(96.0 / kCount));
}

// The mean product of n independent pairs has variance 1/n.
TEST(RandomStreams, OfNeighbouringIdsAreUncorrelated) {
  constexpr int kCount = 200'000;
  const RandomStream root(20120416);
  const std::array streams{root,
                           root.substream(0),
                           root.substream(1),
                           root.substream("a"),
                           root.substream("b"),
                           RandomStream(20120417)};
  for (std::size_t i = 0; i < streams.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      double sum = 0.0;
      for (int k = 0; k < kCount; ++k) sum += streams[i].normal(k) * streams[j].normal(k);
      EXPECT_NEAR(sum / kCount, 0.0, 5.0 * std::sqrt(1.0 / kCount)) << i << ' ' << j;
    }
  }
}

}  // namespace
}  // namespace zerorate::random
