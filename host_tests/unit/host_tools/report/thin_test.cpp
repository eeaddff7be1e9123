#include "host_tools/lib/report/thin.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

namespace zerorate::report {
namespace {

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

std::vector<double> ramp(std::size_t size) {
  std::vector<double> x(size);
  for (std::size_t i = 0; i < size; ++i) x[i] = static_cast<double>(i);
  return x;
}

std::vector<double> noise(std::size_t size) {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal;
  std::vector<double> y(size);
  for (double& value : y) value = normal(generator);
  return y;
}

std::vector<std::size_t> thin(const std::vector<double>& x, const std::vector<double>& y,
                              Scale scale = Scale::linear) {
  const std::span<const double> channels[] = {y};
  return thin_for_display(x, channels, {x.front(), x.back(), scale});
}

struct Envelope {
  double least = std::numeric_limits<double>::infinity();
  double greatest = -std::numeric_limits<double>::infinity();
  bool operator==(const Envelope&) const = default;
};

/// The envelope in slices of `width` samples, of the given indices only.
std::map<std::size_t, Envelope> envelope(const std::vector<double>& y,
                                         const std::vector<std::size_t>& indices,
                                         std::size_t width) {
  std::map<std::size_t, Envelope> slices;
  for (const std::size_t i : indices) {
    Envelope& slice = slices[i / width];
    slice.least = std::min(slice.least, y[i]);
    slice.greatest = std::max(slice.greatest, y[i]);
  }
  return slices;
}

std::vector<std::size_t> all_indices(std::size_t size) {
  std::vector<std::size_t> indices(size);
  for (std::size_t i = 0; i < size; ++i) indices[i] = i;
  return indices;
}

TEST(ThinningAShortSeries, KeepsEveryPoint) {
  const auto x = ramp(4 * kDisplayColumns);
  EXPECT_EQ(thin(x, noise(x.size())), all_indices(x.size()));
}

TEST(ThinningAMillionPoints, KeepsAtMostFourAColumn) {
  const auto x = ramp(1'000'000);
  const auto kept = thin(x, noise(x.size()));
  EXPECT_LE(kept.size(), 4 * kDisplayColumns);
  EXPECT_GE(kept.size(), 2 * kDisplayColumns);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  EXPECT_EQ(std::adjacent_find(kept.begin(), kept.end()), kept.end());
  EXPECT_EQ(kept.front(), 0U);
  EXPECT_EQ(kept.back(), x.size() - 1);
}

TEST(ThinningAMillionPoints, KeepsTheEnvelopeOfEveryColumn) {
  // Columns are 999.999 samples wide, so that they are slices of 1000 samples but for the first
  // sample of each slice, which may belong to the column before. Zero there is never an extreme.
  auto y = noise(1'000'000);
  for (std::size_t i = 0; i < y.size(); i += 1000) y[i] = 0;
  const auto x = ramp(y.size());
  EXPECT_EQ(envelope(y, thin(x, y), 1000), envelope(y, all_indices(y.size()), 1000));
}

TEST(ThinningASingleSpike, KeepsIt) {
  std::vector<double> y(1'000'000, 0.0);
  y[123'456] = 1e-3;
  y[654'321] = -1e3;
  const auto kept = thin(ramp(y.size()), y);
  EXPECT_TRUE(std::binary_search(kept.begin(), kept.end(), 123'456U));
  EXPECT_TRUE(std::binary_search(kept.begin(), kept.end(), 654'321U));
}

TEST(ThinningASeriesWithAGap, KeepsTheGapAndTheValuesBesideIt) {
  auto y = noise(1'000'000);
  std::fill(y.begin() + 400'300, y.begin() + 402'700, kGap);
  const auto kept = thin(ramp(y.size()), y);
  const auto in_gap =
      std::count_if(kept.begin(), kept.end(), [&](auto i) { return std::isnan(y[i]); });
  EXPECT_GE(in_gap, 2);
  const auto before =
      std::find_if(kept.begin(), kept.end(), [&](auto i) { return std::isnan(y[i]); });
  EXPECT_GT(*(before - 1), 399'000U);
  EXPECT_LT(*(before - 1), 400'300U);
}

TEST(ThinningASeriesThatIsAllGap, KeepsTheEndsOfEachColumn) {
  const auto x = ramp(100'000);
  EXPECT_EQ(thin(x, std::vector<double>(x.size(), kGap)).size(), 2 * kDisplayColumns);
}

TEST(ThinningABand, KeepsTheExtremesOfItsEdgesToo) {
  const auto x = ramp(1'000'000);
  const std::vector<double> y(x.size(), 0.0);
  auto lo = std::vector<double>(x.size(), -1.0);
  auto hi = std::vector<double>(x.size(), 1.0);
  lo[777'777] = -5;
  hi[222'222] = 5;
  const std::span<const double> channels[] = {y, lo, hi};
  const auto kept = thin_for_display(x, channels, {x.front(), x.back(), Scale::linear});
  EXPECT_TRUE(std::binary_search(kept.begin(), kept.end(), 777'777U));
  EXPECT_TRUE(std::binary_search(kept.begin(), kept.end(), 222'222U));
}

TEST(ThinningOnALogarithmicAxis, SpreadsTheColumnsOverTheDecades) {
  std::vector<double> x(1'000'000);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = static_cast<double>(i + 1);
  const auto kept = thin(x, noise(x.size()), Scale::logarithmic);
  // Six decades share the columns, so the first two hold a third of them but only 100 points: every
  // one of these is kept.
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(kept[i], i);
  EXPECT_LE(kept.size(), 4 * kDisplayColumns);
}

TEST(ThinningPointsThatShareOneX, KeepsTheirExtremes) {
  const std::vector<double> x(10'000, 3.0);
  auto y = noise(x.size());
  y[5'000] = 100;
  const auto kept = thin(x, y);
  EXPECT_LE(kept.size(), 4U);
  EXPECT_TRUE(std::binary_search(kept.begin(), kept.end(), 5'000U));
}

}  // namespace
}  // namespace zerorate::report
