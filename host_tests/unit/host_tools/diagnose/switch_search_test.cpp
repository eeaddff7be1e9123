#include "host_tools/lib/diagnose/effects/switch_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kSize = 4000;

/// White noise of unit variance beside 1/f noise of this strength, by the DCT.
std::vector<double> density_of(double flicker_variance) {
  std::vector<double> density(kSize);
  for (std::size_t k = 1; k < kSize; ++k) {
    const double sine = 2.0 * std::sin(0.5 * std::numbers::pi * static_cast<double>(k) / kSize);
    density[k] = 1.0 + flicker_variance / sine;
  }
  return density;
}

std::vector<double> draw(const std::vector<double>& density, std::uint64_t run) {
  std::vector<double> coefficients(density.size());
  random::RandomStream(11, run).fill_normal(0, coefficients);
  for (std::size_t k = 0; k < density.size(); ++k) coefficients[k] *= std::sqrt(density[k]);
  return coefficients;
}

TEST(SwitchSearchInFlickerNoise, FindsThePlacesOfALargeTelegraph) {
  const spectrum::CosineTransform transform(kSize);
  const std::vector<double> density = density_of(0.05);
  const Switches truth{350, 420, 1100, 1700, 1900, 3000, 3600};
  std::vector<double> values = transform.inverse(draw(density, 1));
  for (std::size_t k = 0; k < kSize; ++k) {
    std::size_t passed = 0;
    for (const std::size_t place : truth) passed += k >= place ? 1U : 0U;
    values[k] += passed % 2 == 0 ? -1.5 : 1.5;
  }
  const SwitchSearch search(transform, transform.forward(values), density, 1.0);
  const Switches fitted = search.improve({});
  ASSERT_EQ(fitted.size(), truth.size());
  // The place of a jump of three sigma is known to about one value.
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(fitted[i]), static_cast<double>(truth[i]), 5.0);
  }
}

TEST(SwitchSearchInNoiseAlone, FindsNoPathWorthItsPrice) {
  const spectrum::CosineTransform transform(kSize);
  int fitted = 0;
  for (const double flicker_variance : {0.0, 0.05, 0.3}) {
    const std::vector<double> density = density_of(flicker_variance);
    for (std::uint64_t run = 0; run < 10; ++run) {
      const SwitchSearch search(transform, draw(density, run), density, 1.0);
      fitted += search.improve({}).size() > 2 ? 1 : 0;
    }
  }
  // Three of thirty: a price of log P alone lets through what e^-1 does in a search over few
  // places.
  EXPECT_LE(fitted, 3);
}

TEST(PriceOfSwitches, FallsWithTheErrorOfTheirPlaces) {
  const double exact = price_of_switches(10, 1000, 0.0);
  EXPECT_NEAR(exact, 10.0 * (std::log(100.0) + 1.0), 1e-12);
  EXPECT_NEAR(exact - price_of_switches(10, 1000, 1.0), 10.0 * std::log(5.0), 1e-12);
  EXPECT_EQ(price_of_switches(10, 1000, 1e3), price_of_switches(10, 1000, 1e6));
}

}  // namespace
}  // namespace zerorate::diagnose
