#include "host_tools/lib/diagnose/record/level_lattice.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::diagnose {
namespace {

std::vector<double> normal_values(std::size_t size) {
  std::vector<double> values(size);
  random::RandomStream(11).fill_normal(0, values);
  return values;
}

TEST(LatticeOfRoundedValues, HasTheirStepAndCountsThem) {
  std::vector<double> values = normal_values(5000);
  for (double& value : values)
    value = double{static_cast<float>(7.0 + 0.125 * std::round(8.0 * value))};
  const auto lattice = find_lattice(values);
  ASSERT_TRUE(lattice);
  EXPECT_NEAR(lattice->step, 0.125, 1e-6);
  std::size_t counted = 0;
  for (const std::size_t count : lattice->counts) counted += count;
  EXPECT_EQ(counted, values.size());
}

TEST(LatticeOfNormalValues, IsNone) {
  EXPECT_FALSE(find_lattice(normal_values(5000)));
}

TEST(LatticeOfUnevenLevels, IsNone) {
  std::vector<double> values;
  for (int i = 0; i < 400; ++i) values.push_back(std::sqrt(static_cast<double>(i % 20)));
  EXPECT_FALSE(find_lattice(values));
}

TEST(Extremes, AreCounted) {
  const std::vector<double> values{1.0, 3.0, 3.0, 2.0, 3.0, 1.5};
  EXPECT_EQ(count_extremes(values).lowest, 1U);
  EXPECT_EQ(count_extremes(values).highest, 3U);
}

}  // namespace
}  // namespace zerorate::diagnose
